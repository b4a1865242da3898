// The path loop that the path integrators share.

#include "light.wgsl"
#include "bsdf.wgsl"
#include "medium.wgsl"

// Depth (edges) from which on any path may end by roulette, and the largest chance to go on.
override ROULETTE_DEPTH: u32 = 5u;
override ROULETTE_MAX_SURVIVAL: f32 = 0.95;
// The least one: no survivor weighs more than 1 over this.
const LEAST_SURVIVAL: f32 = 1e-4;

// How many samples one of an environment's picture counts for, against one of the BSDF, where all of that is diffuse: it is
// chosen by light and cosine together, so it is mostly the better one (docs/kernel.md).
override ENVIRONMENT_SAMPLES: f32 = 2.0;

// Light samples of a path's first vertex, at most MOST_LIGHT_SAMPLES: as many as the training pass found best
// (src/render/guide/effort.rs), or one. All share the camera ray and the surface (splitting: Arvo and Kirk 1990, Particle
// Transport and Image Synthesis).
override FIRST_LIGHT_SAMPLES: u32 = LEARNT_LIGHT_SAMPLES;
const MOST_LIGHT_SAMPLES: u32 = 8u;

// Pairs of random numbers that a vertex may use, so that one that uses fewer shifts no other's.
const DIMENSIONS_PER_VERTEX: u32 = 6u;

// What the last BSDF sample knows about a light that it may hit.
struct LastBounce {
    position: vec3f,
    normal: vec3f,
    pdf: f32,
    // No light sample competes: the first edge, or a mirror.
    alone: bool,
    // Whether light on either side could have been sampled.
    both_sides: bool,
    // What a sample of an environment's picture counts for.
    environment_samples: f32,
}

// A light sample, and what the path gains if nothing is in the way of its ray.
struct LightTry {
    gain: vec3f,
    seed: u32,
    shadow: Ray,
}

// Light samples of the path under way whose rays are yet to be traced. Not in Path, which is copied.
var<private> waiting_lights: array<LightTry, MOST_LIGHT_SAMPLES>;

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
    first_dimension: u32,
    ray: Ray,
    last: LastBounce,
    // The light sample at the last vertex, and of several the number of others (waiting_lights).
    light: LightTry,
    waiting_count: u32,
    // If RECORDS_PATHS, of the light samples at the first vertex: their rays, and in luminance what one of two brought
    // more than the other.
    light_rays: u32,
    light_difference: f32,
    // The solids that the path is in, if HAS_MEDIA.
    media: Media,
    // Micrometres; 0 as long as the path stands for all wavelengths. Changes if HAS_DISPERSION.
    wavelength: f32,
}

// A path along a ray from the camera.
fn path_begin(camera_ray: Ray, sampler: ptr<function, Sampler>) -> Path {
    let last = LastBounce(vec3f(0.0), vec3f(0.0), 0.0, true, false, 1.0);
    var path: Path;
    path.beta = vec3f(1.0);
    path.first_dimension = (*sampler).dimension;
    path.ray = camera_ray;
    path.last = last;
    path.media = frame.media;
    return path;
}

// What to ask next: the ray along the next edge is traced together with the one to the light that
// the last vertex chose. Of several of these the others come before, alone.
fn path_query(path: Path, sampler: ptr<function, Sampler>) -> Query {
    (*sampler).dimension = path.first_dimension + path.depth * DIMENSIONS_PER_VERTEX;
    let has_shadow = HAS_LIGHTS && any(path.light.gain != vec3f(0.0));
    let has_ray = is_going(path) && path.waiting_count == 0u;
    let is_first = path.depth == 0u;
    return Query(path.ray, has_ray, is_first, ray_seed(*sampler), path.light.shadow, has_shadow, path.light.seed);
}

// Goes one edge further; false if the path has ended.
fn path_step(path: ptr<function, Path>, answer: Answer, sampler: ptr<function, Sampler>) -> bool {
    if (HAS_LIGHTS && !answer.occluded) {
        (*path).L += (*path).light.gain;
    }
    if (RECORDS_PATHS && (*path).depth == 1u && any((*path).light.gain != vec3f(0.0))) {
        let brought = select(luminance((*path).light.gain), 0.0, answer.occluded);
        (*path).light_difference += select(brought, -brought, (*path).waiting_count == 0u);
        (*path).light_rays += 1u;
    }
    (*path).light.gain = vec3f(0.0);
    if ((*path).waiting_count > 0u) {
        (*path).waiting_count -= 1u;
        (*path).light = waiting_lights[(*path).waiting_count];
        return true;
    }
    if (RECORDS_PATHS && (*path).depth > 0u) {
        record_gathered((*path).depth, luminance((*path).L));
    }
    var goes_on = is_going(*path);
    if (goes_on) {
        (*path).depth += 1u;
        path_vertex(path, answer.hit, sampler);
        goes_on = is_going(*path) || any((*path).light.gain != vec3f(0.0));
    }
    if (RECORDS_PATHS && !goes_on) {
        record_path((*path).depth, luminance((*path).L), (*path).light_rays, (*path).light_difference);
    }
    return goes_on;
}

