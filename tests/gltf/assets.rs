//! The files in `../shared`, where that folder is present: each loads, or fails with the right sentence.

use std::path::Path;

use etendue::scene::gltf::{LoadError, LoadOptions, load};
use etendue::scene::{Features, Filter, Projection, Scene, Texels, Wrap};
use glam::DVec3;

use crate::common::{shared, silent, warned};

fn load_model(folder: &Path, name: &str) -> Result<Scene, LoadError> {
    load(&folder.join(name), &LoadOptions::default())
}

fn valid_model(folder: &Path, name: &str) -> Scene {
    let scene = load_model(folder, name).unwrap_or_else(|error| panic!("{error}"));
    scene
        .validate()
        .unwrap_or_else(|error| panic!("{name}: {error}"));
    scene
}

#[test]
fn models_hold_what_their_json_says() {
    let Some(models) = shared("assets/models") else {
        return;
    };
    // Triangles, instances, lights and images that used materials read: counted by a script that
    // reads only the files' JSON.
    for (name, triangles, instances, lights, images) in [
        ("AnisotropyStrengthTest.glb", 97240, 50, 0, 1),
        ("AttenuationTest.glb", 292, 23, 0, 2),
        ("ClearCoatTest.glb", 37116, 27, 0, 6),
        ("CornellBox.glb", 36, 6, 0, 0),
        ("FlightHelmet/FlightHelmet.gltf", 94722, 6, 0, 15),
        ("Fox.glb", 576, 1, 0, 1),
        ("Lights.glb", 12, 1, 4, 0),
        ("NormalTangentTest.glb", 7774, 1, 0, 3),
        ("SimpleSkin.gltf", 8, 1, 0, 0),
        ("SpecularTest.glb", 44828, 24, 0, 4),
        ("TransmissionRoughnessTest.glb", 77792, 9, 0, 5),
        ("TwoSidedPlane.glb", 2, 1, 0, 3),
        ("chess-board.glb", 178848, 8, 0, 8),
        ("glass-table.glb", 592, 5, 0, 0),
        ("morph-stress-test.glb", 2412, 2, 0, 2),
        ("simple-instancing.glb", 1500, 125, 0, 0),
    ] {
        let scene = valid_model(&models, name);
        let found = (
            scene.triangle_count(),
            scene.instances.len(),
            scene.lights.len(),
            scene.images.len(),
        );
        assert_eq!(found, (triangles, instances, lights, images), "{name}");
        assert_eq!(scene.cameras.len(), 1, "{name}");
    }
}

/// Its KTX2 files hold plain pixels under Zstandard, which the extension that it does not name would not allow.
#[test]
fn ktx2_textures_of_plain_pixels_are_read() {
    let Some(models) = shared("assets/models") else {
        return;
    };
    let scene = valid_model(&models, "AnisotropyBarnLamp/AnisotropyBarnLamp.gltf");
    warned(
        &scene,
        "(file \"AnisotropyBarnLamp_normalbump.ktx2\"): glTF allows its format only through KHR_texture_basisu",
    );
    let normals = scene
        .images
        .iter()
        .find(|i| i.name.contains("normalbump"))
        .expect("its normal map");
    assert_eq!((normals.width, normals.height), (1024, 1024));
    let Texels::Rgba8(texels) = &normals.texels else {
        panic!("8 bits");
    };
    // A normal map: most normals point nearly straight out.
    let upright = texels.iter().filter(|t| t[2] > 200).count();
    assert!(upright > texels.len() / 2, "{upright} of {}", texels.len());
}

#[test]
fn models_of_extensions_need_their_lobes() {
    let Some(models) = shared("assets/models") else {
        return;
    };
    for (name, expected) in [
        (
            "AnisotropyStrengthTest.glb",
            &["anisotropy", "tangents"][..],
        ),
        (
            "AttenuationTest.glb",
            &["transmission", "media", "absorption"],
        ),
        (
            "ClearCoatTest.glb",
            &["clearcoat", "clearcoat_texture", "clearcoat_normal_texture"],
        ),
        (
            "SpecularTest.glb",
            &["specular_texture", "specular_color_texture"],
        ),
        (
            "TransmissionRoughnessTest.glb",
            &["transmission", "media", "ior"],
        ),
        ("chess-board.glb", &["clearcoat"]),
    ] {
        let scene = valid_model(&models, name);
        silent(&scene);
        let flags = Features::of(&scene).flags();
        for feature in expected {
            assert!(flags.contains(&(feature, true)), "{name}: {feature}");
        }
    }
    // What passes through the metallic glass of this table is its alpha alone.
    let table = valid_model(&models, "glass-table.glb");
    silent(&table);
    let features = Features::of(&table);
    assert!(features.alpha_blend && !features.transmission && table.materials[0].metallic == 1.0);
}

#[test]
fn models_that_are_read_whole_raise_no_warning() {
    let Some(models) = shared("assets/models") else {
        return;
    };
    for name in [
        "morph-stress-test.glb",
        "Fox.glb",
        "SimpleSkin.gltf",
        "simple-instancing.glb",
    ] {
        silent(&valid_model(&models, name));
    }
    let fox = valid_model(&models, "Fox.glb");
    assert_eq!(fox.animation_names, ["Survey", "Walk", "Run"]);
    assert!(
        fox.notes[0].contains("the file has 3 animations"),
        "{:?}",
        fox.notes
    );
    silent(&valid_model(&models, "FlightHelmet/FlightHelmet.gltf"));
    silent(&valid_model(&models, "CornellBox.glb"));
}

#[test]
fn normal_maps_without_tangents_get_them() {
    let Some(models) = shared("assets/models") else {
        return;
    };
    let scene = valid_model(&models, "NormalTangentTest.glb");
    assert!(Features::of(&scene).tangents && !scene.meshes[0].tangents.is_empty());
    // Perpendicular to the normals, up to what welding across seams leaves.
    let mesh = &scene.meshes[0];
    let pairs = mesh.tangents.iter().zip(&mesh.normals);
    let slanted = pairs
        .filter(|(t, n)| t.truncate().dot(**n).abs() > 1e-3)
        .count();
    assert_eq!(slanted, 0, "of {}", mesh.tangents.len());
}

#[test]
fn references_are_read_as_their_readme_says() {
    let Some(folder) = shared("reference") else {
        return;
    };
    let cornell = valid_model(&folder, "cornell.gltf");
    assert_eq!((cornell.triangle_count(), cornell.lights.len()), (36, 0));
    assert!(
        cornell
            .materials
            .iter()
            .all(|m| m.metallic == 0.0 && m.specular == 0.0)
    );
    assert!(!Features::of(&cornell).specular && Features::of(&cornell).emissive);
    assert!(matches!(
        cornell.cameras[0].projection,
        Projection::Perspective { .. }
    ));
    assert!(
        cornell
            .bounds()
            .is_some_and(|(low, high)| low.distance(high) > DVec3::ONE.length())
    );
    let textured = valid_model(&folder, "textured.gltf");
    assert_eq!(textured.triangle_count(), 14);
    let sampler = textured.textures[0].sampler;
    assert_eq!(
        (sampler.filter, sampler.wrap_u),
        (Filter::Nearest, Wrap::Repeat)
    );
    silent(&textured);
}
