//! Skins: closed forms of joints at known angles.

use glam::{DVec3, Vec3, Vec4};
use serde_json::{Value, json};

use crate::common::*;
use crate::seeds;

const IDENTITY: [f32; 16] = [
    1., 0., 0., 0., 0., 1., 0., 0., 0., 0., 1., 0., 0., 0., 0., 1.,
];

/// A square over x and y from 0 to 2, whose upper corners follow a joint at (0, 1, 0), which is turned by a quarter
/// about +Z; the lower ones stay. The node of the mesh stands elsewhere, which must not matter.
fn arm() -> Builder {
    let mut builder = Builder::square();
    let positions: Vec<f32> = SQUARE.iter().map(|x| 2.0 * x).collect();
    let positions = builder.floats(&positions, "VEC3");
    builder.attribute("POSITION", positions);
    let normals = builder.floats(&[0., 1., 0.].repeat(4), "VEC3");
    builder.attribute("NORMAL", normals);
    let joints = builder.accessor(
        &[0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0],
        U8,
        "VEC4",
        4,
    );
    builder.attribute("JOINTS_0", joints);
    let weights = builder.floats(&[1., 0., 0., 0.].repeat(4), "VEC4");
    builder.attribute("WEIGHTS_0", weights);
    let mut bind = [IDENTITY, IDENTITY];
    bind[1][13] = -1.0;
    let bind = builder.accessor(&floats(bind.as_flattened()), F32, "MAT4", 2);
    let half = 0.5_f64.sqrt();
    builder.json["nodes"] = json!([
        {"mesh": 0, "skin": 0, "translation": [100, 100, 100], "scale": [-1, 7, 1]},
        {"children": [2]},
        {"translation": [0, 1, 0], "rotation": [0, 0, half, half]},
    ]);
    builder.json["scenes"][0]["nodes"] = json!([0, 1]);
    builder.json["skins"] = json!([{"joints": [1, 2], "inverseBindMatrices": bind}]);
    builder
}

#[test]
fn vertices_follow_their_joint_and_not_their_node() {
    let scene = arm().scene();
    silent(&scene);
    // (2, 2) lies at (2, 1) from the joint, which a quarter turn takes to (−1, 2).
    let expected = [[0., 0., 0.], [2., 0., 0.], [-1., 3., 0.], [-1., 1., 0.]];
    assert_close(&world_positions(&scene, 0), &expected);
    let normals = &scene.meshes[0].normals;
    assert!(normals[0].abs_diff_eq(Vec3::Y, 1e-7) && normals[2].abs_diff_eq(Vec3::NEG_X, 1e-7));
}

#[test]
fn weights_blend_joints_whatever_their_sum_and_type() {
    // The upper corners half and half: the mean of (2, 2) and (−1, 3), of (0, 2) and (−1, 1).
    let expected = [[0., 0., 0.], [2., 0., 0.], [0.5, 2.5, 0.], [-0.5, 1.5, 0.]];
    for (component, bytes) in [
        (F32, floats(&[0.5, 0.5, 0., 0.].repeat(4))),
        (F32, floats(&[3., 3., 0., 0.].repeat(4))),
        (U8, [128, 128, 0, 0].repeat(4)),
        (U16, shorts(&[32768, 32768, 0, 0].repeat(4))),
    ] {
        let mut builder = arm();
        let weights = builder.accessor(&bytes, component, "VEC4", 4);
        builder.json["accessors"][weights]["normalized"] = json!(component != F32);
        builder.attribute("WEIGHTS_0", weights);
        let joints = shorts(&[0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 1, 0, 0, 0]);
        let joints = builder.accessor(&joints, U16, "VEC4", 4);
        builder.attribute("JOINTS_0", joints);
        assert_close(&world_positions(&builder.scene(), 0), &expected);
    }
}

