//! Animations: closed forms of each interpolation, and what is refused.

use std::f64::consts::FRAC_PI_2;

use etendue::scene::gltf::LoadOptions;
use etendue::scene::{PlayedAnimation, Selector};
use glam::{DQuat, DVec3};
use serde_json::{Value, json};

use crate::common::*;
use crate::seeds;

/// The square, its node moved by one channel, with the node's transform at a moment.
fn at(builder: &Builder, seconds: f64) -> glam::DMat4 {
    builder.scene_at(0, seconds).instances[0].to_world
}

fn moved(interpolation: &str) -> Builder {
    let mut builder = Builder::square();
    builder.json["nodes"][0]["scale"] = json!([2, 2, 2]);
    let output = builder.floats(&[0., 0., 0., 4., 0., 8.], "VEC3");
    builder.animate((0, "translation"), interpolation, &[1.0, 3.0], output);
    builder
}

#[test]
fn linear_translations_are_clamped_at_both_ends() {
    let builder = moved("LINEAR");
    for (seconds, expected) in [
        (-9.0, [0.0, 0.0, 0.0]),
        (1.0, [0.0, 0.0, 0.0]),
        (1.5, [1.0, 0.0, 2.0]),
        (3.0, [4.0, 0.0, 8.0]),
        (99.0, [4.0, 0.0, 8.0]),
    ] {
        let matrix = at(&builder, seconds);
        assert_eq!(matrix.w_axis.truncate().to_array(), expected, "{seconds}");
        assert_eq!(matrix.x_axis.x, 2.0, "the scale is the node's own");
    }
    assert_eq!(
        builder.scene().instances[0].to_world.w_axis.truncate(),
        DVec3::ZERO
    );
}

#[test]
fn steps_hold_until_the_next_key() {
    let builder = moved("STEP");
    for (seconds, x) in [(0.0, 0.0), (2.999, 0.0), (3.0, 4.0), (4.0, 4.0)] {
        assert_eq!(at(&builder, seconds).w_axis.x, x, "{seconds}");
    }
}

#[test]
fn rotations_turn_evenly() {
    let mut builder = Builder::square();
    let half = 0.5_f32.sqrt();
    // A quarter about +Y, its end with the other sign: q and −q are the same rotation.
    let output = builder.floats(&[0., 0., 0., 1., 0., -half, 0., -half], "VEC4");
    builder.animate((0, "rotation"), "LINEAR", &[0.0, 1.0], output);
    for seconds in [0.0, 0.25, 1.0 / 3.0, 1.0] {
        let found = DQuat::from_mat4(&at(&builder, seconds));
        let expected = DQuat::from_rotation_y(seconds * FRAC_PI_2);
        assert!(found.angle_between(expected) < 1e-7, "{seconds}: {found}");
    }
}

#[test]
fn cubic_splines_pass_through_cubics() {
    let builder = seeds::spline();
    for seconds in [0.0_f64, 0.5, 1.5, 2.0] {
        let matrix = at(&builder, seconds);
        let expected = DVec3::new(seconds.powi(3), 1.0, 0.0);
        assert!(
            matrix.w_axis.truncate().abs_diff_eq(expected, 1e-14),
            "{matrix}"
        );
        let size = if seconds < 2.0 { 1.0 } else { 3.0 };
        assert_eq!(matrix.y_axis.y, size, "the scale goes in a step");
    }
}

#[test]
fn splines_of_rotations_are_made_unit() {
    let mut builder = Builder::square();
    let half = 0.5_f32.sqrt();
    let none = [0.0_f32; 4];
    let keys = [
        none,
        [0., 0., 0., 1.],
        none,
        none,
        [0., half, 0., half],
        none,
    ];
    let output = builder.floats(keys.as_flattened(), "VEC4");
    builder.animate((0, "rotation"), "CUBICSPLINE", &[0.0, 1.0], output);
    // Half way, the spline without tangents is the mean of its ends, which lies half way round.
    let matrix = at(&builder, 0.5);
    let found = DQuat::from_mat4(&matrix);
    assert!(
        found.angle_between(DQuat::from_rotation_y(FRAC_PI_2 / 2.0)) < 1e-7,
        "{found}"
    );
    assert!((matrix.determinant() - 1.0).abs() < 1e-12);
}

#[test]
fn integers_stand_for_fractions() {
    let mut builder = Builder::square();
    let output = builder.accessor(&[0, 0, 0, 127, 0, 127, 0, 0], I8, "VEC4", 2);
    builder.json["accessors"][output]["normalized"] = json!(true);
    builder.animate((0, "rotation"), "LINEAR", &[0.0, 1.0], output);
    let found = DQuat::from_mat4(&at(&builder, 0.5));
    assert!(
        found.angle_between(DQuat::from_rotation_y(FRAC_PI_2)) < 1e-7,
        "{found}"
    );
}

#[test]
fn children_follow_and_a_single_key_holds() {
    let mut builder = Builder::square();
    builder.json["nodes"] = json!([{"children": [1]}, {"mesh": 0, "translation": [0, 1, 0]}]);
    let output = builder.floats(&[5., 0., 0.], "VEC3");
    builder.animate((0, "translation"), "LINEAR", &[7.0], output);
    assert_eq!(
        at(&builder, 0.0).w_axis.truncate().to_array(),
        [5.0, 1.0, 0.0]
    );
}

