//! Materials as the device holds them.

use super::layout::{self, MATERIAL_BLEND, MATERIAL_DOUBLE_SIDED, MATERIAL_MASK, MATERIAL_UNLIT};
use super::textures::{Encoding, TextureSet};
use crate::scene::{AlphaMode, Material, Scene};

/// Every material of the scene, their textures added to `textures`.
pub fn materials(scene: &Scene, textures: &mut TextureSet) -> Vec<layout::Material> {
    let used = used_materials(scene);
    scene
        .materials
        .iter()
        .zip(used)
        .map(|(m, used)| {
            if used {
                material(scene, m, textures)
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
        ior_f0: ior_f0(m.ior),
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
        ..Default::default()
    }
}

/// Reflectance at normal incidence; an index of 0 stands for full reflection (KHR_materials_ior).
fn ior_f0(ior: f32) -> f32 {
    let n = f64::from(ior);
    (((n - 1.0) / (n + 1.0)).powi(2)) as f32
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
    flags
}
