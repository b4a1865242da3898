// Path tracing by light sampling alone: emitters hit by a BSDF sample count only where no light
// sample can reach them. For checking `path`: noisy where surfaces are shiny, never wrong.

#include "path.wgsl"

fn Li(camera_ray: Ray, sampler: ptr<function, Sampler>) -> vec3f {
    return path_Li(camera_ray, sampler, frame.max_depth, true, false);
}
