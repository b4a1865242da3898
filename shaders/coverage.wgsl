// Where a surface is there at all: alpha masks, alpha blending, and faces that the camera does not see.

#include "bindings.wgsl"
#include "vertex.wgsl"
#include "texture.wgsl"
#include "sampler.wgsl"

// The fraction of light that a surface stops at a point: 0 or 1 if masked, alpha if blended.
fn coverage(triangle: Triangle, b: vec3f) -> f32 {
    if (!HAS_ALPHA || (triangle.flags & TRIANGLE_ALPHA) == 0u) {
        return 1.0;
    }
    var alpha = material_base_color(triangle.material).a;
    if (HAS_COLORS && (triangle.flags & TRIANGLE_COLORS) != 0u) {
        alpha *= interpolate_vec4(vertex_pairs(triangle.index) + COLOR_OFFSET, b).a;
    }
    let slot = material_base_color_texture(triangle.material);
    if (HAS_BASE_COLOR_TEXTURE && slot.texture != NONE) {
        let uv = texture_coordinates(triangle.index, b);
        alpha *= sample_texture(slot, uv.xy, uv.zw).a;
    }
    if ((material_flags(triangle.material) & MATERIAL_MASK) != 0u) {
        return select(0.0, 1.0, alpha >= material_alpha_cutoff(triangle.material));
    }
    return clamp(alpha, 0.0, 1.0);
}

// Whether the camera looks through a triangle because it sees the back.
fn is_culled(triangle_flags: u32, back_face: bool, camera: bool) -> bool {
    return HAS_SINGLE_SIDED && camera && back_face && (triangle_flags & TRIANGLE_SINGLE_SIDED) != 0u;
}

// Whether a ray meets the surface at this hit. Blended surfaces are met with probability alpha,
// decided by a hash of the ray's seed and the triangle, so that the order in which a traversal
// finds hits has no influence.
fn accept_hit(triangle: Triangle, b: vec3f, back_face: bool, camera: bool, seed: u32) -> bool {
    if (is_culled(triangle.flags, back_face, camera)) {
        return false;
    }
    if (HAS_ALPHA && (triangle.flags & TRIANGLE_ALPHA) != 0u) {
        return unit_float(hash2(vec2u(seed, triangle.index))) < coverage(triangle, b);
    }
    return true;
}
