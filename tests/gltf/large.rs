//! Large files. Ignored by default: `cargo test --release --test gltf -- --ignored --nocapture`.

use std::time::Instant;

use etendue::scene::Scene;
use serde_json::json;

use crate::common::*;

/// A grid of `side` × `side` squares with texture coordinates and, if wanted, normals.
fn grid(side: u32, normals: bool) -> Builder {
    let mut builder = Builder::textured();
    let across = side + 1;
    let count = (across * across) as usize;
    let corners = (0..across * across).map(|i| ((i % across) as f32, (i / across) as f32));
    let positions: Vec<f32> = corners
        .clone()
        .flat_map(|(x, y)| [x, y, (x * y).sin()])
        .collect();
    let uvs: Vec<f32> = corners.flat_map(|(x, y)| [x / 8.0, y / 8.0]).collect();
    let squares = (0..side * side).map(|i| i / side * across + i % side);
    let indices: Vec<u32> = squares
        .flat_map(|at| {
            [
                at,
                at + 1,
                at + across,
                at + 1,
                at + across + 1,
                at + across,
            ]
        })
        .collect();
    let accessor = builder.accessor(&floats(&positions), F32, "VEC3", count);
    builder.attribute("POSITION", accessor);
    let accessor = builder.accessor(&floats(&uvs), F32, "VEC2", count);
    builder.attribute("TEXCOORD_0", accessor);
    if normals {
        let accessor = builder.accessor(&floats(&[0., 0., 1.]).repeat(count), F32, "VEC3", count);
        builder.attribute("NORMAL", accessor);
    }
    let accessor = builder.accessor(&words(&indices), U32, "SCALAR", indices.len());
    builder.json["meshes"][0]["primitives"][0]["indices"] = json!(accessor);
    builder
}

fn timed(name: &str, builder: &Builder) -> Scene {
    let bytes = builder.glb();
    let start = Instant::now();
    let scene = load_bytes(&bytes).unwrap_or_else(|error| panic!("{error}"));
    let load = start.elapsed();
    scene.validate().unwrap_or_else(|error| panic!("{error}"));
    let validate = start.elapsed() - load;
    let megabytes = bytes.len() / 1_000_000;
    println!(
        "{name}: {} triangles, {megabytes} MB: load {load:?}, validate {validate:?}",
        scene.triangle_count()
    );
    scene
}

#[test]
#[ignore = "takes seconds and gigabytes"]
fn large_files_load_in_seconds() {
    assert_eq!(
        timed("grid", &grid(2200, true)).triangle_count(),
        2 * 2200 * 2200
    );
    let mut mapped = grid(707, true);
    mapped.json["materials"][0]["normalTexture"] = json!({"index": 0});
    assert!(!timed("normal map", &mapped).meshes[0].tangents.is_empty());
    let mut flat = grid(707, false);
    flat.json["materials"][0]["normalTexture"] = json!({"index": 0});
    assert!(
        !timed("normal map, flat", &flat).meshes[0]
            .tangents
            .is_empty()
    );
}

#[test]
#[ignore = "takes seconds"]
fn a_million_coincident_triangles_with_a_normal_map_load() {
    let mut builder = Builder::textured();
    builder.json["materials"][0]["normalTexture"] = json!({"index": 0});
    let indices = builder.accessor(
        &words(&[0, 1, 2].repeat(1_000_000)),
        U32,
        "SCALAR",
        3_000_000,
    );
    builder.json["meshes"][0]["primitives"][0]["indices"] = json!(indices);
    timed("coincident", &builder);
}