#[test]
fn further_sets_of_joints_count() {
    let mut builder = arm();
    let joints = builder.accessor(&[0, 1, 0, 0].repeat(4), U8, "VEC4", 4);
    builder.attribute("JOINTS_1", joints);
    let weights = builder.floats(&[0., 1., 0., 0.].repeat(4), "VEC4");
    builder.attribute("WEIGHTS_1", weights);
    // The lower corners half and half now: (0, −1) turns to (1, 0), (2, −1) to (1, 2).
    let expected = [[0.5, 0.5, 0.], [1.5, 1.5, 0.], [-1., 3., 0.], [-1., 1., 0.]];
    assert_close(&world_positions(&builder.scene(), 0), &expected);
}

#[test]
fn normals_turn_by_the_inverse_transpose_and_tangents_by_the_matrix() {
    let mut builder = seeds::given_tangents();
    let slope = 0.5_f32.sqrt();
    let normals = builder.floats(&[slope, 0., slope].repeat(4), "VEC3");
    builder.attribute("NORMAL", normals);
    let tangents = builder.floats(&[slope, 0., -slope, 1.].repeat(4), "VEC4");
    builder.attribute("TANGENT", tangents);
    let joints = builder.accessor(&[0; 16], U8, "VEC4", 4);
    builder.attribute("JOINTS_0", joints);
    let weights = builder.floats(&[1., 0., 0., 0.].repeat(4), "VEC4");
    builder.attribute("WEIGHTS_0", weights);
    builder.json["nodes"] = json!([{"mesh": 0, "skin": 0}, {"scale": [2, 1, 1]}]);
    builder.json["scenes"][0]["nodes"] = json!([0, 1]);
    builder.json["skins"] = json!([{"joints": [1]}]);
    let mesh = &builder.scene().meshes[0];
    let five = 5.0_f32.sqrt();
    assert!(mesh.normals[0].abs_diff_eq(Vec3::new(1.0, 0.0, 2.0) / five, 1e-7));
    assert!(mesh.tangents[0].abs_diff_eq(Vec4::new(2.0 / five, 0.0, -1.0 / five, 1.0), 1e-7));
    // A joint that mirrors: the corners turn back, so that the front stays the front, and the bitangent's sign changes.
    builder.json["nodes"][1]["scale"] = json!([-1, 1, 1]);
    let mirrored = builder.scene();
    let mesh = &mirrored.meshes[0];
    assert!(mesh.normals[0].abs_diff_eq(Vec3::new(-slope, 0.0, slope), 1e-7));
    assert!(mesh.tangents[0].abs_diff_eq(Vec4::new(-slope, 0.0, -slope, -1.0), 1e-7));
    for triangle in &mesh.indices {
        let [a, b, c] = triangle.map(|vertex| mesh.positions[vertex as usize]);
        assert!((b - a).cross(c - a).z > 0.0, "it faces +Z as before");
    }
}

#[test]
fn nodes_with_skins_of_their_own_share_a_mesh() {
    let mut builder = arm();
    let skin = builder.json["skins"][0].clone();
    builder.push("skins", skin);
    builder.json["skins"][1]["joints"] = json!([4, 5]);
    builder.push("nodes", json!({"mesh": 0, "skin": 1}));
    builder.push("nodes", json!({"translation": [0, 0, 5], "children": [5]}));
    builder.push("nodes", json!({"translation": [0, 1, 0]}));
    builder.push("nodes", json!({"mesh": 0}));
    builder.json["scenes"][0]["nodes"] = json!([0, 1, 3, 4, 6]);
    let scene = builder.scene();
    assert_eq!((scene.meshes.len(), scene.instances.len()), (3, 3));
    assert_close(&world_positions(&scene, 0)[2..3], &[[-1., 3., 0.]]);
    assert_close(&world_positions(&scene, 1)[2..3], &[[2., 2., 5.]]);
    assert_close(&world_positions(&scene, 2)[2..3], &[[2., 2., 0.]]);
}

