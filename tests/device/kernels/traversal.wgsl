// Rays through an acceleration structure.

#include "math/float.wgsl"
#include "accel.wgsl"
#include "accel/stack.wgsl"

@group(0) @binding(13) var<uniform> params: vec4u;
// Origin and t_max, direction.
@group(0) @binding(14) var<storage, read> inputs: array<vec4f>;
@group(0) @binding(15) var<storage, read_write> outputs: array<vec4u>;

fn ray_of(i: u32) -> Ray {
    return Ray(inputs[2u * i].xyz, inputs[2u * i].w, inputs[2u * i + 1u].xyz, NONE, NONE);
}

// t, triangle, back face, occluded; then the barycentrics.
fn write_answer(i: u32, hit: Hit, occluded: bool) {
    outputs[2u * i] = vec4u(bitcast<u32>(hit.t), hit.triangle, u32(hit.back_face), u32(occluded));
    outputs[2u * i + 1u] = vec4u(bitcast<vec3u>(hit.b), 0u);
}

// Each question by itself.
@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u, @builtin(local_invocation_index) lane: u32) {
    stack_lane = lane;
    if (id.x < params.x) {
        let ray = ray_of(id.x);
        write_answer(id.x, intersect(ray, false, 0u), occluded(ray, 0u));
    }
}

// Both questions of each ray together: the closest hit of this one, with whether anything is in the
// way of the one params.y before it; traced in rounds of params.z elements.
@compute @workgroup_size(64)
fn together(@builtin(global_invocation_id) id: vec3u, @builtin(local_invocation_index) lane: u32) {
    stack_lane = lane;
    if (id.x < params.x) {
        let other = (id.x + params.x - params.y) % params.x;
        var t = begin_query(Query(ray_of(id.x), true, false, 0u, ray_of(other), true, 0u));
        while (!trace_on(&t, params.z)) {
        }
        let answer = trace_answer(t);
        write_answer(id.x, answer.hit, answer.occluded);
    }
}

// Whether anything is in the way from triangle to triangle: a ray as above, then the triangles.
@compute @workgroup_size(64)
fn between(@builtin(global_invocation_id) id: vec3u, @builtin(local_invocation_index) lane: u32) {
    stack_lane = lane;
    if (id.x < params.x) {
        let at = inputs[3u * id.x];
        let ends = bitcast<vec4u>(inputs[3u * id.x + 2u]);
        let ray = Ray(at.xyz, at.w, inputs[3u * id.x + 1u].xyz, ends.x, ends.y);
        write_answer(id.x, miss(ray), occluded(ray, 0u));
    }
}
