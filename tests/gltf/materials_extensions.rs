//! The extensions that add lobes to materials: factors, textures, defaults and what is dropped.

use etendue::scene::*;
use glam::{Vec2, Vec3};
use serde_json::{Value, json};

use crate::common::*;

/// The k-th use of the one texture, told from others by its offset.
pub fn use_of_texture(k: usize) -> Value {
    let moved = json!({"KHR_texture_transform": {"offset": [k as f64 / 32.0, 0]}});
    json!({"index": 0, "texCoord": 0, "extensions": moved})
}

/// A square whose material has every lobe with every texture; slot k of [`Material::named_slots`] reads the
/// texture with the offset k / 32.
pub fn layered() -> Builder {
    let mut builder = Builder::textured();
    let mut coat_normal = use_of_texture(11);
    coat_normal["scale"] = json!(0.25);
    builder.json["materials"][0] = json!({
        "pbrMetallicRoughness": {
            "baseColorTexture": use_of_texture(0),
            "metallicFactor": 0.5,
            "metallicRoughnessTexture": use_of_texture(1),
        },
        "normalTexture": use_of_texture(2),
        "emissiveFactor": [1, 1, 1],
        "emissiveTexture": use_of_texture(3),
        "extensions": {
            "KHR_materials_specular": {
                "specularTexture": use_of_texture(4),
                "specularColorTexture": use_of_texture(5),
            },
            "KHR_materials_transmission": {
                "transmissionFactor": 0.5, "transmissionTexture": use_of_texture(6),
            },
            "KHR_materials_volume": {
                "thicknessFactor": 0.5, "attenuationDistance": 2, "attenuationColor": [1, 0.5, 0],
            },
            "KHR_materials_dispersion": {"dispersion": 0.25},
            "KHR_materials_diffuse_transmission": {
                "diffuseTransmissionFactor": 0.75,
                "diffuseTransmissionTexture": use_of_texture(7),
                "diffuseTransmissionColorFactor": [0.25, 0.5, 0.75],
                "diffuseTransmissionColorTexture": use_of_texture(8),
            },
            "KHR_materials_clearcoat": {
                "clearcoatFactor": 0.75,
                "clearcoatTexture": use_of_texture(9),
                "clearcoatRoughnessFactor": 0.5,
                "clearcoatRoughnessTexture": use_of_texture(10),
                "clearcoatNormalTexture": coat_normal,
            },
            "KHR_materials_sheen": {
                "sheenColorFactor": [0.5, 0.25, 0.75],
                "sheenColorTexture": use_of_texture(12),
                "sheenRoughnessFactor": 0.5,
                "sheenRoughnessTexture": use_of_texture(13),
            },
            "KHR_materials_anisotropy": {
                "anisotropyStrength": 0.5, "anisotropyRotation": -7, "anisotropyTexture": use_of_texture(14),
            },
            "KHR_materials_iridescence": {
                "iridescenceFactor": 0.5,
                "iridescenceTexture": use_of_texture(15),
                "iridescenceIor": 1.75,
                "iridescenceThicknessMinimum": 150,
                "iridescenceThicknessMaximum": 550,
                "iridescenceThicknessTexture": use_of_texture(16),
            },
        },
    });
    builder
}

/// A square whose material has one extension.
pub fn with_extension(name: &str, extension: Value) -> Builder {
    let mut builder = Builder::textured();
    builder.json["materials"][0]["extensions"] = json!({name: extension});
    builder
}

/// The scene's material of a square whose material has one extension.
fn material_with(name: &str, extension: Value) -> Material {
    with_extension(name, extension).scene().materials[0].clone()
}

#[test]
fn every_factor_is_read() {
    let scene = layered().scene();
    let m = &scene.materials[0];
    assert_eq!((m.transmission, m.solid, m.dispersion), (0.5, true, 0.25));
    // Beer and Lambert: what passes over the distance is the colour; nothing of a colour of 0.
    let half = (0.5f64.ln() / -2.0) as f32;
    assert_eq!(m.absorption, Vec3::new(0.0, half, f32::MAX));
    assert_eq!(m.diffuse_transmission, 0.75);
    assert_eq!(m.diffuse_transmission_color, Vec3::new(0.25, 0.5, 0.75));
    assert_eq!((m.clearcoat, m.clearcoat_roughness), (0.75, 0.5));
    assert_eq!((m.clearcoat_normal_scale, m.normal_scale), (0.25, 1.0));
    assert_eq!(m.sheen_color, Vec3::new(0.5, 0.25, 0.75));
    assert_eq!(m.sheen_roughness, 0.5);
    assert_eq!((m.anisotropy, m.anisotropy_rotation), (0.5, -7.0));
    assert_eq!((m.iridescence, m.iridescence_ior), (0.5, 1.75));
    assert_eq!(m.iridescence_thickness, [150.0, 550.0]);
}

