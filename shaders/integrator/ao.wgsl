// Ambient occlusion: the cosine-weighted fraction of the hemisphere from which nothing is met
// within AO_DISTANCE metres. White where the camera sees no surface.

#include "bsdf.wgsl"
#include "sampler.wgsl"

override AO_DISTANCE: f32 = 3.0e38;

fn Li(camera_ray: Ray, sampler: ptr<function, Sampler>) -> vec3f {
    let seed = hash2(vec2u((*sampler).key, (*sampler).index));
    let hit = intersect(camera_ray, true, seed);
    if (hit.triangle == NONE) {
        return vec3f(1.0);
    }
    let s = surface_at(camera_ray, hit);
    let wi = to_world(s.shading, sample_cosine_hemisphere(next_2d(sampler)));
    if (dot(wi, s.normal) <= 0.0) {
        return vec3f(0.0);
    }
    var ray = spawn_ray(s, wi);
    ray.t_max = AO_DISTANCE;
    return select(vec3f(1.0), vec3f(0.0), occluded(ray, seed ^ 1u));
}
