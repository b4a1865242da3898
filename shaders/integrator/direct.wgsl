// Emitters and the light that reaches surfaces from them without a further bounce.

#include "path.wgsl"

fn Li(camera_ray: Ray, sampler: ptr<function, Sampler>) -> vec3f {
    return path_Li(camera_ray, sampler, min(frame.max_depth, 2u), true, true);
}
