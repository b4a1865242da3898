//! `LoadOptions::lenient`: what is wrong in the file is shown in magenta, and a warning names it.

use std::fs;

use etendue::scene::gltf::{LoadOptions, load};
use etendue::scene::{Scene, Texels};
use glam::Vec4;
use serde_json::json;
use tempfile::TempDir;

use crate::common::*;

/// Refused as it is, with these parts in the sentence; with `lenient` loaded, with the same sentence as
/// a warning.
fn leniently(builder: &Builder, parts: &[&str]) -> Scene {
    refused(builder.clone(), parts);
    let folder = TempDir::new().expect("a temporary folder");
    let path = folder.path().join("scene.glb");
    fs::write(&path, builder.glb()).expect("writable");
    let options = LoadOptions {
        lenient: true,
        ..LoadOptions::default()
    };
    let scene = load(&path, &options).unwrap_or_else(|error| panic!("{error}"));
    scene.validate().unwrap_or_else(|error| panic!("{error}"));
    for part in parts.iter().chain(&["magenta is shown instead"]) {
        warned(&scene, part);
    }
    scene
}

fn is_magenta(scene: &Scene, image: usize) -> bool {
    let image = &scene.images[image];
    matches!(&image.texels, Texels::Rgba8(texels) if texels[..] == [[255, 0, 255, 255]])
}

#[test]
fn wrong_textures_are_magenta() {
    let absent = with("images/0", json!({"uri": "absent.png"}));
    let scene = leniently(&absent, &["image 0", "absent.png"]);
    assert!(is_magenta(&scene, 0));
    let missing = with("textures/0", json!({}));
    assert!(is_magenta(
        &leniently(&missing, &["texture 0", "`source` is missing"]),
        0
    ));
    let out_of_range = with("textures/0", json!({"source": 7}));
    assert!(is_magenta(
        &leniently(&out_of_range, &["texture 0", "image 7"]),
        0
    ));
    let sampler = with("textures/0", json!({"source": 0, "sampler": 3}));
    assert!(is_magenta(
        &leniently(&sampler, &["texture 0", "sampler 3"]),
        0
    ));
    let mut damaged = Builder::textured();
    let view = damaged.view(b"GIF89a");
    damaged.json["images"][0]["bufferView"] = json!(view);
    assert!(is_magenta(
        &leniently(&damaged, &["image 0 \"checks\" of texture 0", "GIF"]),
        0
    ));
}

#[test]
fn textures_of_formats_that_are_not_read_are_magenta() {
    let mut builder = Builder::textured();
    let extension = json!({"EXT_texture_avif": {"source": 0}});
    builder.json["textures"][0] = json!({"extensions": extension});
    assert!(is_magenta(
        &leniently(&builder, &["texture 0", "EXT_texture_avif"]),
        0
    ));
    builder.json["extensionsUsed"] = json!(["EXT_texture_avif"]);
    builder.json["extensionsRequired"] = json!(["EXT_texture_avif"]);
    assert!(is_magenta(&leniently(&builder, &["EXT_texture_avif"]), 0));
}

#[test]
fn one_wrong_texture_leaves_the_others_alone() {
    let mut builder = crate::seeds::textured();
    builder.json["images"][1] = json!({"uri": "absent.png"});
    let scene = leniently(&builder, &["image 1 (file \"absent.png\")"]);
    assert_eq!(scene.images.len(), 3);
    let magenta = (0..3).filter(|&image| is_magenta(&scene, image)).count();
    assert_eq!(magenta, 1);
    assert!(is_magenta(&scene, scene.textures[1].image));
}

#[test]
fn wrong_materials_are_magenta_and_unlit() {
    for (pointer, value, part) in [
        (
            "materials/0/pbrMetallicRoughness/metallicFactor",
            json!("shiny"),
            "`metallicFactor` must be a finite number",
        ),
        (
            "materials/0/pbrMetallicRoughness/baseColorTexture",
            json!({"index": 9}),
            "texture 9",
        ),
        (
            "materials/0/alphaMode",
            json!("SOMETIMES"),
            "`alphaMode` must be",
        ),
    ] {
        let builder = with(pointer, value);
        let scene = leniently(&builder, &["material 0 \"paint\"", part]);
        let material = &scene.materials[0];
        assert!(material.unlit && material.double_sided);
        assert_eq!(material.base_color, Vec4::new(1.0, 0.0, 1.0, 1.0));
        assert_eq!(material.texture_slots().count(), 0);
    }
}

#[test]
fn a_wrong_image_based_light_is_magenta() {
    let mut builder = crate::image_light::lit(&crate::image_light::colored());
    builder.json["images"][4] = json!({"uri": "absent.png"});
    let scene = leniently(&builder, &["image 4 (file \"absent.png\")"]);
    let environment = scene.environment.expect("an environment");
    assert_eq!(environment.radiance, [1.0, 0.0, 1.0]);
    assert!(environment.image.is_none());
}

#[test]
fn what_is_right_is_the_same() {
    let folder = TempDir::new().expect("a temporary folder");
    let path = folder.path().join("scene.glb");
    fs::write(&path, crate::seeds::textured().glb()).expect("writable");
    let lenient = |lenient| {
        let options = LoadOptions {
            lenient,
            ..LoadOptions::default()
        };
        format!("{:?}", load(&path, &options).expect("a scene"))
    };
    assert_eq!(lenient(false), lenient(true));
}
