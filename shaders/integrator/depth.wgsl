// Distance from the camera to the first surface, metres, in all three channels. Zero where the
// camera sees no surface.

#include "surface.wgsl"
#include "sampler.wgsl"

fn Li(camera_ray: Ray, sampler: ptr<function, Sampler>) -> vec3f {
    let hit = intersect(camera_ray, true, hash2(vec2u((*sampler).key, (*sampler).index)));
    if (hit.triangle == NONE) {
        return vec3f(0.0);
    }
    return vec3f(hit.t);
}
