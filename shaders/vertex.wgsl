// What a scene's vertices carry, as pairs of words at generated offsets, counted in pairs: attributes that no material of
// the scene reads are not there.

#include "bindings.wgsl"

fn vertex_vec3(i: u32) -> vec3f {
    return vec3f(load_vertex_pair(i), load_vertex_pair(i + 1u).x);
}

fn vertex_vec4(i: u32) -> vec4f {
    return vec4f(load_vertex_pair(i), load_vertex_pair(i + 1u));
}

// The first pair of each of a triangle's vertices.
fn vertex_pairs(triangle: u32) -> vec3u {
    let i = 3u * triangle;
    return vec3u(load_index(i), load_index(i + 1u), load_index(i + 2u)) * VERTEX_STRIDE;
}

// TEXCOORD_0 and TEXCOORD_1 of a point of a triangle (zero where absent).
fn texture_coordinates(triangle: u32, b: vec3f) -> vec4f {
    var uv = vec4f(0.0);
    if (HAS_UV0 || HAS_UV1) {
        let first = vertex_pairs(triangle);
        if (HAS_UV0) {
            uv = vec4f(interpolate_vec2(first + UV0_OFFSET, b), uv.zw);
        }
        if (HAS_UV1) {
            uv = vec4f(uv.xy, interpolate_vec2(first + UV1_OFFSET, b));
        }
    }
    return uv;
}

fn interpolate_vec2(pairs: vec3u, b: vec3f) -> vec2f {
    return b.x * load_vertex_pair(pairs.x) + b.y * load_vertex_pair(pairs.y) + b.z * load_vertex_pair(pairs.z);
}

fn interpolate_vec3(pairs: vec3u, b: vec3f) -> vec3f {
    return b.x * vertex_vec3(pairs.x) + b.y * vertex_vec3(pairs.y) + b.z * vertex_vec3(pairs.z);
}

fn interpolate_vec4(pairs: vec3u, b: vec3f) -> vec4f {
    return b.x * vertex_vec4(pairs.x) + b.y * vertex_vec4(pairs.y) + b.z * vertex_vec4(pairs.z);
}
