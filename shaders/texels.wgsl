// What a material's textures say at a point: all are looked up by one piece of code, which goes from slot to slot, since each
// copy of it takes long to compile (docs/kernel.md).

#include "bindings.wgsl"
#include "texture.wgsl"
#include "steps.wgsl"

// The texel of each slot, or white where a material has none.
struct Texels {
    base_color: vec4f,
    metallic_roughness: vec4f,
    normal: vec4f,
    emissive: vec4f,
    specular: vec4f,
    specular_color: vec4f,
    transmission: vec4f,
    diffuse_transmission: vec4f,
    diffuse_transmission_color: vec4f,
    clearcoat: vec4f,
    clearcoat_roughness: vec4f,
    clearcoat_normal: vec4f,
    sheen_color: vec4f,
    sheen_roughness: vec4f,
    anisotropy: vec4f,
    iridescence: vec4f,
    iridescence_thickness: vec4f,
}

// What a slot without a texture has as its last component where white would not be neutral.
const NO_TEXEL: f32 = -1.0;

// Numbers of the slots that the scene has, from 0.
const BASE_COLOR_SLOT: u32 = 0u;
const METALLIC_ROUGHNESS_SLOT: u32 = BASE_COLOR_SLOT + select(0u, 1u, HAS_BASE_COLOR_TEXTURE);
const NORMAL_SLOT: u32 = METALLIC_ROUGHNESS_SLOT + select(0u, 1u, HAS_METALLIC_ROUGHNESS_TEXTURE);
const EMISSIVE_SLOT: u32 = NORMAL_SLOT + select(0u, 1u, HAS_NORMAL_TEXTURE);
const SPECULAR_SLOT: u32 = EMISSIVE_SLOT + select(0u, 1u, HAS_EMISSIVE_TEXTURE);
const SPECULAR_COLOR_SLOT: u32 = SPECULAR_SLOT + select(0u, 1u, HAS_SPECULAR_TEXTURE);
const TRANSMISSION_SLOT: u32 = SPECULAR_COLOR_SLOT + select(0u, 1u, HAS_SPECULAR_COLOR_TEXTURE);
const DIFFUSE_TRANSMISSION_SLOT: u32 = TRANSMISSION_SLOT + select(0u, 1u, HAS_TRANSMISSION_TEXTURE);
const DIFFUSE_TRANSMISSION_COLOR_SLOT: u32 = DIFFUSE_TRANSMISSION_SLOT + select(0u, 1u, HAS_DIFFUSE_TRANSMISSION_TEXTURE);
const CLEARCOAT_SLOT: u32 = DIFFUSE_TRANSMISSION_COLOR_SLOT + select(0u, 1u, HAS_DIFFUSE_TRANSMISSION_TEXTURE);
const CLEARCOAT_ROUGHNESS_SLOT: u32 = CLEARCOAT_SLOT + select(0u, 1u, HAS_CLEARCOAT_TEXTURE);
const CLEARCOAT_NORMAL_SLOT: u32 = CLEARCOAT_ROUGHNESS_SLOT + select(0u, 1u, HAS_CLEARCOAT_TEXTURE);
const SHEEN_COLOR_SLOT: u32 = CLEARCOAT_NORMAL_SLOT + select(0u, 1u, HAS_CLEARCOAT_NORMAL_TEXTURE);
const SHEEN_ROUGHNESS_SLOT: u32 = SHEEN_COLOR_SLOT + select(0u, 1u, HAS_SHEEN_TEXTURE);
const ANISOTROPY_SLOT: u32 = SHEEN_ROUGHNESS_SLOT + select(0u, 1u, HAS_SHEEN_TEXTURE);
const IRIDESCENCE_SLOT: u32 = ANISOTROPY_SLOT + select(0u, 1u, HAS_ANISOTROPY_TEXTURE);
const IRIDESCENCE_THICKNESS_SLOT: u32 = IRIDESCENCE_SLOT + select(0u, 1u, HAS_IRIDESCENCE_TEXTURE);
const TEXTURE_SLOTS: u32 = IRIDESCENCE_THICKNESS_SLOT + select(0u, 1u, HAS_IRIDESCENCE_TEXTURE);

fn texels_at(material: u32, uv0: vec2f, uv1: vec2f) -> Texels {
    var texels = no_texels();
    for (var number = 0u; number < TEXTURE_SLOTS; number += 1u) {
        if (count_step()) {
            break;
        }
        let slot = texture_slot(material, number);
        if (slot.texture != NONE) {
            put_texel(&texels, number, sample_texture(slot, uv0, uv1));
        }
    }
    return texels;
}

// Those on which the emission of a triangle depends, as at a light sample.
fn emission_texels(material: u32, uv0: vec2f, uv1: vec2f) -> Texels {
    var texels = no_texels();
    if (HAS_EMISSIVE_TEXTURE && material_emissive_texture(material).texture != NONE) {
        texels.emissive = sample_texture(material_emissive_texture(material), uv0, uv1);
    }
    if (HAS_CLEARCOAT_TEXTURE && material_clearcoat_texture(material).texture != NONE) {
        texels.clearcoat = sample_texture(material_clearcoat_texture(material), uv0, uv1);
    }
    return texels;
}

fn no_texels() -> Texels {
    let white = vec4f(1.0);
    let none = vec4f(vec3f(1.0), NO_TEXEL);
    return Texels(
        white, white, none, white, white, white, white, white, white, white, white, none, white, white, none, white, white,
    );
}

