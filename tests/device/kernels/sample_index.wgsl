// The 64-bit sample index, as the renderer's kernel computes it.

#include "main.wgsl"

@group(0) @binding(13) var<uniform> params: vec4u;
// Low and high half of the first sample's index, samples to add.
@group(0) @binding(14) var<storage, read> inputs: array<vec4u>;
@group(0) @binding(15) var<storage, read_write> outputs: array<vec2u>;

@compute @workgroup_size(64)
fn sum(@builtin(global_invocation_id) id: vec3u) {
    if (id.x < params.x) {
        outputs[id.x] = add_u64(inputs[id.x].x, inputs[id.x].y, inputs[id.x].z);
    }
}
