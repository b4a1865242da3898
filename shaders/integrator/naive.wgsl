// The estimator of a first lecture on path tracing: directions uniform over the hemisphere, no
// light sampling, emittance + BRDF * incoming * cos(theta) / p, black at the depth limit. Slow, and
// simple enough to be believed: the oracle of the other integrators.
//
// Two things cannot be met by a uniform direction and are added as they must be: mirrors
// (the mirror direction is followed with probability one half where there is one) and punctual
// lights (all of them are summed).

#include "light.wgsl"
#include "bsdf.wgsl"

fn Li(camera_ray: Ray, sampler: ptr<function, Sampler>) -> vec3f {
    var L = vec3f(0.0);
    var beta = vec3f(1.0);
    var ray = camera_ray;
    for (var depth = 1u; depth <= frame.max_depth; depth += 1u) {
        if (count_step()) {
            break;
        }
        let seed = ray_seed(*sampler);
        let hit = intersect(ray, depth == 1u, seed);
        if (hit.triangle == NONE) {
            if (HAS_ENVIRONMENT) {
                L += beta * environment_radiance(ray.direction);
            }
            break;
        }
        let surface = surface_at(ray, hit);
        L += beta * emitted_radiance(surface);
        if (depth == frame.max_depth || is_unlit(surface)) {
            break;
        }
        let bsdf = bsdf_at(surface);
        let wo = to_local(surface.shading, surface.wo);
        if (HAS_PUNCTUAL_LIGHTS) {
            L += beta * sum_punctual_lights(surface, bsdf, wo, seed ^ 0x5bd1e995u);
        }
        let u = next_2d(sampler);
        let choice = next_1d(sampler);
        let wi = naive_direction(&beta, bsdf, wo, u, choice);
        let direction = to_world(surface.shading, wi);
        if (all(beta == vec3f(0.0)) || dot(direction, surface.normal) <= 0.0) {
            break;
        }
        ray = spawn_ray(surface, direction);
    }
    return L;
}

fn naive_direction(beta: ptr<function, vec3f>, bsdf: Bsdf, wo: vec3f, u: vec2f, choice: f32) -> vec3f {
    var p = pdf_uniform_hemisphere();
    if (has_specular(bsdf) && specular_is_delta(bsdf)) {
        if (choice < 0.5) {
            *beta *= schlick(bsdf.f0, bsdf.f90, wo.z) / 0.5;
            return vec3f(-wo.xy, wo.z);
        }
        p *= 0.5;
    }
    let wi = sample_uniform_hemisphere(u);
    *beta *= bsdf_eval(bsdf, wo, wi) / p;
    return wi;
}

fn sum_punctual_lights(s: Surface, bsdf: Bsdf, wo: vec3f, seed: u32) -> vec3f {
    var sum = vec3f(0.0);
    for (var i = 0u; i < frame.punctual_count; i += 1u) {
        if (count_step()) {
            break;
        }
        let light = punctual_sample(s, i);
        let wi = to_local(s.shading, light.wi);
        if (light.pdf > 0.0 && wi.z > 0.0 && dot(light.wi, s.normal) > 0.0) {
            sum += bsdf_eval(bsdf, wo, wi) * light.weight * visibility_of_light(s, light, hash2(vec2u(seed, i)));
        }
    }
    return sum;
}
