//! Morph targets.

use glam::{Vec2, Vec3, Vec4};
use serde_json::{Value, json};

use crate::common::*;
use crate::seeds;

/// The square with two targets: one lifts the first corner along z, one moves all along x.
fn morphed(weights: Value) -> Builder {
    let mut builder = Builder::square();
    let lift = builder.floats(&[0., 0., 2., 0., 0., 0., 0., 0., 0., 0., 0., 0.], "VEC3");
    let push = builder.floats(&[1., 0., 0.].repeat(4), "VEC3");
    primitive(&mut builder)["targets"] = json!([{"POSITION": lift}, {"POSITION": push}]);
    builder.json["meshes"][0]["weights"] = weights;
    builder
}

fn primitive(builder: &mut Builder) -> &mut Value {
    &mut builder.json["meshes"][0]["primitives"][0]
}

fn first(builder: &Builder) -> Vec3 {
    builder.scene().meshes[0].positions[0]
}

#[test]
fn displacements_add_up_by_their_weights() {
    assert_eq!(first(&morphed(json!(null))), Vec3::ZERO);
    assert_eq!(first(&morphed(json!([0, 0]))), Vec3::ZERO);
    assert_eq!(first(&morphed(json!([0.5, 0]))), Vec3::new(0.0, 0.0, 1.0));
    assert_eq!(first(&morphed(json!([-1, 3]))), Vec3::new(3.0, 0.0, -2.0));
    let mut builder = morphed(json!([0.5, 0]));
    builder.json["nodes"][0]["weights"] = json!([0, 0.25]);
    assert_eq!(
        first(&builder),
        Vec3::new(0.25, 0.0, 0.0),
        "the node's weights count"
    );
    silent(&builder.scene());
}

#[test]
fn weights_are_animated_in_every_interpolation() {
    for (interpolation, keys, expected) in [
        ("LINEAR", vec![0., 0., 1., 4.], [1.0, 0.0, 0.5]),
        ("STEP", vec![0., 3., 1., 4.], [3.0, 0.0, 0.0]),
        // Flat tangents: at a quarter of the way 3/16 − 2/64 = 5/32 of the difference.
        (
            "CUBICSPLINE",
            vec![0., 0., 0., 0., 0., 0., 0., 0., 1., 4., 0., 0.],
            [0.625, 0.0, 0.3125],
        ),
    ] {
        let mut builder = morphed(json!([9, 9]));
        let output = builder.floats(&keys, "SCALAR");
        builder.animate((0, "weights"), interpolation, &[0.0, 4.0], output);
        let scene = builder.scene_at(0, 1.0);
        assert_eq!(
            scene.meshes[0].positions[0].to_array(),
            expected,
            "{interpolation}"
        );
    }
    let mut builder = morphed(json!(null));
    let output = builder.accessor(&[0, 255], U8, "SCALAR", 2);
    builder.json["accessors"][output]["normalized"] = json!(true);
    builder.animate((0, "weights"), "LINEAR", &[0.0], output);
    assert_eq!(builder.scene_at(0, 0.0).meshes[0].positions[0], Vec3::X);
}

#[test]
fn nodes_share_a_mesh_as_far_as_their_weights_agree() {
    let mut builder = morphed(json!([1, 0]));
    builder.json["nodes"] = json!([
        {"mesh": 0}, {"mesh": 0, "weights": [0, 1]}, {"mesh": 0}, {"mesh": 0, "weights": [0, 0]},
    ]);
    builder.json["scenes"][0]["nodes"] = json!([0, 1, 2, 3]);
    let scene = builder.scene();
    assert_eq!(scene.meshes.len(), 3);
    let corner = |instance: usize| world_positions(&scene, instance)[0].to_array();
    assert_eq!(corner(0), [0.0, 0.0, 2.0]);
    assert_eq!(corner(1), [1.0, 0.0, 0.0]);
    assert_eq!(corner(3), [0.0, 0.0, 0.0]);
    assert_eq!(scene.instances[0].mesh, scene.instances[2].mesh);
}

/// Normals and tangents: the sum, made unit; the sign of the tangent stays.
#[test]
fn normals_and_tangents_are_displaced_and_made_unit() {
    let mut builder = seeds::given_tangents();
    let lean = builder.floats(&[0., 2., 0.].repeat(4), "VEC3");
    let turn = builder.floats(&[-1., 1., 0.].repeat(4), "VEC3");
    primitive(&mut builder)["targets"] = json!([{"NORMAL": lean, "TANGENT": turn}]);
    builder.json["meshes"][0]["weights"] = json!([0.5]);
    let scene = builder.scene();
    let mesh = &scene.meshes[0];
    let half = 0.5_f32.sqrt();
    // (0, 0, 1) + ½ (0, 2, 0) and (1, 0, 0) + ½ (−1, 1, 0).
    assert!(
        mesh.normals
            .iter()
            .all(|n| n.abs_diff_eq(Vec3::new(0.0, half, half), 1e-7))
    );
    assert!(
        mesh.tangents
            .iter()
            .all(|t| t.abs_diff_eq(Vec4::new(half, half, 0.0, -1.0), 1e-7))
    );
    assert_eq!(mesh.positions, square_positions());
}