// Whether there is a next edge.
fn is_going(path: Path) -> bool {
    return any(path.beta != vec3f(0.0));
}

// Gathers light where the path has arrived, and chooses where it goes on.
fn path_vertex(path: ptr<function, Path>, hit: Hit, sampler: ptr<function, Sampler>) {
    let ray = (*path).ray;
    var beta = (*path).beta;
    // Most ways out of here end the path.
    (*path).beta = vec3f(0.0);
    if (RECORDS_PATHS) {
        record_nothing((*path).depth);
    }
    if (HAS_ABSORPTION) {
        beta *= medium_transmittance(medium_of((*path).media), hit.t * length(ray.direction));
    }
    if (hit.triangle == NONE) {
        if (HAS_ENVIRONMENT) {
            let light = environment_light((*path).last.normal, (*path).last.both_sides, ray.direction, (*path).last.alone);
            let samples = f32(light_samples_at((*path).depth - 1u));
            (*path).L += beta * environment_hit_weight(samples * light.pdf, (*path).last) * light.radiance;
        }
        return;
    }
    let surface = surface_at(ray, hit);
    var crossing = crossing_at((*path).media, (*path).wavelength, surface);
    if (HAS_MEDIA && is_invisible(surface, crossing)) {
        pass_invisible(path, beta, surface, crossing.media);
        return;
    }
    if (HAS_EMISSION || HAS_UNLIT) {
        let weight = surface_hit_weight(surface, (*path).last, f32(light_samples_at((*path).depth - 1u)));
        (*path).L += beta * weight * emitted_radiance(surface);
    }
    if ((*path).depth >= min(frame.max_depth, MAX_EDGES) || is_unlit(surface)) {
        return;
    }
    if (HAS_DISPERSION && (*path).wavelength == 0.0 && is_dispersive(crossing)) {
        // From here on the path stands for one wavelength.
        (*sampler).dimension = (*path).first_dimension + ((*path).depth - 1u) * DIMENSIONS_PER_VERTEX + 5u;
        var wavelength = 0.0;
        beta *= sample_wavelength(next_1d(sampler), &wavelength);
        (*path).wavelength = wavelength;
        crossing = crossing_at((*path).media, wavelength, surface);
        (*sampler).dimension = (*path).first_dimension + ((*path).depth - 1u) * DIMENSIONS_PER_VERTEX;
    }
    let wo = to_local(surface.shading, surface.wo);
    var bsdf = bsdf_at(surface, wo, crossing);
    if (HAS_GUIDE || RECORDS_PATHS) {
        bsdf.guide = guide_at(surface.position, surface.shading);
    }
    let both_sides = bsdf_has_smooth_transmission(bsdf);
    if (HAS_LIGHTS && bsdf_has_smooth_part(bsdf)) {
        sample_direct(path, beta, surface, crossing, bsdf, wo, sampler);
    }
    // Go on in a direction drawn from the BSDF.
    (*sampler).dimension = (*path).first_dimension + ((*path).depth - 1u) * DIMENSIONS_PER_VERTEX + 3u;
    let u = next_2d(sampler);
    let choice = next_2d(sampler);
    let sample = bsdf_sample(bsdf, wo, u, choice.x);
    let wi = to_world(surface.shading, sample.wi);
    if (!same_side(sample.wi, dot(wi, surface.normal))) {
        return;
    }
    if (HAS_MEDIA && sample.wi.z < 0.0) {
        (*path).media = crossing.media;
    }
    beta *= sample.weight;
    let unguided = beta * sample.guided;
    (*path).beta = beta * roulette((*path).depth, unguided, choice.y);
    if (RECORDS_PATHS) {
        record_vertex((*path).depth, mean_component(unguided), luminance((*path).beta));
        if (draws_diffuse(bsdf, choice.x)) {
            record_square((*path).depth, surface.position, surface.shading.z, u);
        }
    }
    let counts = environment_samples(bsdf);
    (*path).last = LastBounce(surface.position, surface.shading.z, sample.pdf, sample.delta, both_sides, counts);
    (*path).ray = spawn_ray(surface, wi);
}

// What a sample of the environment counts for at a surface, in multiple importance sampling.
fn environment_samples(bsdf: Bsdf) -> f32 {
    return select(1.0, mix(1.0, ENVIRONMENT_SAMPLES, p_diffuse(bsdf)), HAS_ENVIRONMENT_IMAGE);
}

// Whether a local direction is on the side of the shading normal on which it is of the triangle's, to which
// its cosine is given.
fn same_side(wi: vec3f, cos_normal: f32) -> bool {
    if (wi.z > 0.0) {
        return cos_normal > 0.0;
    }
    return TRANSMITS && wi.z < 0.0 && cos_normal < 0.0;
}

