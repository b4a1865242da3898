// Texture look-up.

#include "math/float.wgsl"
#include "texture.wgsl"

@group(0) @binding(13) var<uniform> params: vec4u;
// Coordinates.
@group(0) @binding(14) var<storage, read> inputs: array<vec2f>;
@group(0) @binding(15) var<storage, read_write> outputs: array<vec4f>;

// Texture params.y at each coordinate.
@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if (id.x < params.x) {
        outputs[id.x] = filter_texture(load_texture(params.y), inputs[id.x]);
    }
}
