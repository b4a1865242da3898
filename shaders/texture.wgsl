// Texture look-up from storage buffers: exact filtering and wrapping, alike on every device.

#include "bindings.wgsl"

// The texture of a slot at a vertex-interpolated coordinate: RGBA, linear.
fn sample_texture(slot: TextureSlot, uv0: vec2f, uv1: vec2f) -> vec4f {
    let uv = select(uv0, uv1, slot.tex_coord == 1u);
    let m = slot.matrix;
    let p = vec2f(m.x * uv.x + m.z * uv.y, m.y * uv.x + m.w * uv.y) + slot.offset;
    return filter_texture(textures[slot.texture], p);
}

fn filter_texture(info: Texture, uv: vec2f) -> vec4f {
    let size = vec2f(f32(info.width), f32(info.height));
    // Fold into one period (two if mirrored) while the number is small and still exact.
    let p = fold_coordinates(info.flags, uv) * size;
    if (!HAS_LINEAR_FILTER || (info.flags & TEXTURE_LINEAR) == 0u) {
        let cell = vec2i(floor(p));
        return load_texel(info, cell.x, cell.y);
    }
    let q = p - 0.5;
    let cell = vec2i(floor(q));
    let f = q - floor(q);
    let top = mix(load_texel(info, cell.x, cell.y), load_texel(info, cell.x + 1, cell.y), f.x);
    let bottom = mix(load_texel(info, cell.x, cell.y + 1), load_texel(info, cell.x + 1, cell.y + 1), f.x);
    return mix(top, bottom, f.y);
}

fn fold_coordinates(flags: u32, uv: vec2f) -> vec2f {
    return vec2f(
        fold_coordinate((flags >> TEXTURE_WRAP_U_SHIFT) & 3u, uv.x),
        fold_coordinate((flags >> TEXTURE_WRAP_V_SHIFT) & 3u, uv.y),
    );
}

fn fold_coordinate(wrap: u32, u: f32) -> f32 {
    let repeated = u - floor(u);
    let mirrored = u - 2.0 * floor(0.5 * u);
    return select(select(repeated, mirrored, wrap == 1u), clamp(u, -1.0, 2.0), wrap == 0u);
}

fn wrap_index(wrap: u32, index: i32, size: i32) -> i32 {
    if (wrap == 2u) {
        // Clamped, since coordinates may be infinite, and sides beyond 2^24 round.
        return clamp(index - size * i32(floor((f32(index) + 0.5) / f32(size))), 0, size - 1);
    }
    if (wrap == 1u) {
        let period = index - 2 * size * i32(floor((f32(index) + 0.5) / f32(2 * size)));
        return clamp(select(period, 2 * size - 1 - period, period >= size), 0, size - 1);
    }
    return clamp(index, 0, size - 1);
}

fn load_texel(info: Texture, x: i32, y: i32) -> vec4f {
    let column = u32(wrap_index((info.flags >> TEXTURE_WRAP_U_SHIFT) & 3u, x, i32(info.width)));
    let row = u32(wrap_index((info.flags >> TEXTURE_WRAP_V_SHIFT) & 3u, y, i32(info.height)));
    let index = row * info.width + column;
    if (HAS_16_BIT_TEXTURES && (info.flags & TEXTURE_16_BIT) != 0u) {
        let word = info.first_word + 2u * index;
        return vec4f(unpack2x16unorm(load_texel_word(word)), unpack2x16unorm(load_texel_word(word + 1u)));
    }
    let word = load_texel_word(info.first_word + index);
    if ((info.flags & TEXTURE_SRGB) == 0u) {
        return unpack4x8unorm(word);
    }
    return vec4f(
        srgb_to_linear[word & 255u],
        srgb_to_linear[(word >> 8u) & 255u],
        srgb_to_linear[(word >> 16u) & 255u],
        f32(word >> 24u) * (1.0 / 255.0),
    );
}