#[test]
fn animated_joints_move_morphed_vertices() {
    let builder = seeds::skin();
    // At the end the first target lifts by 1 and the second by ½ what the joint, by half a turn about +Z, takes along:
    // ¼ of (1, 1, 1.5) and ¾ of (−1, −1, 1.5), above the first joint at z = 4.
    let scene = builder.scene_at(0, 1.0);
    assert_close(&world_positions(&scene, 0)[2..3], &[[-0.5, -0.5, 5.5]]);
    // At rest the mesh's own weights hold, and no joint is turned.
    let rest = builder.scene();
    assert_close(&world_positions(&rest, 0)[2..3], &[[1.0, 1.0, 4.5]]);
    silent(&rest);
    assert!(
        !rest.meshes[0].tangents.is_empty(),
        "made for the posed mesh"
    );
}

#[test]
fn far_from_the_origin_nothing_is_lost() {
    let mut builder = arm();
    builder.json["nodes"][1]["translation"] = json!([1e7, 0, 0]);
    let found = world_positions(&builder.scene(), 0);
    let expected = DVec3::new(1e7 - 1.0, 3.0, 0.0);
    assert!(found[2].abs_diff_eq(expected, 1e-6), "{}", found[2]);
}

#[test]
fn joints_outside_of_the_scene_stand_where_their_nodes_do() {
    let mut builder = arm();
    builder.json["scenes"][0]["nodes"] = json!([0]);
    assert_close(
        &world_positions(&builder.scene(), 0)[2..3],
        &[[-1., 3., 0.]],
    );
}

#[test]
fn meshes_without_joints_follow_the_first() {
    let mut builder = Builder::square();
    builder.json["nodes"] = json!([{"mesh": 0, "skin": 0}, {"translation": [0, 0, 4]}]);
    builder.json["scenes"][0]["nodes"] = json!([0, 1]);
    builder.json["skins"] = json!([{"joints": [1]}]);
    let scene = builder.scene();
    warned(
        &scene,
        "primitive 0: it has no JOINTS_0 and WEIGHTS_0; it follows the skin's first joint",
    );
    assert_close(&world_positions(&scene, 0)[..1], &[[0., 0., 4.]]);
}

#[test]
fn wrong_skins_are_refused() {
    let change = |pointer: &str, value: Value| {
        let mut builder = arm();
        set(&mut builder.json, pointer, value);
        builder
    };
    refused(
        change("skins/0/joints", json!([])),
        &["skin 0: `joints` is missing or empty"],
    );
    refused(
        change("skins/0/joints", json!([1, 9])),
        &["skin 0: `joints` refers to node 9"],
    );
    refused(
        change("nodes/0/skin", json!(1)),
        &["node 0: `skin` refers to skin 1"],
    );
    refused(
        change("skins/0/joints", json!([1])),
        &["primitive 0: JOINTS_0 refers to joint 1, but its skin has 1 joint"],
    );
    refused(
        change("skins/0/joints", json!([1, 2, 2])),
        &["skin 0: `inverseBindMatrices` has 2 elements, but there are 3 joints"],
    );
    refused(
        change("skins/0/inverseBindMatrices", json!(0)),
        &["inverseBindMatrices must be MAT4"],
    );
    let mut builder = arm();
    let wild = builder.accessor(&floats(&[f32::NAN; 32]), F32, "MAT4", 2);
    builder.json["skins"][0]["inverseBindMatrices"] = json!(wild);
    refused(builder, &["skin 0: the matrix of joint 0 is not finite"]);
    let mut builder = arm();
    let joints = builder.floats(&[0.0; 16], "VEC4");
    builder.attribute("JOINTS_0", joints);
    refused(builder, &["joints must be plain unsigned integers"]);
    // A joint without a weight may be anything.
    let mut builder = arm();
    let joints = builder.accessor(&[0, 200, 200, 200].repeat(4), U8, "VEC4", 4);
    builder.attribute("JOINTS_0", joints);
    builder.scene();
}