// A slot of a material by its number.
fn texture_slot(material: u32, number: u32) -> TextureSlot {
    var slot: TextureSlot;
    slot.texture = NONE;
    if (HAS_BASE_COLOR_TEXTURE && number == BASE_COLOR_SLOT) {
        slot = material_base_color_texture(material);
    }
    if (HAS_METALLIC_ROUGHNESS_TEXTURE && number == METALLIC_ROUGHNESS_SLOT) {
        slot = material_metallic_roughness_texture(material);
    }
    if (HAS_NORMAL_TEXTURE && number == NORMAL_SLOT) {
        slot = material_normal_texture(material);
    }
    if (HAS_EMISSIVE_TEXTURE && number == EMISSIVE_SLOT) {
        slot = material_emissive_texture(material);
    }
    if (HAS_SPECULAR_TEXTURE && number == SPECULAR_SLOT) {
        slot = material_specular_texture(material);
    }
    if (HAS_SPECULAR_COLOR_TEXTURE && number == SPECULAR_COLOR_SLOT) {
        slot = material_specular_color_texture(material);
    }
    if (HAS_TRANSMISSION_TEXTURE && number == TRANSMISSION_SLOT) {
        slot = material_transmission_texture(material);
    }
    if (HAS_DIFFUSE_TRANSMISSION_TEXTURE && number == DIFFUSE_TRANSMISSION_SLOT) {
        slot = material_diffuse_transmission_texture(material);
    }
    if (HAS_DIFFUSE_TRANSMISSION_TEXTURE && number == DIFFUSE_TRANSMISSION_COLOR_SLOT) {
        slot = material_diffuse_transmission_color_texture(material);
    }
    if (HAS_CLEARCOAT_TEXTURE && number == CLEARCOAT_SLOT) {
        slot = material_clearcoat_texture(material);
    }
    if (HAS_CLEARCOAT_TEXTURE && number == CLEARCOAT_ROUGHNESS_SLOT) {
        slot = material_clearcoat_roughness_texture(material);
    }
    if (HAS_CLEARCOAT_NORMAL_TEXTURE && number == CLEARCOAT_NORMAL_SLOT) {
        slot = material_clearcoat_normal_texture(material);
    }
    if (HAS_SHEEN_TEXTURE && number == SHEEN_COLOR_SLOT) {
        slot = material_sheen_color_texture(material);
    }
    if (HAS_SHEEN_TEXTURE && number == SHEEN_ROUGHNESS_SLOT) {
        slot = material_sheen_roughness_texture(material);
    }
    if (HAS_ANISOTROPY_TEXTURE && number == ANISOTROPY_SLOT) {
        slot = material_anisotropy_texture(material);
    }
    if (HAS_IRIDESCENCE_TEXTURE && number == IRIDESCENCE_SLOT) {
        slot = material_iridescence_texture(material);
    }
    if (HAS_IRIDESCENCE_TEXTURE && number == IRIDESCENCE_THICKNESS_SLOT) {
        slot = material_iridescence_thickness_texture(material);
    }
    return slot;
}

fn put_texel(texels: ptr<function, Texels>, number: u32, texel: vec4f) {
    if (HAS_BASE_COLOR_TEXTURE && number == BASE_COLOR_SLOT) {
        (*texels).base_color = texel;
    }
    if (HAS_METALLIC_ROUGHNESS_TEXTURE && number == METALLIC_ROUGHNESS_SLOT) {
        (*texels).metallic_roughness = texel;
    }
    if (HAS_NORMAL_TEXTURE && number == NORMAL_SLOT) {
        (*texels).normal = texel;
    }
    if (HAS_EMISSIVE_TEXTURE && number == EMISSIVE_SLOT) {
        (*texels).emissive = texel;
    }
    if (HAS_SPECULAR_TEXTURE && number == SPECULAR_SLOT) {
        (*texels).specular = texel;
    }
    if (HAS_SPECULAR_COLOR_TEXTURE && number == SPECULAR_COLOR_SLOT) {
        (*texels).specular_color = texel;
    }
    if (HAS_TRANSMISSION_TEXTURE && number == TRANSMISSION_SLOT) {
        (*texels).transmission = texel;
    }
    if (HAS_DIFFUSE_TRANSMISSION_TEXTURE && number == DIFFUSE_TRANSMISSION_SLOT) {
        (*texels).diffuse_transmission = texel;
    }
    if (HAS_DIFFUSE_TRANSMISSION_TEXTURE && number == DIFFUSE_TRANSMISSION_COLOR_SLOT) {
        (*texels).diffuse_transmission_color = texel;
    }
    if (HAS_CLEARCOAT_TEXTURE && number == CLEARCOAT_SLOT) {
        (*texels).clearcoat = texel;
    }
    if (HAS_CLEARCOAT_TEXTURE && number == CLEARCOAT_ROUGHNESS_SLOT) {
        (*texels).clearcoat_roughness = texel;
    }
    if (HAS_CLEARCOAT_NORMAL_TEXTURE && number == CLEARCOAT_NORMAL_SLOT) {
        (*texels).clearcoat_normal = texel;
    }
    if (HAS_SHEEN_TEXTURE && number == SHEEN_COLOR_SLOT) {
        (*texels).sheen_color = texel;
    }
    if (HAS_SHEEN_TEXTURE && number == SHEEN_ROUGHNESS_SLOT) {
        (*texels).sheen_roughness = texel;
    }
    if (HAS_ANISOTROPY_TEXTURE && number == ANISOTROPY_SLOT) {
        (*texels).anisotropy = texel;
    }
    if (HAS_IRIDESCENCE_TEXTURE && number == IRIDESCENCE_SLOT) {
        (*texels).iridescence = texel;
    }
    if (HAS_IRIDESCENCE_TEXTURE && number == IRIDESCENCE_THICKNESS_SLOT) {
        (*texels).iridescence_thickness = texel;
    }
}
