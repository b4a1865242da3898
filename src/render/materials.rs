//! Materials as the device holds them.

use super::albedo::BsdfTables;
use super::layout::{
    self, MATERIAL_BLEND, MATERIAL_DOUBLE_SIDED, MATERIAL_GLOSSINESS, MATERIAL_MASK,
    MATERIAL_SOLID, MATERIAL_UNLIT,
};
use super::media::medium_ranks;
use super::textures::{Encoding, TextureSet};
use crate::scene::{AlphaMode, Material, Scene};

/// Every material of the scene, their textures added to `textures`.
pub fn materials(
    scene: &Scene,
    tables: &BsdfTables,
    textures: &mut TextureSet,
) -> Vec<layout::Material> {
    let used = used_materials(scene);
    let ranks = medium_ranks(scene);
    scene
        .materials
        .iter()
        .zip(used)
        .zip(ranks)
        .map(|((m, used), rank)| {
            if used {
                layout::Material {
                    medium_rank: rank,
                    albedo_table: tables.albedo(m.ior),
                    glass_table: tables.glass(m.ior),
                    ..material(scene, m, textures)
                }
            } else {
                layout::Material::default()
            }
        })
        .collect()
}

/// Which materials an instance shows; the others' images may never have been decoded.
fn used_materials(scene: &Scene) -> Vec<bool> {
    let mut used = vec![false; scene.materials.len()];
    for instance in &scene.instances {
        used[scene.meshes[instance.mesh].material] = true;
    }
    used
}

fn material(scene: &Scene, m: &Material, textures: &mut TextureSet) -> layout::Material {
    use Encoding::{Linear, Srgb};
    let mut slot = |slot: &Option<_>, encoding| textures.slot(scene, slot.as_ref(), encoding);
    layout::Material {
        base_color: m.base_color.to_array(),
        emissive: m.emissive.to_array(),
        metallic: m.metallic,
        specular_color: m.specular_color.to_array(),
        roughness: m.roughness,
        ior: m.ior,
        diffuse_transmission_color: m.diffuse_transmission_color.to_array(),
        diffuse_transmission: m.diffuse_transmission,
        sheen_color: m.sheen_color.to_array(),
        sheen_roughness: m.sheen_roughness,
        absorption: m.absorption.to_array(),
        transmission: m.transmission,
        clearcoat: m.clearcoat,
        clearcoat_roughness: m.clearcoat_roughness,
        clearcoat_normal_scale: m.clearcoat_normal_scale,
        dispersion: m.dispersion,
        anisotropy: m.anisotropy,
        anisotropy_cos: m.anisotropy_rotation.cos(),
        anisotropy_sin: m.anisotropy_rotation.sin(),
        iridescence: m.iridescence,
        iridescence_ior: m.iridescence_ior,
        iridescence_thickness_min: m.iridescence_thickness[0],
        iridescence_thickness_max: m.iridescence_thickness[1],
        specular: m.specular,
        normal_scale: m.normal_scale,
        alpha_cutoff: if let AlphaMode::Mask { cutoff } = m.alpha_mode {
            cutoff
        } else {
            0.0
        },
        flags: flags(m),
        base_color_texture: slot(&m.base_color_texture, Srgb),
        metallic_roughness_texture: slot(&m.metallic_roughness_texture, Linear),
        normal_texture: slot(&m.normal_texture, Linear),
        emissive_texture: slot(&m.emissive_texture, Srgb),
        specular_texture: slot(&m.specular_texture, Linear),
        specular_color_texture: slot(&m.specular_color_texture, Srgb),
        transmission_texture: slot(&m.transmission_texture, Linear),
        diffuse_transmission_texture: slot(&m.diffuse_transmission_texture, Linear),
        diffuse_transmission_color_texture: slot(&m.diffuse_transmission_color_texture, Srgb),
        clearcoat_texture: slot(&m.clearcoat_texture, Linear),
        clearcoat_roughness_texture: slot(&m.clearcoat_roughness_texture, Linear),
        clearcoat_normal_texture: slot(&m.clearcoat_normal_texture, Linear),
        sheen_color_texture: slot(&m.sheen_color_texture, Srgb),
        sheen_roughness_texture: slot(&m.sheen_roughness_texture, Linear),
        anisotropy_texture: slot(&m.anisotropy_texture, Linear),
        iridescence_texture: slot(&m.iridescence_texture, Linear),
        iridescence_thickness_texture: slot(&m.iridescence_thickness_texture, Linear),
        ..Default::default()
    }
}

fn flags(m: &Material) -> u32 {
    let mut flags = match m.alpha_mode {
        AlphaMode::Opaque => 0,
        AlphaMode::Mask { .. } => MATERIAL_MASK,
        AlphaMode::Blend => MATERIAL_BLEND,
    };
    if m.double_sided {
        flags |= MATERIAL_DOUBLE_SIDED;
    }
    if m.unlit {
        flags |= MATERIAL_UNLIT;
    }
    // An index of 0 refracts nothing.
    if m.bounds_medium() && m.ior >= 1.0 {
        flags |= MATERIAL_SOLID;
    }
    if m.glossiness_texture {
        flags |= MATERIAL_GLOSSINESS;
    }
    flags
}
