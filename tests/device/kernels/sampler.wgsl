// The sampler's numbers, two 32-bit words a dimension.

#include "math/float.wgsl"
#include "sampler.wgsl"

@group(0) @binding(13) var<uniform> params: vec4u;
// Pixel x, pixel y, low and high half of the sample index.
@group(0) @binding(14) var<storage, read> inputs: array<vec4u>;
@group(0) @binding(15) var<storage, read_write> outputs: array<vec2u>;

// Dimensions params.y to params.y + params.z - 1, with seed params.w.
@compute @workgroup_size(64)
fn dimensions(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= params.x) {
        return;
    }
    let v = inputs[id.x];
    var random = sampler_begin(v.xy, v.zw, params.w);
    random.dimension = params.y;
    for (var i = 0u; i < params.z; i += 1u) {
        outputs[id.x * params.z + i] = next_2d_bits(&random);
    }
}

// Of the sample with index v.z, for part v.w of params.y, the numbers of dimension params.z.
@compute @workgroup_size(64)
fn parts(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= params.x) {
        return;
    }
    let v = inputs[id.x];
    var random = part_of_sample(sampler_begin(v.xy, vec2u(v.z, 0u), params.w), params.y, v.w);
    random.dimension = params.z;
    outputs[id.x] = next_2d_bits(&random);
}
