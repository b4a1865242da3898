//! A feature that a scene does not need changes no bit of its picture when it is compiled in.

use crate::common::*;
use etendue::render::Settings;
use etendue::scene::{Environment, Features, Scene};
use glam::Vec3;

/// A small picture with everything that the scene has.
fn settings() -> Settings {
    Settings {
        width: 24,
        height: 24,
        spp: 4,
        ..Settings::default()
    }
}

/// The bits of every pixel's sums.
fn bits(scene: &Scene, features: &[&str]) -> Vec<[u32; 3]> {
    let mut scene = scene.clone();
    scene.required_features = features.iter().map(|name| name.to_string()).collect();
    let film = render(&scene, &settings());
    let pixels = film.pixels.iter();
    pixels.map(|pixel| pixel.sum.map(f32::to_bits)).collect()
}

/// What a scene does not need.
fn absent(scene: &Scene) -> Vec<&'static str> {
    let flags = Features::of(scene).flags();
    flags
        .into_iter()
        .filter(|flag| !flag.1)
        .map(|flag| flag.0)
        .collect()
}

fn assert_same(scene: &Scene, features: &[&str], what: &str) {
    let (without, with) = (bits(scene, &[]), bits(scene, features));
    let pairs = without.iter().zip(&with);
    let different = pairs.filter(|(a, b)| a != b).count();
    assert_eq!(
        different, 0,
        "{what}: {features:?} change {different} pixels"
    );
    assert!(
        without.iter().any(|pixel| pixel.iter().any(|&c| c != 0)),
        "{what} is black"
    );
}

/// A scene without lamps and back faces that are not seen: the sky lights it.
fn under_the_sky() -> Scene {
    let mut scene = load("sphere_grid");
    for material in &mut scene.materials {
        material.emissive = Vec3::ZERO;
        material.double_sided = true;
    }
    scene.environment = Some(Environment {
        radiance: [1.0; 3],
        rotation: 0.0,
        image: None,
    });
    scene
}

/// Each feature by itself, in the first scene without it.
#[test]
fn each_feature_that_is_not_used_changes_nothing() {
    let scenes = [
        ("cornell box", load("cornell_box")),
        ("foliage", load("foliage")),
        ("furnace", load("furnace")),
        ("spheres under the sky", under_the_sky()),
    ];
    for name in Features::names() {
        let lacking = scenes
            .iter()
            .find(|(_, scene)| absent(scene).contains(&name));
        match lacking {
            Some((what, scene)) => assert_same(scene, &[name], what),
            // These have no part of the shader of their own.
            None => assert!(["lit", "flat_normals", "diffuse"].contains(&name), "{name}"),
        }
    }
}

/// All of them together.
#[test]
fn all_features_at_once_change_nothing() {
    for name in ["cornell_box", "foliage", "veach_mis", "sphere_grid"] {
        let scene = load(name);
        assert_same(&scene, &absent(&scene), name);
    }
}