#[test]
fn every_texture_is_read_in_its_own_slot() {
    let scene = layered().scene();
    for (k, (name, slot)) in scene.materials[0].named_slots().into_iter().enumerate() {
        let slot = slot.unwrap_or_else(|| panic!("{name} is empty"));
        assert_eq!(slot.offset, Vec2::new(k as f32 / 32.0, 0.0), "{name}");
    }
}

#[test]
fn extensions_without_content_hold_their_defaults() {
    for name in [
        "KHR_materials_transmission",
        "KHR_materials_volume",
        "KHR_materials_dispersion",
        "KHR_materials_diffuse_transmission",
        "KHR_materials_clearcoat",
        "KHR_materials_sheen",
        "KHR_materials_anisotropy",
        "KHR_materials_iridescence",
        "KHR_materials_specular",
        "KHR_materials_ior",
    ] {
        let m = material_with(name, json!({}));
        let expected = Material {
            name: "paint".into(),
            base_color_texture: m.base_color_texture,
            ..Material::default()
        };
        assert_eq!(m, expected, "{name}");
    }
}

/// The default thickness of 0 makes the surface a thin wall, in which nothing is absorbed.
#[test]
fn a_volume_without_thickness_is_a_thin_wall() {
    let mut builder = layered();
    let extensions = &mut builder.json["materials"][0]["extensions"];
    extensions["KHR_materials_volume"] =
        json!({"attenuationDistance": 1, "attenuationColor": [0, 0, 0]});
    let scene = builder.scene();
    assert!(!scene.materials[0].solid && scene.materials[0].transmission == 0.5);
    let features = Features::of(&scene);
    assert!(features.transmission && !features.media && !features.absorption);
    assert!(!features.dispersion);
}

/// Without a distance light goes infinitely far: nothing is absorbed, whatever the colour.
#[test]
fn an_infinite_attenuation_distance_absorbs_nothing() {
    for color in [json!([1, 1, 1]), json!([0, 0.5, 1])] {
        let volume = json!({"thicknessFactor": 1, "attenuationColor": color});
        let m = material_with("KHR_materials_volume", volume);
        assert_eq!((m.absorption, m.solid), (Vec3::ZERO, true));
    }
}

/// The flags of the lobes, in the order of their declaration.
fn lobes(scene: &Scene) -> Vec<&'static str> {
    const LOBES: [&str; 9] = [
        "transmission",
        "diffuse_transmission",
        "clearcoat",
        "sheen",
        "anisotropy",
        "iridescence",
        "media",
        "absorption",
        "dispersion",
    ];
    let flags = Features::of(scene).flags();
    let set = flags
        .into_iter()
        .filter(|(name, set)| *set && LOBES.contains(name));
    set.map(|(name, _)| name).collect()
}

