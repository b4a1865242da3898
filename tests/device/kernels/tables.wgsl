// What is read of lights, materials and textures by their number.

#include "light.wgsl"

@group(0) @binding(13) var<uniform> params: vec4u;
@group(0) @binding(14) var<storage, read> inputs: array<vec4f>;
@group(0) @binding(15) var<storage, read_write> outputs: array<vec4u>;

const ROWS: u32 = 8u;

// Entry id.x of each table, as far as there are so many: params.y lights, params.z materials, params.w textures.
@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= params.x) {
        return;
    }
    let i = id.x;
    let row = ROWS * i;
    if (i < params.y) {
        let light = light_at(i);
        outputs[row] = vec4u(bitcast<u32>(light.threshold), light.alias_index, bitcast<u32>(light.probability), light.kind_and_index);
        if (light.kind_and_index >> LIGHT_KIND_SHIFT == LIGHT_TRIANGLE) {
            let triangle = light_triangle(light.kind_and_index & LIGHT_INDEX_MASK);
            outputs[row + 1u] = vec4u(bitcast<vec3u>(triangle.v1), triangle.index);
        }
    }
    if (i < params.z) {
        let slot = material_base_color_texture(i);
        outputs[row + 2u] = bitcast<vec4u>(material_base_color(i));
        outputs[row + 3u] = vec4u(bitcast<vec3u>(material_emissive(i)), material_flags(i));
        outputs[row + 4u] = vec4u(bitcast<u32>(material_roughness(i)), slot.texture, bitcast<vec2u>(slot.offset));
        outputs[row + 5u] = bitcast<vec4u>(slot.matrix);
    }
    if (i < params.w) {
        let texture = texture_at(i);
        outputs[row + 6u] = vec4u(texture.first_word, texture.width, texture.height, texture.flags);
    }
}
