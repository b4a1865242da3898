// Arithmetic by itself: a pair or four of words in, words out.

#include "math/float.wgsl"
#include "math/trigonometry.wgsl"
#include "film.wgsl"
#include "geometry/triangle.wgsl"

@group(0) @binding(13) var<uniform> params: vec4u;
@group(0) @binding(14) var<storage, read> inputs: array<vec4u>;
@group(0) @binding(15) var<storage, read_write> outputs: array<vec4u>;

// cos and sin of 2 pi x, the angle of (x, y), and of w the integer part and the neighbours.
@compute @workgroup_size(64)
fn functions(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= params.x) {
        return;
    }
    let v = bitcast<vec4f>(inputs[id.x]);
    let turn = cos_sin_2pi(v.x);
    outputs[2u * id.x] = vec4u(bitcast<vec2u>(turn), bitcast<u32>(arctan2(v.y, v.z)), floor_to_u32(v.w));
    outputs[2u * id.x + 1u] = vec4u(
        bitcast<u32>(next_up(v.w)),
        bitcast<u32>(next_down(v.w)),
        u32(is_finite(v.www)),
        multiply_high(inputs[id.x].x, inputs[id.x].y),
    );
}

@compute @workgroup_size(64)
fn edges(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= params.x) {
        return;
    }
    let v = bitcast<vec4f>(inputs[id.x]);
    outputs[id.x] = bitcast<vec4u>(vec4f(
        exact_product_error(v.x, v.y),
        exact_edge(v.xy, v.zw),
        exact_edge_refined(v.xy, v.zw),
        exact_edge_refined(v.zw, v.xy),
    ));
}

// Adds params.y terms to the sums of a lane: word i of the inputs' first vector times a power of
// two that follows from a hash of the term's index, backwards if params.w is set.
@compute @workgroup_size(64)
fn accumulate(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= params.x) {
        return;
    }
    let x = bitcast<vec3f>(inputs[id.x].xyz);
    var sum = DoubleVec3(bitcast<vec3f>(outputs[2u * id.x].xyz), bitcast<vec3f>(outputs[2u * id.x + 1u].xyz));
    for (var i = 0u; i < params.y; i += 1u) {
        let term = select(params.z + i, params.z - i, params.w == 1u);
        let factor = vec3f(1.0, 1.0, f32(1u << (((term * 2654435761u) >> 16u) & 15u)));
        sum = exact_accumulate(sum.high, sum.low, x * factor);
    }
    outputs[2u * id.x] = vec4u(bitcast<vec3u>(sum.high), 0u);
    outputs[2u * id.x + 1u] = vec4u(bitcast<vec3u>(sum.low), 0u);
}
