// Light sampling: choose a light, then a point on it.
//
// The generated light_table.wgsl has fn light_at(i: u32) -> Light, and fn light_pair(id: u32) -> Element, the element of an
// emissive triangle's pair.

#include "surface.wgsl"
#include "material.wgsl"
#include "sampler.wgsl"
#include "math/sampling.wgsl"
#include "light_table.wgsl"
#include "light/triangle.wgsl"
#include "light/punctual.wgsl"
#include "light/environment.wgsl"
#include "light/tree.wgsl"

struct LightSample {
    // Unit vector from the shading point to the light.
    wi: vec3f,
    // Radiance (or, if delta, radiance that a delta distribution carries) / pdf.
    weight: vec3f,
    // Density over solid angle, the choice of the light included.
    pdf: f32,
    // Whether no BSDF sample can find this light.
    delta: bool,
    // Where the shadow ray ends, and the error of that point; unused at infinity.
    position: vec3f,
    position_error: vec3f,
    normal: vec3f,
    at_infinity: bool,
    // The triangle that emits, or NONE.
    triangle: u32,
}

const HAS_LIGHTS: bool = HAS_LIGHT_TRIANGLES || HAS_PUNCTUAL_LIGHTS || HAS_ENVIRONMENT;

fn no_light_sample() -> LightSample {
    var s: LightSample;
    s.triangle = NONE;
    return s;
}

// A sample of the light that arrives at `s`, on both sides or on that of its normal; pdf 0 if there is none.
fn sample_light(s: Surface, both_sides: bool, sampler: ptr<function, Sampler>) -> LightSample {
    if (HAS_LIGHT_TREE) {
        let receiver = light_receiver(s.position, select(s.shading.z, vec3f(0.0), both_sides));
        let choice = choose_light_in_tree(receiver, next_2d_bits(sampler));
        if (choice.light == NONE) {
            return no_light_sample();
        }
        var light = load_light(choice.light);
        light.probability = choice.probability;
        return sample_chosen_light(s, both_sides, light, sampler);
    }
    return sample_chosen_light(s, both_sides, light_at(choose_light(sampler)), sampler);
}

// A sample of a light that was chosen with its probability.
fn sample_chosen_light(s: Surface, both_sides: bool, light: Light, sampler: ptr<function, Sampler>) -> LightSample {
    let kind = light.kind_and_index >> LIGHT_KIND_SHIFT;
    let item = light.kind_and_index & LIGHT_INDEX_MASK;
    let u = next_2d_bits(sampler);
    var sample = no_light_sample();
    if (HAS_LIGHT_TRIANGLES && kind == LIGHT_TRIANGLE) {
        sample = light_triangle_sample(s, item, vec2f(unit_float(u.x), unit_float(u.y)));
    } else if (HAS_PUNCTUAL_LIGHTS && kind == LIGHT_PUNCTUAL) {
        sample = punctual_sample(s, item);
    } else if (HAS_ENVIRONMENT && kind == LIGHT_ENVIRONMENT) {
        sample = environment_sample(s, both_sides, u);
    }
    sample.pdf *= light.probability;
    sample.weight /= light.probability;
    return sample;
}

// Probability with which sample_light, at a point, chooses a light that is somewhere. `normal` is the
// shading normal, or null if light from both sides counts.
fn light_probability(light: u32, position: vec3f, normal: vec3f) -> f32 {
    if (HAS_LIGHT_TREE) {
        return light_tree_probability(light, light_receiver(position, normal));
    }
    return light_at(light).probability;
}

// A light, in proportion to its probability. One alone needs no numbers, but keeps their dimension.
fn choose_light(sampler: ptr<function, Sampler>) -> u32 {
    if (!HAS_SEVERAL_LIGHTS) {
        (*sampler).dimension += 1u;
        return 0u;
    }
    let choice = next_2d_bits(sampler);
    let index = multiply_high(choice.x, frame.light_count);
    let light = light_at(index);
    return select(light.alias_index, index, unit_float(choice.y) < light.threshold);
}

// The ray from a surface to a light sample: what it meets hides the light.
fn shadow_ray(s: Surface, light: LightSample) -> Ray {
    var ray = spawn_ray(s, light.wi);
    if (!light.at_infinity) {
        let target_point = offset_origin(light.position, light.position_error, light.normal, -light.wi);
        ray.direction = target_point - ray.origin;
        ray.t_max = 1.0;
        ray.end = light.triangle;
    }
    return ray;
}

// The share of a light sample's radiance that the medium on its side of the surface lets pass.
fn transmittance_to(s: Surface, media: Media, crossing: Crossing, light: LightSample, wi: vec3f) -> vec3f {
    if (!HAS_ABSORPTION) {
        return vec3f(1.0);
    }
    let distance = select(stable_length(light.position - s.position), T_INFINITE, light.at_infinity);
    return medium_transmittance(medium_of(select(media, crossing.media, wi.z < 0.0)), distance);
}

// 1 if a light sample's radiance reaches the surface, else 0; blended surfaces in between decide
// by chance.
fn visibility_of_light(s: Surface, light: LightSample, seed: u32) -> f32 {
    return select(1.0, 0.0, occluded(shadow_ray(s, light), seed));
}
