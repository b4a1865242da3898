// The base colour of the first surface, linear. Zero where the camera sees no surface.

#include "material.wgsl"
#include "sampler.wgsl"

fn Li(camera_ray: Ray, sampler: ptr<function, Sampler>) -> vec3f {
    let hit = intersect(camera_ray, true, hash2(vec2u((*sampler).key, (*sampler).index)));
    if (hit.triangle == NONE) {
        return vec3f(0.0);
    }
    return base_color_at(surface_at(camera_ray, hit)).rgb;
}
