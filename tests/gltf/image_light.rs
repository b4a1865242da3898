//! EXT_lights_image_based: the scene's environment from a cube of images.

use etendue::scene::{Environment, Features, Scene};
use image::ExtendedColorType::{Rgb8, Rgba8};
use serde_json::{Value, json};

use crate::common::*;
use crate::pictures::png;

/// Colours of the faces +X, −X, +Y, −Y, +Z, −Z: all different, each channel 0 or 255.
const COLORS: [[u8; 3]; 6] = [
    [255, 0, 0],
    [0, 255, 255],
    [0, 255, 0],
    [255, 0, 255],
    [0, 0, 255],
    [255, 255, 0],
];

/// A scene lit by six images of `side` × `side` pixels.
pub fn lit(faces: &[Vec<u8>]) -> Builder {
    let mut builder = Builder::square();
    let views: Vec<usize> = faces.iter().map(|face| builder.view(face)).collect();
    let images: Vec<Value> = views
        .iter()
        .map(|view| json!({"bufferView": view}))
        .collect();
    builder.json["images"] = json!(images);
    let light = json!({
        "name": "sky",
        "specularImages": [[0, 1, 2, 3, 4, 5]],
        "irradianceCoefficients": vec![[0; 3]; 9],
        "specularImageSize": 2,
    });
    builder.json["extensionsUsed"] = json!(["EXT_lights_image_based"]);
    builder.json["extensions"] = json!({"EXT_lights_image_based": {"lights": [light]}});
    builder.json["scenes"][0]["extensions"] = json!({"EXT_lights_image_based": {"light": 0}});
    builder
}

/// Faces of one colour each.
pub fn colored() -> Vec<Vec<u8>> {
    let face = |color: &[u8; 3]| png(2, 2, Rgb8, &color.repeat(4));
    COLORS.iter().map(face).collect()
}

fn environment(scene: &Scene) -> &Environment {
    scene.environment.as_ref().expect("an environment")
}

/// The texel of the environment's picture that is seen in a direction.
fn seen(scene: &Scene, [x, y, z]: [f64; 3]) -> [f32; 3] {
    use std::f64::consts::PI;
    let image = environment(scene).image.as_ref().expect("a picture");
    let u = 0.5 + z.atan2(x) / (2.0 * PI);
    let v = (y / (x * x + y * y + z * z).sqrt()).acos() / PI;
    let at = |share: f64, count: usize| ((share * count as f64) as usize).min(count - 1);
    image.texels[at(v, image.height) * image.width + at(u, image.width)]
}

fn axis(index: usize) -> [f64; 3] {
    let mut axis = [0.0; 3];
    axis[index / 2] = if index.is_multiple_of(2) { 1.0 } else { -1.0 };
    axis
}

#[test]
fn faces_are_where_their_names_say() {
    let scene = lit(&colored()).scene();
    silent(&scene);
    let image = environment(&scene).image.as_ref().expect("a picture");
    assert_eq!((image.width, image.height), (8, 4));
    for (index, color) in COLORS.iter().enumerate() {
        // Off the axis a little, so as to be in the middle of no edge.
        let axis = axis(index).map(|c| c + 0.05);
        let expected = color.map(|c| f32::from(c) / 255.0);
        // A texel of a face may reach over its edge near the poles.
        let found = seen(&scene, axis);
        let error = found.iter().zip(expected).map(|(a, b)| (a - b).abs());
        assert!(error.fold(0.0, f32::max) < 0.35, "{index}: {found:?}");
    }
    assert!(Features::of(&scene).environment_image);
    let note = "the environment is EXT_lights_image_based, light 0 \"sky\"";
    assert!(
        scene.notes.iter().any(|n| n.starts_with(note)),
        "{:?}",
        scene.notes
    );
}

/// Left and right, top and bottom: seen from inside as the picture is stored.
#[test]
fn faces_are_seen_from_inside_as_they_are_stored() {
    let side = 32;
    // Red grows to the right, green downwards.
    let level = |i: usize| (i as f64 * 255.0 / (side - 1) as f64) as u8;
    let pixels: Vec<u8> = (0..side * side)
        .flat_map(|i| [level(i % side), level(i / side), 0])
        .collect();
    let mut faces = colored();
    let dark = png(side as u32, side as u32, Rgb8, &vec![0; side * side * 3]);
    faces.fill(dark);
    faces[5] = png(side as u32, side as u32, Rgb8, &pixels);
    let mut builder = lit(&faces);
    builder.json["extensions"]["EXT_lights_image_based"]["lights"][0]["specularImageSize"] =
        json!(side);
    let scene = builder.scene();
    // Looking along −Z: right is +X, up is +Y.
    let [left, right] = [-0.6, 0.6].map(|x| seen(&scene, [x, 0.0, -1.0]));
    let [top, bottom] = [0.6, -0.6].map(|y| seen(&scene, [0.0, y, -1.0]));
    assert!(right[0] > 4.0 * left[0], "{left:?} {right:?}");
    assert!(bottom[1] > 4.0 * top[1], "{top:?} {bottom:?}");
}

