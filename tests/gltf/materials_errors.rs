//! Extensions of materials with wrong content: factors out of range and values of a wrong type.

use glam::Vec3;
use serde_json::{Value, json};

use crate::common::*;
use crate::materials_extensions::{layered, with_extension};

/// Extension, its factor, a value out of range, and what is used instead.
const OUT_OF_RANGE: [(&str, &str, f32, f32); 15] = [
    ("transmission", "transmissionFactor", 2.0, 1.0),
    ("volume", "thicknessFactor", -1.0, 0.0),
    ("dispersion", "dispersion", -1.0, 0.0),
    (
        "diffuse_transmission",
        "diffuseTransmissionFactor",
        -0.5,
        0.0,
    ),
    ("clearcoat", "clearcoatFactor", 1.5, 1.0),
    ("clearcoat", "clearcoatRoughnessFactor", -2.0, 0.0),
    ("sheen", "sheenRoughnessFactor", 3.0, 1.0),
    ("anisotropy", "anisotropyStrength", -1.0, 0.0),
    ("iridescence", "iridescenceFactor", 7.0, 1.0),
    ("iridescence", "iridescenceIor", 0.5, 1.0),
    ("iridescence", "iridescenceThicknessMinimum", -3.0, 0.0),
    ("iridescence", "iridescenceThicknessMaximum", -5.0, 0.0),
    ("specular", "specularFactor", 2.0, 1.0),
    ("pbrSpecularGlossiness", "glossinessFactor", -1.0, 0.0),
    ("emissive_strength", "emissiveStrength", -1.0, 0.0),
];

/// Extension, its colour, and whether 1 is the largest that it may be.
const COLORS: [(&str, &str, bool); 5] = [
    ("volume", "attenuationColor", true),
    ("sheen", "sheenColorFactor", true),
    (
        "diffuse_transmission",
        "diffuseTransmissionColorFactor",
        true,
    ),
    ("pbrSpecularGlossiness", "specularFactor", true),
    ("specular", "specularColorFactor", false),
];

const TEXTURES: [(&str, &str); 15] = [
    ("specular", "specularTexture"),
    ("specular", "specularColorTexture"),
    ("transmission", "transmissionTexture"),
    ("diffuse_transmission", "diffuseTransmissionTexture"),
    ("diffuse_transmission", "diffuseTransmissionColorTexture"),
    ("clearcoat", "clearcoatTexture"),
    ("clearcoat", "clearcoatRoughnessTexture"),
    ("clearcoat", "clearcoatNormalTexture"),
    ("sheen", "sheenColorTexture"),
    ("sheen", "sheenRoughnessTexture"),
    ("anisotropy", "anisotropyTexture"),
    ("iridescence", "iridescenceTexture"),
    ("iridescence", "iridescenceThicknessTexture"),
    ("pbrSpecularGlossiness", "diffuseTexture"),
    ("pbrSpecularGlossiness", "specularGlossinessTexture"),
];

fn one(extension: &str, key: &str, value: Value) -> Builder {
    with_extension(&format!("KHR_materials_{extension}"), json!({key: value}))
}

#[test]
fn factors_out_of_range_are_clamped_with_a_warning() {
    for (extension, key, value, used) in OUT_OF_RANGE {
        let scene = one(extension, key, json!(value)).scene();
        let sentence = format!(
            "material 0 \"paint\", KHR_materials_{extension}: `{key}` is {value}, outside its range; {used} is used"
        );
        warned(&scene, &sentence);
    }
    let over = layered_with("iridescence", "iridescenceThicknessMaximum", json!(-5)).scene();
    assert_eq!(over.materials[0].iridescence_thickness, [150.0, 0.0]);
    let over = layered_with("clearcoat", "clearcoatFactor", json!(1.5)).scene();
    assert_eq!(over.materials[0].clearcoat, 1.0);
}

/// The material with every lobe, one value of it changed.
fn layered_with(extension: &str, key: &str, value: Value) -> Builder {
    let mut builder = layered();
    builder.json["materials"][0]["extensions"][format!("KHR_materials_{extension}")][key] = value;
    builder
}

#[test]
fn colours_out_of_range_are_clamped_with_a_warning() {
    for (extension, key, bounded) in COLORS {
        let scene = one(extension, key, json!([-1, 0.5, 0.5])).scene();
        warned(
            &scene,
            &format!("`{key}` is -1, outside its range; 0 is used"),
        );
        let scene = one(extension, key, json!([0.5, 2, 0.5])).scene();
        let warns = scene.warnings.iter().any(|w| w.contains("`"));
        let warns = warns && scene.warnings.iter().any(|w| w.contains(key));
        assert_eq!(warns, bounded, "{key}: {:?}", scene.warnings);
    }
    let scene = layered_with("sheen", "sheenColorFactor", json!([2, -1, 0.5])).scene();
    assert_eq!(scene.materials[0].sheen_color, Vec3::new(1.0, 0.0, 0.5));
}

#[test]
fn values_of_a_wrong_type_are_errors() {
    for (extension, key, ..) in OUT_OF_RANGE {
        for wrong in [json!("much"), json!([1]), json!(true), json!({})] {
            let parts =
                [&format!("KHR_materials_{extension}: `{key}` must be a finite number")[..]];
            refused(one(extension, key, wrong), &parts);
        }
    }
    for (extension, key, _) in COLORS {
        for wrong in [
            json!(1),
            json!([1, 1]),
            json!([1, 1, "red"]),
            json!([1, 1, 1, 1]),
        ] {
            let parts = [&format!(
                "KHR_materials_{extension}: `{key}` must be an array of 3 finite numbers"
            )[..]];
            refused(one(extension, key, wrong), &parts);
        }
    }
    refused(
        one("anisotropy", "anisotropyRotation", json!("left")),
        &["`anisotropyRotation` must be a finite number"],
    );
    refused(
        layered_with(
            "clearcoat",
            "clearcoatNormalTexture",
            json!({"index": 0, "scale": "big"}),
        ),
        &["`scale` must be a finite number"],
    );
}

#[test]
fn textures_that_are_not_there_are_errors() {
    for (extension, key) in TEXTURES {
        refused(
            one(extension, key, json!({"index": 7})),
            &[&format!("KHR_materials_{extension}"), "7"],
        );
        refused(one(extension, key, json!({})), &[key, "`index` is missing"]);
        refused(one(extension, key, json!(0)), &[key]);
    }
}

#[test]
fn light_goes_a_distance_above_zero_until_it_is_attenuated() {
    for distance in [0.0, -2.0] {
        refused(
            one("volume", "attenuationDistance", json!(distance)),
            &[
                "KHR_materials_volume: `attenuationDistance` is",
                "expected a length above 0",
            ],
        );
    }
    refused(
        one("volume", "attenuationDistance", json!("far")),
        &["`attenuationDistance` must be a finite number"],
    );
    // So short that the coefficient is beyond any float: nothing passes.
    let opaque = json!({"thicknessFactor": 1, "attenuationDistance": 1e-300, "attenuationColor": [0.5, 1, 0]});
    let scene = with_extension("KHR_materials_volume", opaque).scene();
    assert_eq!(
        scene.materials[0].absorption,
        Vec3::new(f32::MAX, 0.0, f32::MAX)
    );
}

#[test]
fn indices_of_refraction_are_zero_or_at_least_one() {
    for ior in [0.5, -1.0] {
        refused(
            one("ior", "ior", json!(ior)),
            &["`ior` is", "expected 0 or at least 1"],
        );
    }
    assert_eq!(one("ior", "ior", json!(0)).scene().materials[0].ior, 0.0);
}
