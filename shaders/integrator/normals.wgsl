// Shading normals in the world, facing the camera; each component in [-1, 1]. Zero where the
// camera sees no surface.

#include "surface.wgsl"
#include "sampler.wgsl"

fn Li(camera_ray: Ray, sampler: ptr<function, Sampler>) -> vec3f {
    let hit = intersect(camera_ray, true, hash2(vec2u((*sampler).key, (*sampler).index)));
    if (hit.triangle == NONE) {
        return vec3f(0.0);
    }
    return surface_at(camera_ray, hit).shading.z;
}
