// The path loop that the path integrators share.

#include "light.wgsl"
#include "bsdf.wgsl"

// Depth (edges) from which on paths may end by roulette, and the largest chance to go on.
override ROULETTE_DEPTH: u32 = 5u;
override ROULETTE_MAX_SURVIVAL: f32 = 0.95;

// Pairs of random numbers that a vertex may use, so that one that uses fewer shifts no other's.
const DIMENSIONS_PER_VERTEX: u32 = 6u;

// What the last BSDF sample knows about a light that it may hit.
struct LastBounce {
    position: vec3f,
    normal: vec3f,
    pdf: f32,
    // No light sample competes: the first edge, or a mirror.
    alone: bool,
}

// Radiance along a ray from the camera. `light_samples` and `bsdf_samples` choose the techniques
// that may find lights with a finite density; with both they are weighted by the power heuristic.
fn path_Li(camera_ray: Ray, sampler: ptr<function, Sampler>, max_depth: u32, light_samples: bool, bsdf_samples: bool) -> vec3f {
    var L = vec3f(0.0);
    var beta = vec3f(1.0);
    var ray = camera_ray;
    var last = LastBounce(vec3f(0.0), vec3f(0.0), 0.0, true);
    let first_dimension = (*sampler).dimension;
    for (var depth = 1u; depth <= max_depth; depth += 1u) {
        if (count_step()) {
            break;
        }
        (*sampler).dimension = first_dimension + (depth - 1u) * DIMENSIONS_PER_VERTEX;
        let hit = intersect(ray, depth == 1u, ray_seed(*sampler));
        if (hit.triangle == NONE) {
            if (HAS_ENVIRONMENT) {
                let weight = environment_hit_weight(ray.direction, last, light_samples, bsdf_samples);
                L += beta * weight * environment_radiance(ray.direction);
            }
            break;
        }
        let surface = surface_at(ray, hit);
        if (HAS_EMISSION || HAS_UNLIT) {
            let weight = surface_hit_weight(surface, last, light_samples, bsdf_samples);
            L += beta * weight * emitted_radiance(surface);
        }
        if (depth == max_depth || is_unlit(surface)) {
            break;
        }
        let bsdf = bsdf_at(surface);
        let wo = to_local(surface.shading, surface.wo);
        if (HAS_LIGHTS && bsdf_has_smooth_part(bsdf)) {
            L += beta * sample_direct(surface, bsdf, wo, sampler, light_samples, bsdf_samples);
        }
        // Go on in a direction drawn from the BSDF.
        (*sampler).dimension = first_dimension + (depth - 1u) * DIMENSIONS_PER_VERTEX + 3u;
        let u = next_2d(sampler);
        let choice = next_2d(sampler);
        let sample = bsdf_sample(bsdf, wo, u, choice.x);
        let wi = to_world(surface.shading, sample.wi);
        if (sample.wi.z <= 0.0 || dot(wi, surface.normal) <= 0.0) {
            break;
        }
        beta *= sample.weight;
        if (all(beta == vec3f(0.0))) {
            break;
        }
        last = LastBounce(surface.position, surface.shading.z, sample.pdf, sample.delta);
        ray = spawn_ray(surface, wi);
        // End paths that carry little, and make the survivors carry their share.
        if (depth >= ROULETTE_DEPTH) {
            let survival = min(min(max_component(beta), 1.0), ROULETTE_MAX_SURVIVAL);
            if (choice.y >= survival) {
                break;
            }
            beta /= survival;
        }
    }
    return L;
}

// Light that arrives directly, found by sampling a light.
fn sample_direct(s: Surface, bsdf: Bsdf, wo: vec3f, sampler: ptr<function, Sampler>, light_samples: bool, bsdf_samples: bool) -> vec3f {
    let seed = ray_seed(*sampler) ^ 0x5bd1e995u;
    let light = sample_light(s, sampler);
    if (!(light.pdf > 0.0) || (!light.delta && !light_samples)) {
        return vec3f(0.0);
    }
    let wi = to_local(s.shading, light.wi);
    if (wi.z <= 0.0 || dot(light.wi, s.normal) <= 0.0) {
        return vec3f(0.0);
    }
    var contribution = bsdf_eval(bsdf, wo, wi) * light.weight;
    if (!light.delta && bsdf_samples) {
        contribution *= power_heuristic(light.pdf, bsdf_pdf(bsdf, wo, wi));
    }
    if (all(contribution == vec3f(0.0))) {
        return vec3f(0.0);
    }
    return contribution * visibility_of_light(s, light, seed);
}

// Weight of an emitter that a BSDF sample (or the camera) hit.
fn surface_hit_weight(s: Surface, last: LastBounce, light_samples: bool, bsdf_samples: bool) -> f32 {
    if (last.alone || !light_samples || s.light == NONE) {
        return 1.0;
    }
    if (!bsdf_samples) {
        return 0.0;
    }
    let distance = stable_length(s.position - last.position);
    let cos_light = abs(dot(s.wo, s.normal));
    let pdf = lights[s.light].probability * light_triangle_pdf(distance, cos_light, s.area);
    return power_heuristic(last.pdf, pdf);
}

fn environment_hit_weight(direction: vec3f, last: LastBounce, light_samples: bool, bsdf_samples: bool) -> f32 {
    if (last.alone || !light_samples) {
        return 1.0;
    }
    if (!bsdf_samples) {
        return 0.0;
    }
    let choice = lights[frame.environment_light].probability;
    return power_heuristic(last.pdf, choice * environment_pdf(last.normal, direction));
}
