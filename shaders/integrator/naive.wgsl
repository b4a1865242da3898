// The estimator of a first lecture on path tracing: directions uniform over the hemisphere, no
// light sampling, emittance + BRDF * incoming * cos(theta) / p, black at the depth limit. Slow, and
// simple enough to be believed: the oracle of the other integrators.
//
// Two things cannot be met by a uniform direction and are added as they must be: lobes of a single direction
// (followed with probability one half, where there are any) and punctual lights (all of them are summed).

#include "light.wgsl"
#include "bsdf.wgsl"
#include "medium.wgsl"

fn Li(camera_ray: Ray, sampler: ptr<function, Sampler>) -> vec3f {
    var L = vec3f(0.0);
    var beta = vec3f(1.0);
    var ray = camera_ray;
    var media = frame.media;
    var wavelength = 0.0;
    for (var depth = 1u; depth <= frame.max_depth; depth += 1u) {
        if (count_step()) {
            break;
        }
        let seed = ray_seed(*sampler);
        let hit = intersect(ray, depth == 1u, seed);
        if (HAS_ABSORPTION) {
            beta *= medium_transmittance(medium_of(media), hit.t * length(ray.direction));
        }
        if (hit.triangle == NONE) {
            if (HAS_ENVIRONMENT) {
                L += beta * environment_radiance(ray.direction);
            }
            break;
        }
        let surface = surface_at(ray, hit);
        var crossing = crossing_at(media, wavelength, surface);
        if (HAS_MEDIA && is_invisible(surface, crossing)) {
            media = crossing.media;
            ray = spawn_ray(surface, -surface.wo);
            continue;
        }
        L += beta * emitted_radiance(surface);
        if (depth == frame.max_depth || is_unlit(surface)) {
            break;
        }
        if (HAS_DISPERSION && wavelength == 0.0 && is_dispersive(crossing)) {
            beta *= sample_wavelength(next_1d(sampler), &wavelength);
            crossing = crossing_at(media, wavelength, surface);
        }
        let wo = to_local(surface.shading, surface.wo);
        let bsdf = bsdf_at(surface, wo, crossing);
        if (HAS_PUNCTUAL_LIGHTS) {
            L += beta * sum_punctual_lights(surface, media, crossing, bsdf, wo, seed ^ 0x5bd1e995u);
        }
        let u = next_2d(sampler);
        let choice = next_1d(sampler);
        let wi = naive_direction(&beta, bsdf, wo, u, choice);
        let direction = to_world(surface.shading, wi);
        if (all(beta == vec3f(0.0)) || wi.z * dot(direction, surface.normal) <= 0.0) {
            break;
        }
        if (HAS_MEDIA && wi.z < 0.0) {
            media = crossing.media;
        }
        ray = spawn_ray(surface, direction);
    }
    return L;
}

fn naive_direction(beta: ptr<function, vec3f>, bsdf: Bsdf, wo: vec3f, u: vec2f, choice: f32) -> vec3f {
    var p = select(pdf_uniform_hemisphere(), 0.5 * pdf_uniform_hemisphere(), TRANSMITS);
    if (bsdf_has_delta(bsdf)) {
        if (choice < 0.5) {
            // Of what a BSDF sample draws only the single directions count.
            let sample = bsdf_sample(bsdf, wo, u, 2.0 * choice);
            *beta *= select(vec3f(0.0), 2.0 * sample.weight, sample.delta);
            return sample.wi;
        }
        p *= 0.5;
    }
    var wi = sample_uniform_hemisphere(u);
    if (TRANSMITS) {
        wi = sample_uniform_sphere(u);
    }
    *beta *= bsdf_eval(bsdf, wo, wi) / p;
    return wi;
}

fn sum_punctual_lights(s: Surface, media: Media, crossing: Crossing, bsdf: Bsdf, wo: vec3f, seed: u32) -> vec3f {
    var sum = vec3f(0.0);
    for (var i = 0u; i < frame.punctual_count; i += 1u) {
        if (count_step()) {
            break;
        }
        let light = punctual_sample(s, i);
        let wi = to_local(s.shading, light.wi);
        if (light.pdf > 0.0 && wi.z * dot(light.wi, s.normal) > 0.0) {
            let f = bsdf_eval(bsdf, wo, wi) * transmittance_to(s, media, crossing, light, wi);
            sum += f * light.weight * visibility_of_light(s, light, hash2(vec2u(seed, i)));
        }
    }
    return sum;
}
