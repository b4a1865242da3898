// Light sampling in a scene, from a point of a surface.

#include "math/float.wgsl"
#include "light.wgsl"
#include "accel/stack.wgsl"

@group(0) @binding(13) var<uniform> params: vec4u;
// The point (w is 1 if light from both sides counts), the shading normal, then directions.
@group(0) @binding(14) var<storage, read> inputs: array<vec4f>;
@group(0) @binding(15) var<storage, read_write> outputs: array<vec4f>;

fn test_surface() -> Surface {
    var s: Surface;
    s.position = inputs[0].xyz;
    s.normal = inputs[1].xyz;
    s.shading = frame_from_z(inputs[1].xyz);
    return s;
}

fn both_sides() -> bool {
    return inputs[0].w != 0.0;
}

fn write(index: u32, s: LightSample) {
    outputs[3u * index] = vec4f(s.wi, s.pdf);
    outputs[3u * index + 1u] = vec4f(s.weight, select(0.0, 1.0, s.at_infinity));
    outputs[3u * index + 2u] = vec4f(s.position, select(0.0, 1.0, s.delta));
}

// Any light; params.y is the seed.
@compute @workgroup_size(64)
fn sample_any(@builtin(global_invocation_id) id: vec3u) {
    if (id.x < params.x) {
        var random = sampler_begin(vec2u(5u, 9u), vec2u(id.x, 0u), params.y);
        write(id.x, sample_light(test_surface(), false, &random));
    }
}

@compute @workgroup_size(64)
fn sample_environment(@builtin(global_invocation_id) id: vec3u) {
    if (id.x < params.x) {
        var random = sampler_begin(vec2u(5u, 9u), vec2u(id.x, 0u), params.y);
        write(id.x, environment_sample(test_surface(), both_sides(), next_2d_bits(&random)));
    }
}

// Mean over params.z samples of what the environment sends to the surface, for a pixel of its own.
@compute @workgroup_size(64)
fn estimate_environment(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= params.x) {
        return;
    }
    let s = test_surface();
    var sum = vec3f(0.0);
    for (var i = 0u; i < params.z; i += 1u) {
        var random = sampler_begin(vec2u(id.x, 3u), vec2u(i, 0u), params.y);
        let light = environment_sample(s, both_sides(), next_2d_bits(&random));
        sum += light.weight * max(dot(light.wi, s.normal), 0.0);
    }
    outputs[id.x] = vec4f(sum / f32(params.z), 0.0);
}

// Column and row of the cell that a pair of numbers chooses, and where in it.
@compute @workgroup_size(64)
fn invert_environment(@builtin(global_invocation_id) id: vec3u) {
    if (id.x < params.x) {
        let normal = select(inputs[1].xyz, vec3f(0.0), both_sides());
        let p = environment_choose(bitcast<vec2u>(inputs[2u + id.x].xy), normal);
        outputs[id.x] = vec4f(f32(p.cell.x), f32(p.cell.y), p.inside);
    }
}

// Radiance and pdf of the environment.
@compute @workgroup_size(64)
fn evaluate_environment(@builtin(global_invocation_id) id: vec3u) {
    if (id.x < params.x) {
        let d = inputs[2u + id.x].xyz;
        let light = environment_light(inputs[1].xyz, both_sides(), d, false);
        outputs[id.x] = vec4f(light.radiance, light.pdf);
    }
}

// Radiance of the triangle that a direction meets, and the density with which light sampling
// returns the direction, as the path integrator computes it for a hit.
@compute @workgroup_size(64)
fn evaluate_triangles(@builtin(global_invocation_id) id: vec3u, @builtin(local_invocation_index) lane: u32) {
    stack_lane = lane;
    if (id.x >= params.x) {
        return;
    }
    let ray = free_ray(inputs[0].xyz, inputs[2u + id.x].xyz);
    let hit = intersect(ray, false, 0u);
    var result = vec4f(0.0);
    if (hit.triangle != NONE) {
        let s = surface_at(ray, hit);
        let distance = stable_length(s.position - ray.origin);
        let pdf = light_triangle_pdf(distance, abs(dot(s.wo, s.normal)), s.area);
        let chosen = light_probability(s.light, ray.origin, inputs[1].xyz);
        result = vec4f(emitted_radiance(s), chosen * pdf);
    }
    outputs[id.x] = result;
}