#[test]
fn each_lobe_is_a_feature_of_its_own() {
    let glass = |more: Value| {
        let mut builder = with_extension(
            "KHR_materials_transmission",
            json!({"transmissionFactor": 1}),
        );
        builder.json["materials"][0]["extensions"]["KHR_materials_volume"] = more;
        builder.json["materials"][0]["pbrMetallicRoughness"] = json!({"metallicFactor": 0});
        builder
    };
    assert_eq!(lobes(&glass(json!(null)).scene()), ["transmission"]);
    let clear = glass(json!({"thicknessFactor": 1}));
    assert_eq!(lobes(&clear.scene()), ["transmission", "media"]);
    let tinted =
        json!({"thicknessFactor": 1, "attenuationDistance": 1, "attenuationColor": [1, 0.5, 1]});
    let tinted = glass(tinted);
    assert_eq!(
        lobes(&tinted.scene()),
        ["transmission", "media", "absorption"]
    );
    let mut prism = clear;
    prism.json["materials"][0]["extensions"]["KHR_materials_dispersion"] = json!({"dispersion": 1});
    assert_eq!(
        lobes(&prism.scene()),
        ["transmission", "media", "dispersion"]
    );
    for (extension, factor, value, feature) in [
        ("clearcoat", "clearcoatFactor", json!(0.5), "clearcoat"),
        ("sheen", "sheenColorFactor", json!([0, 0, 0.5]), "sheen"),
        ("anisotropy", "anisotropyStrength", json!(0.5), "anisotropy"),
        (
            "iridescence",
            "iridescenceFactor",
            json!(0.5),
            "iridescence",
        ),
    ] {
        let builder = with_extension(
            &format!("KHR_materials_{extension}"),
            json!({factor: value}),
        );
        assert_eq!(lobes(&builder.scene()), [feature]);
    }
    let all = lobes(&layered().scene());
    assert_eq!(all.len(), 9, "{all:?}");
}

/// Light does not pass through a metal.
#[test]
fn metals_neither_transmit_nor_bound_media() {
    let mut builder = layered();
    let pbr = &mut builder.json["materials"][0]["pbrMetallicRoughness"];
    *pbr = json!({"metallicFactor": 1});
    assert_eq!(
        lobes(&builder.scene()),
        ["clearcoat", "sheen", "anisotropy", "iridescence"]
    );
}

/// A factor of 0 is as good as no extension, whatever its textures hold.
#[test]
fn factors_of_zero_count_as_absent() {
    let mut builder = layered();
    for (extension, factor, zero) in [
        ("specular", "specularFactor", json!(0)),
        ("transmission", "transmissionFactor", json!(0)),
        (
            "diffuse_transmission",
            "diffuseTransmissionFactor",
            json!(0),
        ),
        ("clearcoat", "clearcoatFactor", json!(0)),
        ("sheen", "sheenColorFactor", json!([0, 0, 0])),
        ("anisotropy", "anisotropyStrength", json!(0)),
        ("iridescence", "iridescenceFactor", json!(0)),
    ] {
        let extensions = &mut builder.json["materials"][0]["extensions"];
        extensions[format!("KHR_materials_{extension}")][factor] = zero;
    }
    let scene = builder.scene();
    assert_eq!(lobes(&scene), Vec::<&str>::new());
    assert_eq!(scene.materials[0].dispersion, 0.0);
    let filled = scene.materials[0].named_slots();
    let filled: Vec<&str> = filled
        .iter()
        .filter(|s| s.1.is_some())
        .map(|s| s.0)
        .collect();
    assert_eq!(
        filled,
        ["base_color", "metallic_roughness", "normal", "emissive"]
    );
    let features = Features::of(&scene);
    assert!(
        !features.clearcoat_texture && !features.sheen_texture && !features.iridescence_texture
    );
    assert!(!features.transmission_texture && !features.diffuse_transmission_texture);
    assert!(!features.anisotropy_texture && !features.clearcoat_normal_texture);
}

#[test]
fn unlit_materials_have_no_lobes() {
    let mut builder = layered();
    builder.json["materials"][0]["extensions"]["KHR_materials_unlit"] = json!({});
    let scene = builder.scene();
    assert_eq!(lobes(&scene), Vec::<&str>::new());
    let m = &scene.materials[0];
    assert_eq!(m.texture_slots().count(), 1);
    assert!(m.base_color_texture.is_some() && !m.transmits() && !m.bounds_medium());
    assert!(!Features::of(&scene).tangents);
}

/// A film lies over a metal also where the dielectric reflects nothing.
#[test]
fn films_on_metals_need_no_dielectric_reflection() {
    let mut builder = layered();
    builder.json["materials"][0]["extensions"]["KHR_materials_specular"] =
        json!({"specularFactor": 0});
    let m = builder.scene().materials[0].clone();
    assert!(m.iridescence_texture.is_some() && m.iridescence_thickness_texture.is_some());
    builder.json["materials"][0]["pbrMetallicRoughness"] = json!({"metallicFactor": 0});
    let scene = builder.scene();
    assert!(scene.materials[0].iridescence_texture.is_none() && !Features::of(&scene).iridescence);
}
