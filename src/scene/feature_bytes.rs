//! What each feature costs on the device.

use std::collections::BTreeSet;

use super::{Material, Scene, Texels, TextureSlot};

/// Bytes that are on the device for the sake of a feature: vertex attributes, images, distributions. Several
/// features may share an image, which then counts for each.
pub fn of(scene: &Scene, feature: &str) -> u64 {
    match feature {
        "normals" => 12 * vertices(scene),
        "tangents" | "colors" => 16 * vertices(scene),
        "uv0" | "uv1" => 8 * vertices(scene),
        "environment_image" => environment(scene),
        _ => match feature.strip_suffix("_texture") {
            Some(family) => images(scene, family),
            None => 0,
        },
    }
}

/// Vertices of all instances.
fn vertices(scene: &Scene) -> u64 {
    let of_mesh = |mesh: usize| scene.meshes[mesh].positions.len() as u64;
    scene.instances.iter().map(|i| of_mesh(i.mesh)).sum()
}

/// Four words of radiance and density a texel, and one of the distribution.
fn environment(scene: &Scene) -> u64 {
    let image = scene.environment.as_ref().and_then(|e| e.image.as_ref());
    image.map_or(0, |image| 20 * image.texels.len() as u64)
}

/// The images of the slots whose names begin with that of the family, but for those of families of their own.
fn images(scene: &Scene, family: &str) -> u64 {
    let own = ["specular_color", "clearcoat_normal"];
    let is_in = |name: &str| match own.iter().find(|own| name.starts_with(**own)) {
        Some(own) => *own == family,
        None => name == family || name.starts_with(&format!("{family}_")),
    };
    let slots = |material: &Material| -> Vec<TextureSlot> {
        let slots = material.named_slots().into_iter();
        slots
            .filter(|(name, _)| is_in(name))
            .filter_map(|(_, slot)| *slot)
            .collect()
    };
    let used = scene
        .instances
        .iter()
        .map(|i| scene.meshes[i.mesh].material);
    let used: BTreeSet<usize> = used.collect();
    let slots = used
        .into_iter()
        .flat_map(|material| slots(&scene.materials[material]));
    let images: BTreeSet<usize> = slots
        .map(|slot| scene.textures[slot.texture].image)
        .collect();
    let bytes = |image: usize| {
        let image = &scene.images[image];
        let texel = if matches!(image.texels, Texels::Rgba16(_)) {
            8
        } else {
            4
        };
        texel * u64::from(image.width) * u64::from(image.height)
    };
    images.into_iter().map(bytes).sum()
}
