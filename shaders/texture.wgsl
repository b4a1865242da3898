// Texture look-up from storage buffers: exact filtering and wrapping, alike on every device.

#include "bindings.wgsl"
#include "math/float.wgsl"

// The texture of a slot at a vertex-interpolated coordinate: RGBA, linear.
fn sample_texture(slot: TextureSlot, uv0: vec2f, uv1: vec2f) -> vec4f {
    let uv = select(uv0, uv1, slot.tex_coord == 1u);
    let m = slot.matrix;
    let p = vec2f(m.x * uv.x + m.z * uv.y, m.y * uv.x + m.w * uv.y) + slot.offset;
    return filter_texture(texture_at(slot.texture), p);
}

fn filter_texture(info: Texture, uv: vec2f) -> vec4f {
    let size = vec2u(info.width, info.height);
    let wrap = (vec2u(info.flags) >> vec2u(TEXTURE_WRAP_U_SHIFT, TEXTURE_WRAP_V_SHIFT)) & vec2u(3u);
    // Fold into one period (two if mirrored) while the number is small and still exact.
    let p = vec2f(fold_coordinate(wrap.x, uv.x), fold_coordinate(wrap.y, uv.y)) * vec2f(size);
    if (!HAS_LINEAR_FILTER || (info.flags & TEXTURE_LINEAR) == 0u) {
        return load_texel(info, wrap_index(wrap, vec2u(floor_to_u32(p.x), floor_to_u32(p.y)), size));
    }
    let q = p - 0.5;
    let f = q - floor(q);
    // The texels after q's, which are never negative; those before the first wrap by themselves.
    let next = vec2u(floor_to_u32(floor(q.x) + 1.0), floor_to_u32(floor(q.y) + 1.0));
    let before_first = select(vec2u(0u), size - 1u, wrap == vec2u(2u));
    let low = wrap_index(wrap, select(next - 1u, before_first, next == vec2u(0u)), size);
    let high = wrap_index(wrap, next, size);
    let top = mix(load_texel(info, low), load_texel(info, vec2u(high.x, low.y)), f.x);
    let bottom = mix(load_texel(info, vec2u(low.x, high.y)), load_texel(info, high), f.x);
    return mix(top, bottom, f.y);
}

fn fold_coordinate(wrap: u32, u: f32) -> f32 {
    let repeated = u - floor(u);
    let mirrored = u - 2.0 * floor(0.5 * u);
    return select(select(repeated, mirrored, wrap == 1u), clamp(u, -1.0, 2.0), wrap == 0u);
}

// The texel of an index below two periods. Compared rather than divided: lavapipe divides integers
// lane by lane.
fn wrap_index(wrap: vec2u, index: vec2u, size: vec2u) -> vec2u {
    let period = size << (wrap & vec2u(1u));
    let folded = select(index, index - period, index >= period);
    let mirrored = select(folded, 2u * size - 1u - folded, folded >= size);
    // Clamped in all modes, since coordinates may be infinite.
    return min(select(mirrored, index, wrap == vec2u(0u)), size - 1u);
}

fn load_texel(info: Texture, at: vec2u) -> vec4f {
    let index = at.y * info.width + at.x;
    if (HAS_16_BIT_TEXTURES && (info.flags & TEXTURE_16_BIT) != 0u) {
        let word = info.first_word + 2u * index;
        return vec4f(unpack2x16unorm(load_texel_word(word)), unpack2x16unorm(load_texel_word(word + 1u)));
    }
    let word = load_texel_word(info.first_word + index);
    if ((info.flags & TEXTURE_SRGB) == 0u) {
        return unpack4x8unorm(word);
    }
    return vec4f(
        load_srgb_to_linear(word & 255u),
        load_srgb_to_linear((word >> 8u) & 255u),
        load_srgb_to_linear((word >> 16u) & 255u),
        f32(word >> 24u) * (1.0 / 255.0),
    );
}