#[test]
fn a_matrix_gives_what_is_not_animated() {
    let mut builder = moved("LINEAR");
    let matrix = [3, 0, 0, 0, 0, 3, 0, 0, 0, 0, 3, 0, 7, 7, 7, 1];
    builder.json["nodes"][0] = json!({"mesh": 0, "matrix": matrix});
    let posed = at(&builder, 2.0);
    assert_eq!((posed.w_axis.x, posed.x_axis.x), (2.0, 3.0));
    let flat = [3, 0, 0, 0, 0, 3, 0, 0, 0, 0, 0, 0, 7, 7, 7, 1];
    builder.json["nodes"][0]["matrix"] = json!(flat);
    warned(
        &builder.scene_at(0, 2.0),
        "its `matrix` has no scale and rotation",
    );
}

#[test]
fn the_choice_is_by_name_or_index_and_a_moment_alone_means_the_first() {
    let mut builder = moved("LINEAR");
    builder.json["animations"][0]["name"] = json!("walk");
    let output = builder.floats(&[9., 0., 0.], "VEC3");
    builder.animate((0, "translation"), "STEP", &[0.0], output);
    let load = |animation: Option<&str>, at: Option<f64>| {
        builder.load_with(&LoadOptions {
            animation: animation.map(|name| name.parse::<Selector>().unwrap_or(Selector::Index(0))),
            at,
            ..LoadOptions::default()
        })
    };
    let x = |animation, at| {
        load(animation, at).expect("a scene").instances[0]
            .to_world
            .w_axis
            .x
    };
    assert_eq!(x(Some("walk"), Some(2.0)), 2.0);
    assert_eq!(x(Some("1"), None), 9.0);
    assert_eq!(x(None, Some(2.0)), 2.0);
    assert_eq!(x(None, None), 0.0);
    let scene = load(Some("walk"), Some(2.0)).expect("a scene");
    assert_eq!(
        scene.animation,
        Some(PlayedAnimation {
            index: 0,
            seconds: 2.0
        })
    );
    assert!(scene.notes.iter().all(|note| !note.contains("animation")));
    let rest = load(None, None).expect("a scene");
    assert!(
        rest.notes[0].contains("the file has 2 animations"),
        "{:?}",
        rest.notes
    );
    let error = load(Some("run"), None)
        .expect_err("no such animation")
        .to_string();
    assert!(
        error.ends_with("there is no animation \"run\"; choose one of 0 \"walk\", 1 \"\""),
        "{error}"
    );
    let error = Builder::square().pose_error();
    assert!(
        error.ends_with("there is no animation 0; the file has no animation"),
        "{error}"
    );
}

#[test]
fn what_is_no_node_is_warned_of() {
    let mut builder = moved("LINEAR");
    builder.json["animations"][0]["channels"][0]["target"] = json!({"path": "pointer"});
    warned(
        &builder.scene_at(0, 1.0),
        "animation 0, channel 0: it animates something other than a node",
    );
}

#[test]
fn wrong_animations_are_refused() {
    let change = |pointer: &str, value: Value, parts: &[&str]| {
        let mut builder = moved("LINEAR");
        set(&mut builder.json["animations"][0], pointer, value);
        let error = builder.pose_error();
        for part in parts {
            assert!(error.contains(part), "{part:?} is not in: {error}");
        }
        builder.scene();
    };
    let sampler = "animation 0, sampler 0: ";
    change(
        "channels/0/target",
        json!(null),
        &["animation 0, channel 0: `target` is missing"],
    );
    change(
        "channels/0/sampler",
        json!(null),
        &["animation 0, channel 0: `sampler` is missing"],
    );
    change(
        "channels/0/sampler",
        json!(3),
        &["`sampler` refers to sampler 3"],
    );
    change(
        "channels/0/target/node",
        json!(3),
        &["`node` refers to node 3"],
    );
    change(
        "channels/0/target/path",
        json!("colour"),
        &["`path` must be translation"],
    );
    change(
        "channels/0/target/path",
        json!("rotation"),
        &["rotation must be VEC4, found VEC3"],
    );
    change(
        "samplers/0/interpolation",
        json!("SLERP"),
        &[sampler, "`interpolation` must be"],
    );
    change(
        "samplers/0/interpolation",
        json!("CUBICSPLINE"),
        &[
            sampler,
            "its output has 2 elements, which does not fit its 2 keys",
        ],
    );
    change(
        "samplers/0/input",
        json!(null),
        &[sampler, "`input` is missing"],
    );
    change(
        "samplers/0/input",
        json!(0),
        &["input must be SCALAR, found VEC3"],
    );
    change(
        "samplers/0/input",
        json!(1),
        &["the times of an animation must be floats"],
    );
    let mut builder = Builder::square();
    let output = builder.floats(&[0.0; 6], "VEC3");
    builder.animate((0, "translation"), "LINEAR", &[2.0, 1.0], output);
    assert!(builder.pose_error().contains("must be finite and increase"));
    let mut builder = Builder::square();
    let output = builder.floats(&[0.0, f32::INFINITY, 0.0], "VEC3");
    builder.animate((0, "translation"), "LINEAR", &[0.0], output);
    assert!(
        builder
            .pose_error()
            .contains("the value of key 0 is not finite")
    );
    let mut builder = Builder::square();
    let output = builder.floats(&[0.0; 4], "VEC4");
    builder.animate((0, "rotation"), "LINEAR", &[0.0], output);
    assert!(
        builder
            .pose_error()
            .contains("one of its rotations has length zero")
    );
}
