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

// The first word of each of a triangle's vertices.
fn vertex_words(triangle: u32) -> vec3u {
    let i = 3u * triangle;
    return vec3u(load_index(i), load_index(i + 1u), load_index(i + 2u)) * VERTEX_STRIDE;
}

// TEXCOORD_0 and TEXCOORD_1 of a point of a triangle (zero where absent).
fn texture_coordinates(triangle: u32, b: vec3f) -> vec4f {
    var uv = vec4f(0.0);
    if (HAS_UV0 || HAS_UV1) {
        let first = vertex_words(triangle);
        if (HAS_UV0) {
            uv = vec4f(interpolate_vec2(first + UV0_OFFSET, b), uv.zw);
        }
        if (HAS_UV1) {
            uv = vec4f(uv.xy, interpolate_vec2(first + UV1_OFFSET, b));
        }
    }
    return uv;
}

fn interpolate_vec2(words: vec3u, b: vec3f) -> vec2f {
    return b.x * vertex_vec2(words.x) + b.y * vertex_vec2(words.y) + b.z * vertex_vec2(words.z);
}

fn interpolate_vec3(words: vec3u, b: vec3f) -> vec3f {
    return b.x * vertex_vec3(words.x) + b.y * vertex_vec3(words.y) + b.z * vertex_vec3(words.z);
}

fn interpolate_vec4(words: vec3u, b: vec3f) -> vec4f {
    return b.x * vertex_vec4(words.x) + b.y * vertex_vec4(words.y) + b.z * vertex_vec4(words.z);
}