#[test]
fn rotation_and_intensity_are_honoured() {
    let mut builder = lit(&colored());
    let light = |builder: &mut Builder, key: &str, value: Value| {
        builder.json["extensions"]["EXT_lights_image_based"]["lights"][0][key] = value;
    };
    // A quarter turn about +Y: what was at +X goes to −Z.
    let half = std::f64::consts::FRAC_1_SQRT_2;
    light(&mut builder, "rotation", json!([0, half, 0, half]));
    light(&mut builder, "intensity", json!(2.5));
    let scene = builder.scene();
    assert_eq!(environment(&scene).radiance, [2.5; 3]);
    let found = seen(&scene, [0.05, 0.05, -1.0]);
    assert!(
        found[0] > 0.9 && found[1] < 0.35 && found[2] < 0.35,
        "{found:?}"
    );
}

/// RGBD: linear colour is that of sRGB-encoded RGB over alpha.
#[test]
fn alpha_divides() {
    let bright = png(2, 2, Rgba8, &[255, 188, 0, 51].repeat(4));
    let scene = lit(&vec![bright; 6]).scene();
    let found = seen(&scene, [1.0, 0.0, 0.0]);
    // 188 is 0.5029 of sRGB; 51 is a fifth.
    for (found, expected) in found.iter().zip([5.0, 5.0 * 0.502_886_5, 0.0]) {
        assert!((found - expected).abs() < 1e-5, "{found} {expected}");
    }
    let none = png(2, 2, Rgba8, &[255, 0, 0, 0].repeat(4));
    let scene = lit(&vec![none; 6]).scene();
    warned(&scene, "24 texels are divided by an alpha of 0");
    assert!((seen(&scene, [1.0, 0.0, 0.0])[0] - 255.0).abs() < 1e-3);
}

#[test]
fn lights_that_are_wrong_are_refused_by_name() {
    let name = "EXT_lights_image_based, light 0 \"sky\"";
    let with = |pointer: &str, value: Value| {
        let mut builder = lit(&colored());
        let pointer = format!("extensions/EXT_lights_image_based/lights/0/{pointer}");
        set(&mut builder.json, &pointer, value);
        builder
    };
    refused(
        with("specularImages", json!([])),
        &[name, "levels of six images"],
    );
    refused(
        with("specularImages", json!([[0, 1, 2]])),
        &[name, "levels of six images"],
    );
    refused(
        with("specularImages", json!([[0, 1, 2, 3, 4, 6]])),
        &[name, "image 6"],
    );
    refused(
        with("specularImages", json!([[0, 1, 2, 3, 4, "5"]])),
        &[name, "integers"],
    );
    refused(
        with("rotation", json!([0, 0, 0, 0])),
        &[name, "`rotation` is no rotation"],
    );
    refused(with("rotation", json!([0, 0, 0])), &[name, "array of 4"]);
    refused(with("intensity", json!(-1)), &[name, "`intensity` is -1"]);
    let mut faces = colored();
    faces[3] = png(1, 2, Rgb8, &[0; 6]);
    refused(
        lit(&faces),
        &[name, "image 3", "1 × 2 pixels, expected 2 × 2"],
    );
    faces[3] = b"GIF89a".to_vec();
    refused(
        lit(&faces),
        &["image 3 of EXT_lights_image_based, light 0", "GIF"],
    );
    let mut builder = lit(&colored());
    builder.json["scenes"][0]["extensions"]["EXT_lights_image_based"] = json!({"light": 4});
    refused(builder, &["scene 0", "image-based light 4"]);
    warned(
        &with("specularImageSize", json!(256)).scene(),
        "`specularImageSize` is 256",
    );
}

#[test]
fn a_scene_that_names_no_light_has_none() {
    let mut builder = lit(&colored());
    builder.json["scenes"][0]["extensions"] = json!({});
    assert!(builder.scene().environment.is_none());
}
