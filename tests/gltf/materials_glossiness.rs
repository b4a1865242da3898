//! KHR_materials_pbrSpecularGlossiness.

use etendue::scene::*;
use glam::{Vec3, Vec4};
use serde_json::{Value, json};

use crate::common::*;
use crate::materials_extensions::use_of_texture;

/// A square with both models, of which the extension counts.
fn glossy(extension: Value) -> Builder {
    let mut builder = Builder::textured();
    builder.json["materials"][0] = json!({
        "pbrMetallicRoughness": {
            "baseColorFactor": [1, 0, 1, 1], "metallicFactor": 0.5, "roughnessFactor": 0.1,
            "baseColorTexture": {"index": 0}, "metallicRoughnessTexture": {"index": 0},
        },
        "extensions": {"KHR_materials_pbrSpecularGlossiness": extension},
    });
    builder
}

#[test]
fn it_takes_the_place_of_the_metallic_roughness_model() {
    let scene = glossy(json!({
        "diffuseFactor": [0.25, 0.5, 0.75, 0.5], "specularFactor": [0.75, 0.5, 0.25], "glossinessFactor": 0.75,
    }))
    .scene();
    let m = &scene.materials[0];
    assert_eq!(m.base_color, Vec4::new(0.25, 0.5, 0.75, 0.5));
    assert_eq!((m.metallic, m.roughness), (0.0, 0.25));
    // Schlick's term whose reflectance at normal incidence is the specular colour.
    assert_eq!((m.ior, m.specular), (0.0, 1.0));
    assert_eq!(m.specular_color, Vec3::new(0.75, 0.5, 0.25));
    assert_eq!(m.texture_slots().count(), 0);
    assert!(!m.glossiness_texture);
    let features = Features::of(&scene);
    assert!(features.diffuse && features.specular && features.ior && !features.metallic);
}

#[test]
fn its_defaults_are_white_and_smooth() {
    let m = glossy(json!({})).scene().materials[0].clone();
    assert_eq!((m.base_color, m.specular_color), (Vec4::ONE, Vec3::ONE));
    assert_eq!((m.roughness, m.metallic, m.ior), (0.0, 0.0, 0.0));
}

#[test]
fn its_textures_hold_colours_and_glossiness() {
    let builder = glossy(json!({
        "diffuseTexture": use_of_texture(1), "specularGlossinessTexture": use_of_texture(2),
    }));
    let scene = builder.scene();
    let m = &scene.materials[0];
    let offset = |slot: Option<TextureSlot>| slot.map(|slot| 32.0 * slot.offset.x);
    assert_eq!(offset(m.base_color_texture), Some(1.0));
    assert_eq!(offset(m.specular_color_texture), Some(2.0));
    assert_eq!(m.texture_slots().count(), 2);
    assert!(m.glossiness_texture && Features::of(&scene).glossiness_texture);
}

/// A black specular colour leaves the grazing reflection, whose roughness is in the texture.
#[test]
fn glossiness_is_read_without_specular_colour() {
    let black = json!({"specularFactor": [0, 0, 0], "specularGlossinessTexture": {"index": 0}});
    let scene = glossy(black).scene();
    assert!(scene.materials[0].specular_color_texture.is_some());
    assert!(Features::of(&scene).specular_color_texture);
}
