//! Accessors, indices and topologies.

use glam::{DVec3, Vec3};
use serde_json::json;

use crate::common::*;
use crate::seeds;

#[test]
fn every_component_type_is_read() {
    for (component, normalized, bytes, expected) in [
        (I8, false, vec![0x80, 0x7F, 1, 0], [-128.0, 127.0, 1.0]),
        (I8, true, vec![0x80, 0x7F, 0, 0], [-1.0, 1.0, 0.0]),
        (U8, false, vec![255, 1, 0, 0], [255.0, 1.0, 0.0]),
        (U8, true, vec![255, 51, 0, 0], [1.0, 0.2, 0.0]),
        (
            I16,
            false,
            shorts(&[0x8000, 0x7FFF, 1, 0]),
            [-32768.0, 32767.0, 1.0],
        ),
        (I16, true, shorts(&[0x8000, 0x7FFF, 0, 0]), [-1.0, 1.0, 0.0]),
        (U16, false, shorts(&[65535, 1, 0, 0]), [65535.0, 1.0, 0.0]),
        (U16, true, shorts(&[65535, 13107, 0, 0]), [1.0, 0.2, 0.0]),
        (
            U32,
            false,
            words(&[1 << 31, 1, 0, 0]),
            [2147483648.0, 1.0, 0.0],
        ),
        (
            F32,
            false,
            floats(&[1.5, -2.5, 1e30, 0.0]),
            [1.5, -2.5, 1e30],
        ),
    ] {
        let mut builder = Builder::square();
        let stride = bytes.len();
        let accessor = builder.accessor(&bytes.repeat(4), component, "VEC3", 4);
        let view = builder.json["accessors"][accessor]["bufferView"]
            .as_u64()
            .expect("a view") as usize;
        builder.json["bufferViews"][view]["byteStride"] = json!(stride);
        builder.json["accessors"][accessor]["normalized"] = json!(normalized);
        builder.attribute("POSITION", accessor);
        let scene = builder.scene();
        assert_eq!(
            scene.meshes[0].positions[1],
            Vec3::from_array(expected),
            "{component} {normalized}"
        );
    }
}

#[test]
fn unaligned_data_is_read() {
    let mut builder = Builder::square();
    builder.bin.push(7);
    let positions = builder.accessor(&floats(&SQUARE), F32, "VEC3", 4);
    builder.attribute("POSITION", positions);
    assert_eq!(builder.scene().meshes[0].positions, square_positions());
}

#[test]
fn indices_of_every_size_are_read() {
    for (bytes, component) in [
        (vec![0, 1, 2], U8),
        (shorts(&[0, 1, 2]), U16),
        (words(&[0, 1, 2]), U32),
    ] {
        let mut builder = Builder::square();
        let indices = builder.accessor(&bytes, component, "SCALAR", 3);
        builder.json["meshes"][0]["primitives"][0]["indices"] = json!(indices);
        assert_eq!(builder.scene().meshes[0].indices, [[0, 1, 2]]);
    }
}

#[test]
fn quantised_strips_and_sparse_fans_are_squares() {
    let strip = seeds::quantized_strip().scene();
    assert_eq!(strip.meshes[0].indices, [[0, 1, 2], [1, 3, 2]]);
    assert_eq!(strip.meshes[0].positions[3], Vec3::new(100.0, 100.0, 0.0));
    assert_eq!(strip.meshes[0].normals, [Vec3::Z; 4]);
    silent(&strip);
    let fan = seeds::sparse_fan().scene();
    assert_eq!(fan.meshes[0].indices, [[1, 2, 0], [2, 3, 0]]);
    assert_eq!(fan.meshes[0].positions, square_positions());
}

#[test]
fn unused_vertices_are_left_out() {
    let mut builder = Builder::square();
    let indices = builder.accessor(&[1, 2, 3], U8, "SCALAR", 3);
    builder.json["meshes"][0]["primitives"][0]["indices"] = json!(indices);
    let scene = builder.scene();
    assert_eq!(scene.meshes[0].positions, square_positions()[1..]);
    assert_eq!(scene.meshes[0].indices, [[0, 1, 2]]);
}

#[test]
fn what_has_no_surface_is_skipped_with_a_warning() {
    for (mode, word) in [(0, "points"), (1, "lines"), (2, "lines"), (3, "lines")] {
        let mut builder = Builder::square();
        builder.json["meshes"][0]["primitives"][0]["mode"] = json!(mode);
        let scene = builder.scene();
        assert_eq!(scene.triangle_count(), 0);
        warned(
            &scene,
            &format!("mesh 0 \"square\", primitive 0: it consists of {word}"),
        );
    }
    let mut builder = Builder::square();
    builder.json["meshes"][0]["primitives"][0]["attributes"] = json!({});
    warned(&builder.scene(), "it has no POSITION; it is skipped");
    let mut builder = Builder::square();
    builder.json["accessors"][1]["count"] = json!(5);
    let scene = builder.scene();
    assert_eq!(scene.triangle_count(), 1);
    warned(
        &scene,
        "5 corners, which is no multiple of 3; the last 2 are skipped",
    );
}

#[test]
fn positions_that_are_not_finite_are_kept_and_told() {
    let mut builder = Builder::square();
    let mut positions = SQUARE;
    positions[3] = f32::INFINITY;
    let positions = builder.accessor(&floats(&positions), F32, "VEC3", 4);
    builder.attribute("POSITION", positions);
    let scene = builder.scene();
    warned(&scene, "1 of its positions are not finite");
    assert_eq!(
        scene.bounds(),
        Some((DVec3::ZERO, DVec3::new(1.0, 1.0, 0.0)))
    );
}
