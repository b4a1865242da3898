// Path tracing by BSDF sampling alone: light samples are taken only of punctual lights, which no
// BSDF sample can find. For checking `path`: noisy where lights are small, never wrong.

#include "path.wgsl"

fn Li(camera_ray: Ray, sampler: ptr<function, Sampler>) -> vec3f {
    return path_Li(camera_ray, sampler, frame.max_depth, false, true);
}