// Goes straight through a surface that is not there to be seen. No light sample could have come this way.
fn pass_invisible(path: ptr<function, Path>, beta: vec3f, s: Surface, media: Media) {
    if ((*path).depth >= min(frame.max_depth, MAX_EDGES)) {
        return;
    }
    (*path).beta = beta;
    (*path).media = media;
    (*path).last.alone = true;
    (*path).ray = spawn_ray(s, -s.wo);
}

// Ends paths that carry little (0), and makes the survivors carry their share. What a path carries is its
// throughput as it would be without a guide: a guided one is small where much light is.
//
// Where a training pass found a threshold (src/render/guide/roulette.rs), paths that carry less may end from the
// first vertex on, and the survivors carry the threshold.
fn roulette(depth: u32, carried: vec3f, u: f32) -> f32 {
    // What is recorded shows what becomes of paths that do not end.
    let is_late = depth >= select(ROULETTE_DEPTH, max(ROULETTE_DEPTH, RECORDS_PER_PATH), RECORDS_PATHS);
    var share: f32;
    if (HAS_ROULETTE_THRESHOLD) {
        share = mean_component(carried) / frame.roulette_threshold;
    } else if (is_late) {
        share = max_component(carried);
    } else {
        return 1.0;
    }
    let survival = clamp(share, LEAST_SURVIVAL, select(1.0, ROULETTE_MAX_SURVIVAL, is_late));
    return select(0.0, 1.0 / survival, u < survival);
}

// Light samples of the vertex at a depth.
fn light_samples_at(depth: u32) -> u32 {
    if (FIRST_LIGHT_SAMPLES <= 1u) {
        return 1u;
    }
    return select(1u, min(FIRST_LIGHT_SAMPLES, MOST_LIGHT_SAMPLES), depth == 1u);
}

// Chooses light samples. That of the last ray is at hand, the others wait.
fn sample_direct(
    path: ptr<function, Path>, beta: vec3f, s: Surface, crossing: Crossing, bsdf: Bsdf, wo: vec3f,
    sampler: ptr<function, Sampler>,
) {
    let count = light_samples_at((*path).depth);
    for (var k = 0u; k < count; k += 1u) {
        if (count_step()) {
            break;
        }
        var numbers = part_of_sample(*sampler, count, k);
        if (RECORDS_PATHS) {
            // Independent.
            numbers.key = hash2(vec2u(numbers.key, k));
        }
        let chosen = light_try((*path).media, beta, s, crossing, bsdf, wo, f32(count), &numbers);
        if (any(chosen.gain != vec3f(0.0))) {
            if (any((*path).light.gain != vec3f(0.0))) {
                waiting_lights[(*path).waiting_count] = (*path).light;
                (*path).waiting_count += 1u;
            }
            (*path).light = chosen;
        }
    }
}

// Chooses a light, as one of `count` samples, and what the path gains if the light can be seen.
fn light_try(
    media: Media, beta: vec3f, s: Surface, crossing: Crossing, bsdf: Bsdf, wo: vec3f, count: f32,
    sampler: ptr<function, Sampler>,
) -> LightTry {
    var chosen: LightTry;
    chosen.seed = ray_seed(*sampler) ^ 0x5bd1e995u;
    let light = sample_light(s, bsdf_has_smooth_transmission(bsdf), sampler);
    if (!(light.pdf > 0.0) || (!light.delta && !LIGHT_SAMPLES)) {
        return chosen;
    }
    let wi = to_local(s.shading, light.wi);
    if (!same_side(wi, dot(light.wi, s.normal))) {
        return chosen;
    }
    var contribution = bsdf_eval(bsdf, wo, wi) * light.weight * transmittance_to(s, media, crossing, light, wi);
    if (!light.delta && BSDF_SAMPLES) {
        let samples = count * select(1.0, environment_samples(bsdf), light.at_infinity);
        contribution *= power_heuristic(samples * light.pdf, bsdf_pdf(bsdf, wo, wi));
    }
    chosen.gain = beta * contribution / count;
    chosen.shadow = shadow_ray(s, light);
    return chosen;
}

// Weight of an emitter that a BSDF sample (or the camera) hit, where so many light samples compete.
fn surface_hit_weight(s: Surface, last: LastBounce, light_samples: f32) -> f32 {
    if (last.alone || !LIGHT_SAMPLES || s.light == NONE) {
        return 1.0;
    }
    if (!BSDF_SAMPLES) {
        return 0.0;
    }
    let distance = stable_length(s.position - last.position);
    let cos_light = abs(dot(s.wo, s.normal));
    let chosen = light_probability(s.light, last.position, select(last.normal, vec3f(0.0), last.both_sides));
    let pdf = chosen * light_triangle_pdf(distance, cos_light, s.area);
    return power_heuristic(last.pdf, light_samples * pdf);
}

fn environment_hit_weight(pdf: f32, last: LastBounce) -> f32 {
    if (last.alone || !LIGHT_SAMPLES) {
        return 1.0;
    }
    if (!BSDF_SAMPLES) {
        return 0.0;
    }
    let choice = load_light(frame.environment_light).probability;
    return power_heuristic(last.pdf, last.environment_samples * choice * pdf);
}
