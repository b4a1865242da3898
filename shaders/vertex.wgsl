// What a scene's vertices carry, as words at generated offsets: attributes that no material of the
// scene reads are not there.

#include "bindings.wgsl"

fn vertex_vec2(i: u32) -> vec2f {
    return vec2f(load_vertex_word(i), load_vertex_word(i + 1u));
}

fn vertex_vec3(i: u32) -> vec3f {
    return vec3f(load_vertex_word(i), load_vertex_word(i + 1u), load_vertex_word(i + 2u));
}

fn vertex_vec4(i: u32) -> vec4f {
    return vec4f(vertex_vec2(i), vertex_vec2(i + 2u));
}

// TEXCOORD_0 and TEXCOORD_1 of a point of a triangle (zero where absent).
fn texture_coordinates(triangle: u32, b: vec3f) -> vec4f {
    var uv = vec4f(0.0);
    if (HAS_UV0 || HAS_UV1) {
        let i0 = load_index(3u * triangle) * VERTEX_STRIDE;
        let i1 = load_index(3u * triangle + 1u) * VERTEX_STRIDE;
        let i2 = load_index(3u * triangle + 2u) * VERTEX_STRIDE;
        if (HAS_UV0) {
            uv = vec4f(interpolate_vec2(i0 + UV0_OFFSET, i1 + UV0_OFFSET, i2 + UV0_OFFSET, b), uv.zw);
        }
        if (HAS_UV1) {
            uv = vec4f(uv.xy, interpolate_vec2(i0 + UV1_OFFSET, i1 + UV1_OFFSET, i2 + UV1_OFFSET, b));
        }
    }
    return uv;
}

fn interpolate_vec2(i0: u32, i1: u32, i2: u32, b: vec3f) -> vec2f {
    return b.x * vertex_vec2(i0) + b.y * vertex_vec2(i1) + b.z * vertex_vec2(i2);
}

fn interpolate_vec4(i0: u32, i1: u32, i2: u32, b: vec3f) -> vec4f {
    return b.x * vertex_vec4(i0) + b.y * vertex_vec4(i1) + b.z * vertex_vec4(i2);
}