#[test]
fn coordinates_and_colours_are_displaced() {
    let mut builder = seeds::textured();
    let uvs = builder.floats(&[0.5, 0.25].repeat(4), "VEC2");
    let fade = builder.floats(&[-0.5, 0., 0.].repeat(4), "VEC3");
    primitive(&mut builder)["targets"] =
        json!([{"TEXCOORD_0": uvs, "TEXCOORD_1": uvs, "COLOR_0": fade}]);
    let plain = builder.scene();
    builder.json["meshes"][0]["weights"] = json!([1]);
    let scene = builder.scene();
    for set in 0..2 {
        let pairs = scene.meshes[0].tex_coords[set]
            .iter()
            .zip(&plain.meshes[0].tex_coords[set]);
        for (moved, plain) in pairs {
            assert!(
                (*moved - *plain).abs_diff_eq(Vec2::new(0.5, 0.25), 1e-7),
                "{moved}"
            );
        }
    }
    assert!(
        scene.meshes[0]
            .colors
            .iter()
            .all(|c| *c == Vec4::new(0.5, 1.0, 1.0, 1.0))
    );
    let mut builder = builder.clone();
    let fade = builder.floats(&[-5., 5., 0., -0.25].repeat(4), "VEC4");
    primitive(&mut builder)["targets"][0]["COLOR_0"] = json!(fade);
    let colors = &builder.scene().meshes[0].colors;
    assert!(
        colors.iter().all(|c| *c == Vec4::new(0.0, 1.0, 1.0, 0.75)),
        "clamped"
    );
}

#[test]
fn targets_may_be_sparse_or_quantised() {
    let mut builder = morphed(json!([1, 0]));
    let indices = builder.view(&shorts(&[2]));
    let values = builder.view(&floats(&[0., 0., 3.]));
    let sparse = builder.push(
        "accessors",
        json!({
            "componentType": F32, "type": "VEC3", "count": 4,
            "sparse": {
                "count": 1,
                "indices": {"bufferView": indices, "componentType": U16},
                "values": {"bufferView": values},
            },
        }),
    );
    primitive(&mut builder)["targets"][0]["POSITION"] = json!(sparse);
    let heights: Vec<f32> = builder.scene().meshes[0]
        .positions
        .iter()
        .map(|p| p.z)
        .collect();
    assert_eq!(heights, [0.0, 0.0, 3.0, 0.0]);
    for (component, bytes, normalized, step) in [
        (I8, vec![0, 0, 0x81, 0], true, -1.0),
        (I8, vec![0, 0, 0x81, 0], false, -127.0),
        (I16, shorts(&[0, 0, 0x7FFF, 0]), true, 1.0),
        (I16, shorts(&[0, 0, 0x7FFF, 0]), false, 32767.0),
    ] {
        let mut builder = morphed(json!([1, 0]));
        let accessor = builder.accessor(&bytes.repeat(4), component, "VEC3", 4);
        let view = builder.json["accessors"][accessor]["bufferView"]
            .as_u64()
            .expect("a view");
        builder.json["bufferViews"][view as usize]["byteStride"] = json!(bytes.len());
        builder.json["accessors"][accessor]["normalized"] = json!(normalized);
        primitive(&mut builder)["targets"][0]["POSITION"] = json!(accessor);
        assert_eq!(
            first(&builder),
            Vec3::new(0.0, 0.0, step),
            "{component} {normalized}"
        );
    }
}

/// A vertex far away that many small steps move keeps every one of them.
#[test]
fn many_small_displacements_add_up() {
    let mut builder = Builder::square();
    let far = builder.floats(&[1000.0; 12], "VEC3");
    builder.attribute("POSITION", far);
    let step = builder.floats(&[1e-5, 0., 0.].repeat(4), "VEC3");
    let targets = vec![json!({"POSITION": step}); 1000];
    primitive(&mut builder)["targets"] = json!(targets);
    builder.json["meshes"][0]["weights"] = json!(vec![1; 1000]);
    assert!(
        (first(&builder).x - 1000.01).abs() < 1e-4,
        "{}",
        first(&builder)
    );
}

#[test]
fn wrong_targets_are_refused() {
    let mut builder = morphed(json!([1, 0]));
    let short = builder.floats(&[0.0; 9], "VEC3");
    primitive(&mut builder)["targets"][0]["POSITION"] = json!(short);
    refused(
        builder,
        &[
            "mesh 0 \"square\", primitive 0, morph target 0: POSITION has 3 elements, but the primitive has 4",
        ],
    );
    let mut builder = morphed(json!([1, 0]));
    let flat = builder.floats(&[0.0; 8], "VEC2");
    primitive(&mut builder)["targets"][0]["POSITION"] = json!(flat);
    refused(
        builder,
        &["POSITION of a morph target must be VEC3, found VEC2"],
    );
    let mut builder = morphed(json!([1, 0]));
    primitive(&mut builder)["targets"][0]["POSITION"] = json!(99);
    refused(
        builder,
        &["morph target 0: `POSITION` refers to accessor 99"],
    );
    refused(
        morphed(json!(["a"])),
        &["mesh 0 \"square\": `weights` must be an array of finite numbers"],
    );
}
