//! KHR_draco_mesh_compression. The streams were written by the reference encoder (Draco 1.5, through DracoPy).

use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use etendue::scene::Scene;
use glam::{Vec2, Vec3, Vec4};
use serde_json::{Value, json};

use crate::common::*;
use crate::fuzz::variable;
use crate::mutate::{Random, mutate_bytes};

/// The square with texture coordinates, normals, colours and joints, positions and normals quantised to 14 bits,
/// connectivity by the edgebreaker.
const EDGEBREAKER: &str = "RFJBQ08CAgEBAAAABAIEAgAAAR//ARH/ARH/ARH/ARH/AREFAAAAAQAAAgAAAwAA/wAAAQICBAEVAQEDCQIBFgABAQkDABcAAQQEBAAUAQEACQMAGAIBAQEACQMBIAEQEwEQAwAwkCkREADQLwAAAAD/AAAAAAAAAAAAgD8AAIA/AAAAAAAAAAAAAAAAAACAPwAAgD8AAAAAAAAAAAAAgD8AAAAAAAAAAAAAgD8AAAAAAAAAAAAAgD8AAAAAAAAAAAAAgD8BAQEAAgMBQAEAAgAAAAAAAQAAAAEBAQADAwEwARADACiCmAAAAAAA/z8AAAAAAAAAAAAAAAAAAAAAgD8O";
/// The same, its triangles one after the other as they are.
const SEQUENTIAL: &str = "RFJBQ08CAgEAAAACBAEAAQIAAgMBBQICBAEVAwkCARYBCQMAFwQEBAAUAAkDABgBAAABAgABAQAJAwEQASATARADAJCQaYAREADQDwAAAAD/AAAAAAAAAAAAgD8AAIA/AACAPwAAgD8AAAAAAAAAAAAAAAAAAAAAAAAAAAAAgD8AAAAAAAAAAAAAgD8AAAAAAAAAAAAAgD8AAAAAAAAAAAAAgD8AAQEAAgMBQAEAAgAAAAAAAQAAAAABAQADAwEwARADADSCiAQAAAAA/z8AAAAAAAAAAAAAAAAAAAAAgD8O";

fn bytes(stream: &str) -> Vec<u8> {
    BASE64_STANDARD.decode(stream).expect("base64")
}

/// The square, held by a stream alone.
pub fn square(stream: &[u8]) -> Builder {
    let mut builder = Builder::textured();
    let view = builder.view(stream);
    let mut accessor = |component: u32, shape: &str, count: usize, normalized: bool| {
        builder.push(
            "accessors",
            json!({"componentType": component, "type": shape, "count": count, "normalized": normalized}),
        )
    };
    let attributes = json!({
        "POSITION": accessor(F32, "VEC3", 4, false),
        "NORMAL": accessor(F32, "VEC3", 4, false),
        "TEXCOORD_0": accessor(F32, "VEC2", 4, false),
        "COLOR_0": accessor(U8, "VEC4", 4, true),
    });
    let indices = accessor(U16, "SCALAR", 6, false);
    builder.json["meshes"][0]["primitives"][0] = json!({
        "attributes": attributes,
        "indices": indices,
        "material": 0,
        "extensions": {"KHR_draco_mesh_compression": {
            "bufferView": view,
            "attributes": {"POSITION": 24, "NORMAL": 23, "TEXCOORD_0": 22, "COLOR_0": 21},
        }},
    });
    builder.json["extensionsUsed"] = json!(["KHR_draco_mesh_compression"]);
    builder.json["extensionsRequired"] = json!(["KHR_draco_mesh_compression"]);
    builder
}

pub fn edgebreaker() -> Builder {
    square(&bytes(EDGEBREAKER))
}

pub fn sequential() -> Builder {
    square(&bytes(SEQUENTIAL))
}

fn primitive(builder: &mut Builder) -> &mut Value {
    &mut builder.json["meshes"][0]["primitives"][0]
}

fn extension(builder: &mut Builder) -> &mut Value {
    &mut primitive(builder)["extensions"]["KHR_draco_mesh_compression"]
}

/// The corners of the square in the order of the encoder's input, whatever order the stream has.
fn corners(scene: &Scene) -> Vec<usize> {
    let found = scene.meshes[0].positions.iter();
    let near = |corner: &Vec3| {
        let mut found = found.clone();
        let at = found.position(|p| p.abs_diff_eq(*corner, 1e-4));
        at.unwrap_or_else(|| panic!("no vertex at {corner}"))
    };
    square_positions().iter().map(near).collect()
}

