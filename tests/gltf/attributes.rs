//! Normals, tangents, texture coordinates and colours.

use etendue::scene::*;
use glam::{Vec2, Vec3, Vec4};
use serde_json::json;

use crate::common::*;
use crate::seeds;

#[test]
fn normals_become_unit_vectors() {
    let mut builder = Builder::square();
    let normals = builder.accessor(
        &floats(&[0., 0., 5., 0., 3e-30, 0., 0., 0., 0., f32::NAN, 0., 0.]),
        F32,
        "VEC3",
        4,
    );
    builder.attribute("NORMAL", normals);
    let scene = builder.scene();
    assert_eq!(
        scene.meshes[0].normals,
        [Vec3::Z, Vec3::Y, Vec3::Z, Vec3::Z]
    );
    warned(&scene, "2 of its normals have no direction");
    assert!(Builder::square().scene().meshes[0].normals.is_empty());
}

#[test]
fn tangents_are_made_where_a_normal_map_needs_them() {
    assert!(Builder::textured().scene().meshes[0].tangents.is_empty());
    let made = seeds::normal_map().scene();
    assert_eq!(made.meshes[0].tangents, [Vec4::new(1.0, 0.0, 0.0, 1.0); 4]);
    let given = seeds::given_tangents().scene();
    assert_eq!(
        given.meshes[0].tangents,
        [Vec4::new(1.0, 0.0, 0.0, -1.0); 4]
    );
    silent(&given);
    let mut builder = seeds::normal_map();
    builder.json["meshes"][0]["primitives"][0]["attributes"] = json!({"POSITION": 0});
    builder.json["materials"][0]["pbrMetallicRoughness"] = json!({});
    let scene = builder.scene();
    assert!(scene.meshes[0].tangents.is_empty() && !Features::of(&scene).normal_texture);
    warned(
        &scene,
        "it has no TEXCOORD_0; normal maps and anisotropy of material 0 \"paint\" are not used",
    );
}

#[test]
fn missing_texture_coordinates_are_zero() {
    let mut builder = Builder::textured();
    builder.json["meshes"][0]["primitives"][0]["attributes"] = json!({"POSITION": 0});
    let scene = builder.scene();
    assert_eq!(scene.meshes[0].tex_coords[0], [Vec2::ZERO; 4]);
    warned(
        &scene,
        "it has no TEXCOORD_0; the textures of material 0 \"paint\" show a single texel",
    );
}

#[test]
fn higher_sets_of_texture_coordinates_take_the_place_of_unused_ones() {
    let mut builder = Builder::textured();
    let uvs = builder.accessor(&floats(&[0.5; 8]), F32, "VEC2", 4);
    builder.attribute("TEXCOORD_3", uvs);
    builder.json["materials"][0]["emissiveTexture"] = json!({"index": 0, "texCoord": 3});
    builder.json["materials"][0]["emissiveFactor"] = json!([1, 1, 1]);
    let scene = builder.scene();
    assert_eq!(scene.meshes[0].tex_coords[1], [Vec2::splat(0.5); 4]);
    assert_eq!(
        scene.materials[0]
            .emissive_texture
            .map(|slot| slot.tex_coord),
        Some(1)
    );
}

#[test]
fn vertex_colours_of_every_type_are_read() {
    let half = Vec4::new(0.5, 0.25, 1.0, 1.0);
    for (component, shape, bytes) in [
        (F32, "VEC3", floats(&[0.5, 0.25, 1.0])),
        (F32, "VEC4", floats(&[0.5, 0.25, 1.0, 1.0])),
        (U8, "VEC4", vec![128, 64, 255, 255]),
        (U16, "VEC3", shorts(&[32768, 16384, 65535])),
    ] {
        let mut builder = Builder::square();
        let colors = builder.accessor(&bytes.repeat(4), component, shape, 4);
        builder.json["accessors"][colors]["normalized"] = json!(component != F32);
        builder.attribute("COLOR_0", colors);
        let scene = builder.scene();
        assert!(
            scene.meshes[0]
                .colors
                .iter()
                .all(|c| c.abs_diff_eq(half, 3e-3)),
            "{:?}",
            scene.meshes[0].colors
        );
        silent(&scene);
    }
}

/// KHR_mesh_quantization: every type that it allows for normals, tangents and texture coordinates.
#[test]
fn quantised_attributes_are_read() {
    let load = |name: &str, shape: &str, component: u32, bytes: &[u8], normalized: bool| {
        let mut builder = seeds::given_tangents();
        let accessor = builder.accessor(&bytes.repeat(4), component, shape, 4);
        let view = builder.json["accessors"][accessor]["bufferView"]
            .as_u64()
            .expect("a view");
        builder.json["bufferViews"][view as usize]["byteStride"] = json!(bytes.len());
        builder.json["accessors"][accessor]["normalized"] = json!(normalized);
        builder.attribute(name, accessor);
        builder.scene().meshes.remove(0)
    };
    for (component, bytes) in [(I8, vec![0, 0x81, 0, 0]), (I16, shorts(&[0, 0x8001, 0, 0]))] {
        let mesh = load("NORMAL", "VEC3", component, &bytes, true);
        assert_eq!(mesh.normals, [Vec3::NEG_Y; 4], "{component}");
        let mut bytes = bytes.clone();
        let size = bytes.len() / 4;
        bytes.copy_within(size..2 * size, 3 * size);
        let mesh = load("TANGENT", "VEC4", component, &bytes, true);
        assert_eq!(
            mesh.tangents,
            [Vec4::new(0.0, -1.0, 0.0, -1.0); 4],
            "{component}"
        );
    }
    for (component, bytes, normalized, expected) in [
        (I8, vec![0x7F, 0x81, 0, 0], true, [1.0, -1.0]),
        (I8, vec![0x7F, 0x81, 0, 0], false, [127.0, -127.0]),
        (U8, vec![255, 51, 0, 0], true, [1.0, 0.2]),
        (U8, vec![255, 51, 0, 0], false, [255.0, 51.0]),
        (I16, shorts(&[0x7FFF, 0x8001]), true, [1.0, -1.0]),
        (I16, shorts(&[0x7FFF, 0x8001]), false, [32767.0, -32767.0]),
        (U16, shorts(&[65535, 13107]), true, [1.0, 0.2]),
        (U16, shorts(&[65535, 13107]), false, [65535.0, 13107.0]),
    ] {
        let mesh = load("TEXCOORD_0", "VEC2", component, &bytes, normalized);
        assert_eq!(
            mesh.tex_coords[0],
            [Vec2::from(expected); 4],
            "{component} {normalized}"
        );
    }
}
