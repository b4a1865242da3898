// Unidirectional path tracing: light sampling and BSDF sampling at every vertex, combined by
// multiple importance sampling (Veach 1997), with unbiased Russian roulette.

#include "path.wgsl"

fn Li(camera_ray: Ray, sampler: ptr<function, Sampler>) -> vec3f {
    return path_Li(camera_ray, sampler, frame.max_depth, true, true);
}
