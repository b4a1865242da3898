//! Emitters: strength, sides, unlit surfaces, colours.

use etendue::scene::{Filter, Image, Material, Sampler, Scene, Texels, Texture, TextureSlot};
use etendue::scene::{Wrap, gltf};
use glam::{DVec3, Vec2, Vec3, Vec4};

use super::{RHO, integrators, receiver, reflected};
use crate::common::statistics::assert_estimate;
use crate::common::{
    SceneBuilder, assert_exact, assert_radiance, estimate, lambert, lamp, render, root, square,
    with_integrator,
};

/// A quad of a material before a lamp of radiance 7, seen from its front or its back.
fn seen(material: Material, from_front: bool) -> Scene {
    let mut builder = SceneBuilder::new();
    let side = if from_front { 1.0 } else { -1.0 };
    builder.quad(material, DVec3::ZERO, DVec3::X * 9.0, DVec3::Y * 9.0);
    builder.quad(
        lamp(7.0),
        DVec3::NEG_Z * side,
        DVec3::X * 9.0 * side,
        DVec3::Y * 9.0,
    );
    builder.parallel(DVec3::Z * side, DVec3::ZERO, 1.0);
    builder.scene
}

fn double_sided(material: Material) -> Material {
    Material {
        double_sided: true,
        ..material
    }
}

#[test]
fn the_camera_sees_fronts_and_both_faces_of_the_double_sided() {
    for (material, front, back) in [
        (lamp(2.0), 2.0, 7.0),
        (double_sided(lamp(2.0)), 2.0, 2.0),
        (lambert(0.5), 0.0, 7.0),
        (double_sided(lambert(0.5)), 0.0, 0.0),
    ] {
        for (from_front, expected) in [(true, front), (false, back)] {
            let scene = seen(material.clone(), from_front);
            let film = render(&scene, &square(8, 4, 1));
            assert_exact("seen", &film, [expected; 3]);
        }
    }
}

/// A lamp over the receiver that turns its back on it gives nothing, unless double-sided; its back
/// stops light all the same.
#[test]
fn the_back_of_a_lamp_is_dark() {
    let with_back = |material: Material| {
        receiver(|b| {
            b.quad(material, DVec3::Y, DVec3::Z, DVec3::X);
            b.point(DVec3::Y * 2.0, 100.0);
        })
    };
    let expected = reflected(3.0 * std::f64::consts::PI * 0.554126);
    for settings in integrators(&square(16, 512, 2)) {
        let name = &settings.integrator;
        let dark = render(&with_back(lamp(3.0)), &settings);
        assert_exact(name, &dark, [0.0; 3]);
        let lit = render(&with_back(double_sided(lamp(3.0))), &settings);
        assert_radiance(name, &lit, expected, 0.006);
    }
}

/// A furnace file with KHR_materials_emissive_strength 7.5: 7.5 times as bright.
#[test]
fn emissive_strength_multiplies() {
    let text = std::fs::read_to_string(root().join("scenes/furnace.gltf")).expect("the file");
    let mut json: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    let name = "KHR_materials_emissive_strength";
    json["materials"][0]["extensions"][name] = serde_json::json!({ "emissiveStrength": 7.5 });
    let used = json["extensionsUsed"].as_array_mut().expect("a list");
    used.push(name.into());
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("strong.gltf");
    std::fs::write(&path, json.to_string()).expect("a file");
    let scene = gltf::load(&path, &gltf::LoadOptions::default()).expect("a scene");
    assert_exact("seen", &render(&scene, &square(8, 4, 1)), [7.5; 3]);
    let film = render(&scene, &square(16, 64, 3));
    assert_radiance("reflected", &film, 7.5 * 1.75, 0.003);
}

