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

// A path under way. An integrator that includes this file says which techniques find lights with a
// finite density, const LIGHT_SAMPLES and BSDF_SAMPLES (with both they are weighted by the power
// heuristic), and const MAX_EDGES, a limit below the user's.
struct Path {
    // Radiance gathered so far.
    L: vec3f,
    // Edges gone.
    depth: u32,
    // What light that is met from here on is multiplied by.
    beta: vec3f,
    ray: Ray,
    last: LastBounce,
    first_dimension: u32,
}

// A path along a ray from the camera.
fn path_begin(camera_ray: Ray, sampler: ptr<function, Sampler>) -> Path {
    let last = LastBounce(vec3f(0.0), vec3f(0.0), 0.0, true);
    return Path(vec3f(0.0), 0u, vec3f(1.0), camera_ray, last, (*sampler).dimension);
}

// Goes one edge further; false if the path has ended.
fn path_step(path: ptr<function, Path>, sampler: ptr<function, Sampler>) -> bool {
    let depth = (*path).depth + 1u;
    (*path).depth = depth;
    let first_dimension = (*path).first_dimension + (depth - 1u) * DIMENSIONS_PER_VERTEX;
    (*sampler).dimension = first_dimension;
    let ray = (*path).ray;
    let hit = intersect(ray, depth == 1u, ray_seed(*sampler));
    if (hit.triangle == NONE) {
        if (HAS_ENVIRONMENT) {
            let weight = environment_hit_weight(ray.direction, (*path).last);
            (*path).L += (*path).beta * weight * environment_radiance(ray.direction);
        }
        return false;
    }
    let surface = surface_at(ray, hit);
    if (HAS_EMISSION || HAS_UNLIT) {
        let weight = surface_hit_weight(surface, (*path).last);
        (*path).L += (*path).beta * weight * emitted_radiance(surface);
    }
    if (depth >= min(frame.max_depth, MAX_EDGES) || is_unlit(surface)) {
        return false;
    }
    let bsdf = bsdf_at(surface);
    let wo = to_local(surface.shading, surface.wo);
    if (HAS_LIGHTS && bsdf_has_smooth_part(bsdf)) {
        (*path).L += (*path).beta * sample_direct(surface, bsdf, wo, sampler);
    }
    // Go on in a direction drawn from the BSDF.
    (*sampler).dimension = first_dimension + 3u;
    let u = next_2d(sampler);
    let choice = next_2d(sampler);
    let sample = bsdf_sample(bsdf, wo, u, choice.x);
    let wi = to_world(surface.shading, sample.wi);
    if (sample.wi.z <= 0.0 || dot(wi, surface.normal) <= 0.0) {
        return false;
    }
    (*path).beta *= sample.weight;
    (*path).last = LastBounce(surface.position, surface.shading.z, sample.pdf, sample.delta);
    (*path).ray = spawn_ray(surface, wi);
    return roulette(path, choice.y);
}

// Ends paths that carry little, and makes the survivors carry their share.
fn roulette(path: ptr<function, Path>, u: f32) -> bool {
    let brightest = max_component((*path).beta);
    if ((*path).depth >= ROULETTE_DEPTH) {
        let survival = min(min(brightest, 1.0), ROULETTE_MAX_SURVIVAL);
        (*path).beta /= survival;
        return u < survival;
    }
    return brightest > 0.0;
}

// Light that arrives directly, found by sampling a light.
fn sample_direct(s: Surface, bsdf: Bsdf, wo: vec3f, sampler: ptr<function, Sampler>) -> vec3f {
    let seed = ray_seed(*sampler) ^ 0x5bd1e995u;
    let light = sample_light(s, sampler);
    if (!(light.pdf > 0.0) || (!light.delta && !LIGHT_SAMPLES)) {
        return vec3f(0.0);
    }
    let wi = to_local(s.shading, light.wi);
    if (wi.z <= 0.0 || dot(light.wi, s.normal) <= 0.0) {
        return vec3f(0.0);
    }
    var contribution = bsdf_eval(bsdf, wo, wi) * light.weight;
    if (!light.delta && BSDF_SAMPLES) {
        contribution *= power_heuristic(light.pdf, bsdf_pdf(bsdf, wo, wi));
    }
    if (all(contribution == vec3f(0.0))) {
        return vec3f(0.0);
    }
    return contribution * visibility_of_light(s, light, seed);
}

// Weight of an emitter that a BSDF sample (or the camera) hit.
fn surface_hit_weight(s: Surface, last: LastBounce) -> f32 {
    if (last.alone || !LIGHT_SAMPLES || s.light == NONE) {
        return 1.0;
    }
    if (!BSDF_SAMPLES) {
        return 0.0;
    }
    let distance = stable_length(s.position - last.position);
    let cos_light = abs(dot(s.wo, s.normal));
    let pdf = lights[s.light].probability * light_triangle_pdf(distance, cos_light, s.area);
    return power_heuristic(last.pdf, pdf);
}

fn environment_hit_weight(direction: vec3f, last: LastBounce) -> f32 {
    if (last.alone || !LIGHT_SAMPLES) {
        return 1.0;
    }
    if (!BSDF_SAMPLES) {
        return 0.0;
    }
    let choice = lights[frame.environment_light].probability;
    return power_heuristic(last.pdf, choice * environment_pdf(last.normal, direction));
}