#[test]
fn both_connectivities_hold_the_square() {
    for builder in [edgebreaker(), sequential()] {
        let scene = builder.scene();
        silent(&scene);
        let mesh = &scene.meshes[0];
        let corner = corners(&scene);
        assert_eq!((mesh.positions.len(), mesh.indices.len()), (4, 2));
        let uvs: Vec<Vec2> = corner.iter().map(|&at| mesh.tex_coords[0][at]).collect();
        let expected: Vec<Vec2> = UPRIGHT.chunks(2).map(Vec2::from_slice).collect();
        assert_eq!(uvs, expected);
        assert!(mesh.normals.iter().all(|n| n.abs_diff_eq(Vec3::Z, 1e-6)));
        assert_eq!(mesh.colors[corner[0]], Vec4::new(1.0, 0.0, 0.0, 1.0));
        assert_eq!(
            mesh.colors[corner[3]],
            Vec4::new(1.0, 1.0, 1.0, 128.0 / 255.0)
        );
        // Both triangles wind counter-clockwise about +Z and cover the square once.
        let mut area = 0.0;
        for triangle in &mesh.indices {
            let [a, b, c] = triangle.map(|vertex| mesh.positions[vertex as usize]);
            let twice = (b - a).cross(c - a);
            assert!(
                twice.z > 0.99 && twice.x == 0.0 && twice.y == 0.0,
                "{twice}"
            );
            area += twice.z / 2.0;
        }
        assert!((area - 1.0).abs() < 1e-3, "{area}");
    }
}

#[test]
fn a_stream_wins_over_the_copy_beside_it() {
    let mut builder = sequential();
    let far = builder.floats(&[9.0; 12], "VEC3");
    primitive(&mut builder)["attributes"]["POSITION"] = json!(far);
    builder.json["extensionsRequired"] = json!(null);
    assert_eq!(corners(&builder.scene()), [0, 1, 2, 3]);
}

#[test]
fn strips_are_stored_as_triangles() {
    let mut builder = sequential();
    primitive(&mut builder)["mode"] = json!(5);
    assert_eq!(builder.scene().meshes[0].indices, [[0, 1, 2], [0, 2, 3]]);
    primitive(&mut builder)["mode"] = json!(6);
    refused(
        builder,
        &[
            "mesh 0 \"square\", primitive 0, KHR_draco_mesh_compression: the primitive's `mode` is 6",
        ],
    );
}

/// Attributes that the stream lacks lie in buffers as ever, and a wider type than the accessor's is narrowed:
/// the encoder stored the joints, 16-bit numbers, with 32 bits.
#[test]
fn joints_of_a_stream_move_its_vertices() {
    let mut builder = sequential();
    let weights = builder.floats(&[0.0, 1.0, 0.0, 0.0].repeat(4), "VEC4");
    let joints = json!({"componentType": U16, "type": "VEC4", "count": 4});
    let joints = builder.push("accessors", joints);
    primitive(&mut builder)["attributes"]["WEIGHTS_0"] = json!(weights);
    primitive(&mut builder)["attributes"]["JOINTS_0"] = json!(joints);
    extension(&mut builder)["attributes"]["JOINTS_0"] = json!(20);
    builder.json["nodes"] = json!([{"mesh": 0, "skin": 0}, {}, {"translation": [0, 0, 7]}]);
    builder.json["scenes"][0]["nodes"] = json!([0, 1, 2]);
    builder.json["skins"] = json!([{"joints": [1, 2]}]);
    let scene = builder.scene();
    assert!(world_positions(&scene, 0).iter().all(|p| p.z == 7.0));
}

#[test]
fn what_a_stream_holds_counts_and_not_what_the_accessors_promise() {
    let mut builder = sequential();
    let position = primitive(&mut builder)["attributes"]["POSITION"]
        .as_u64()
        .expect("an index");
    builder.json["accessors"][position as usize]["count"] = json!(5);
    let scene = builder.scene();
    assert_eq!(scene.meshes[0].positions.len(), 4);
    warned(
        &scene,
        "KHR_draco_mesh_compression: it holds 4 points, but the accessors promise 5 elements",
    );
}

#[test]
fn triangles_of_a_stream_fit_positions_beside_it_or_are_refused() {
    let beside = |corners: usize| {
        let mut builder = sequential();
        let positions = builder.floats(&[0.5; 12][..3 * corners], "VEC3");
        primitive(&mut builder)["attributes"] = json!({"POSITION": positions});
        extension(&mut builder)["attributes"] = json!({});
        builder
    };
    assert_eq!(beside(4).scene().meshes[0].positions.len(), 4);
    refused(
        beside(3),
        &["a triangle of its Draco stream refers to vertex 3", "has 3"],
    );
}