/// KHR_materials_unlit: the base colour, whatever the light.
#[test]
fn unlit_surfaces_show_their_colour() {
    let material = Material {
        base_color: Vec4::new(0.8, 0.4, 0.1, 1.0),
        unlit: true,
        ..Material::default()
    };
    let mut builder = SceneBuilder::new();
    let half = Vec4::new(0.5, 0.5, 1.0, 1.0);
    builder.colored_quad(material, DVec3::ZERO, DVec3::X, DVec3::Y, [half; 4]);
    builder.parallel(DVec3::Z, DVec3::ZERO, 0.9);
    builder.point(DVec3::Z, 100.0);
    builder.sky(3.0);
    let expected = [0.4, 0.2, 0.1];
    for integrator in ["path", "naive", "path_lights", "path_bsdf"] {
        let film = render(
            &builder.scene,
            &with_integrator(&square(8, 4, 4), integrator),
        );
        assert_exact(integrator, &film, expected);
    }
}

/// COLOR_0 multiplies the base colour, interpolated in between: over the whole quad its mean.
#[test]
fn vertex_colours_multiply() {
    let mut builder = SceneBuilder::new();
    let [red, green] = [Vec4::new(1.0, 0.0, 0.5, 1.0), Vec4::new(0.0, 1.0, 0.5, 1.0)];
    let colors = [red, green, green, red];
    builder.colored_quad(lambert(0.5), DVec3::ZERO, DVec3::X, DVec3::Y, colors);
    builder.parallel(DVec3::Z, DVec3::ZERO, 1.0);
    builder.sky(2.0);
    let film = render(&builder.scene, &square(16, 128, 2));
    assert_estimate("quad", &estimate(&film), [RHO, RHO, RHO], 0.005);
    // Column i spans colours from i / 16 to (i + 1) / 16.
    for column in [0, 5, 15] {
        let strip = crate::common::estimate_region(&film, column..column + 1, 0..16);
        let green = (f64::from(column) + 0.5) / 16.0;
        let expected = [1.0 - green, green, 0.5].map(|c| 2.0 * 0.5 * c);
        assert_estimate("column", &strip, expected, 0.02);
    }
}

#[test]
fn colours_multiply_channel_by_channel() {
    let mut scene = receiver(|b| b.point(DVec3::Y, 1.0));
    scene.lights[0].intensity = Vec3::new(1.0, 2.0, 4.0);
    scene.materials[0].base_color = Vec4::new(0.5, 0.25, 0.75, 1.0);
    let film = super::receive(&scene, 4);
    let expected = [0.5, 0.5, 3.0].map(|x| x / std::f64::consts::PI);
    assert_exact("receiver", &film, expected);
}

/// Texture coordinate (0, 0) is the top left corner of the picture, as glTF has it.
#[test]
fn a_picture_hangs_by_its_top_left_corner() {
    let mut material = unlit();
    material.base_color_texture = Some(TextureSlot {
        texture: 0,
        tex_coord: 0,
        matrix: [Vec2::X, Vec2::Y],
        offset: Vec2::ZERO,
    });
    let mut builder = SceneBuilder::new();
    builder.quad(material, DVec3::ZERO, DVec3::X, DVec3::Y);
    builder.parallel(DVec3::Z, DVec3::ZERO, 1.0);
    let mut scene = builder.scene;
    // Corners from the bottom left, counter-clockwise.
    let corners = [[0.0, 1.0], [1.0, 1.0], [1.0, 0.0], [0.0, 0.0]];
    scene.meshes[0].tex_coords[0] = corners.map(Vec2::from).to_vec();
    scene.textures.push(Texture {
        image: 0,
        sampler: Sampler {
            wrap_u: Wrap::Repeat,
            wrap_v: Wrap::Repeat,
            filter: Filter::Nearest,
        },
    });
    let [red, green, blue, white] = [
        [255, 0, 0, 255],
        [0, 255, 0, 255],
        [0, 0, 255, 255],
        [255; 4],
    ];
    scene.images.push(Image {
        name: "four colours".into(),
        width: 2,
        height: 2,
        texels: Texels::Rgba8(vec![red, green, blue, white]),
    });
    let film = render(&scene, &square(2, 16, 1));
    let seen: Vec<_> = (0..4).map(|i| film.mean(i)).collect();
    let expected = [
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, 0.0, 1.0],
        [1.0, 1.0, 1.0],
    ];
    assert_eq!(seen, expected);
}

fn unlit() -> Material {
    Material {
        unlit: true,
        ..Material::default()
    }
}