#[test]
fn wrong_descriptions_are_refused() {
    let change = |pointer: &str, value: Value| {
        let mut builder = sequential();
        set(extension(&mut builder), pointer, value);
        builder
    };
    let here = "mesh 0 \"square\", primitive 0, KHR_draco_mesh_compression";
    refused(
        change("bufferView", json!(null)),
        &[here, "`bufferView` is missing"],
    );
    refused(change("bufferView", json!(99)), &[here, "buffer view 99"]);
    refused(
        change("attributes", json!(null)),
        &[here, "`attributes` is missing"],
    );
    refused(
        change("attributes/NORMAL", json!(77)),
        &[here, "NORMAL is attribute 77, which its data does not hold"],
    );
    refused(
        change("attributes/NORMAL", json!("x")),
        &[here, "`NORMAL` must be a non-negative integer"],
    );
    refused(
        change("attributes/NORMAL", json!(22)),
        &[
            here,
            "NORMAL: its elements have 2 components, but the accessor is VEC3",
        ],
    );
    let mut builder = sequential();
    let normal = primitive(&mut builder)["attributes"]["TEXCOORD_0"]
        .as_u64()
        .expect("an index") as usize;
    let uvs = builder.floats(&[0.0; 10], "VEC2");
    primitive(&mut builder)["attributes"]["TEXCOORD_1"] = json!(uvs);
    assert_ne!(normal, uvs);
    refused(
        builder,
        &["attribute \"TEXCOORD_1\" has 5 elements, but POSITION has 4"],
    );
}

#[test]
fn broken_streams_are_refused() {
    let whole = bytes(SEQUENTIAL);
    let here = "mesh 0 \"square\", primitive 0, KHR_draco_mesh_compression: its data is malformed";
    for length in [0, 4, 10, 13, 40, whole.len() / 2] {
        refused(square(&whole[..length]), &[here, "export or copy"]);
    }
    // Behind 11 bytes of header: two triangles, four points. 2³² − 1 of them is a claim that the bytes cannot back.
    assert_eq!(whole[11..13], [2, 4]);
    let huge = [0xFF, 0xFF, 0xFF, 0xFF, 0x0F];
    let claims = [
        [&whole[..11], &huge, &whole[12..]].concat(),
        [&whole[..12], &huge, &whole[13..]].concat(),
    ];
    for claim in claims {
        refused(
            square(&claim),
            &["primitive 0, KHR_draco_mesh_compression: "],
        );
    }
}

/// Every byte of a stream with every bit flipped, and with odd values.
#[test]
fn changed_streams_give_a_scene_or_a_sentence() {
    let mut random = Random(7);
    let (mut refused, mut loaded) = (0, 0);
    for stream in [EDGEBREAKER, SEQUENTIAL].map(bytes) {
        for at in 0..stream.len() {
            let odd = [0, 0x7F, 0x80, 0xFF, random.next() as u8];
            let flipped = (0..8).map(|bit| stream[at] ^ 1 << bit);
            for value in flipped.chain(odd) {
                let mut changed = stream.clone();
                changed[at] = value;
                match square(&changed).load_with(&Default::default()) {
                    Ok(scene) => {
                        scene.validate().unwrap_or_else(|error| panic!("{error}"));
                        loaded += 1;
                    }
                    Err(error) => {
                        let sentence = error.to_string();
                        assert!(
                            sentence.contains("mesh 0 \"square\", primitive 0"),
                            "{sentence}"
                        );
                        refused += 1;
                    }
                }
            }
        }
    }
    assert!(
        refused > 500 && loaded > 500,
        "{refused} refused, {loaded} loaded"
    );
}

/// The streams of a real model, some of their bytes changed.
#[test]
fn changed_streams_of_a_model_give_a_scene_or_a_sentence() {
    let Some(models) = shared("assets/models") else {
        return;
    };
    let bytes = std::fs::read(models.join("chess-board.glb")).expect("a file");
    let word =
        |at: usize| u32::from_le_bytes([bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]]);
    let length = word(12) as usize;
    let json: Value = serde_json::from_slice(&bytes[20..20 + length]).expect("JSON");
    let mut random = Random(1);
    let cases = variable("ETENDUE_FUZZ_CASES", 2000) / 20;
    let mut refused = 0;
    for case in 0..cases {
        let mut builder = Builder {
            json: json.clone(),
            bin: bytes[28 + length..].to_vec(),
        };
        // The smallest meshes, and no images: these take the time.
        let mesh = 3 + random.below(5);
        let primitive = &mut builder.json["meshes"][mesh]["primitives"][0];
        primitive["material"] = json!(null);
        let view = primitive["extensions"]["KHR_draco_mesh_compression"]["bufferView"].clone();
        builder.json["nodes"] = json!([{"mesh": mesh}]);
        builder.json["scenes"] = json!([{"nodes": [0]}]);
        let view = &builder.json["bufferViews"][view.as_u64().expect("an index") as usize];
        let number = |key: &str| view[key].as_u64().unwrap_or(0) as usize;
        let (start, length) = (number("byteOffset"), number("byteLength"));
        // Half of the changes hit what says how the rest is to be read.
        let length = if case % 2 == 0 {
            256.min(length)
        } else {
            length
        };
        mutate_bytes(&mut builder.bin[start..start + length], &mut random);
        match builder.load_with(&Default::default()) {
            Ok(scene) => scene.validate().unwrap_or_else(|error| panic!("{error}")),
            Err(error) => {
                assert!(
                    error.to_string().contains("KHR_draco_mesh_compression"),
                    "{error}"
                );
                refused += 1;
            }
        }
    }
    println!("{refused} of {cases} refused");
    assert!(refused > 0);
}
