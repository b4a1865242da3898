//! Buffer views compressed by meshoptimizer, the reference encoder.

use serde_json::{Value, json};

use crate::common::*;

/// A buffer view that holds `count` elements of `stride` bytes in compressed form.
pub struct View<'a> {
    pub stream: &'a [u8],
    pub count: usize,
    pub stride: usize,
    pub mode: &'a str,
    pub filter: Option<&'a str>,
}

impl View<'_> {
    /// Append it to the file, which has a second buffer without data for what it decodes to.
    pub fn add(&self, builder: &mut Builder, extension: &str) -> usize {
        let at = builder.bin.len();
        builder.bin.extend(self.stream);
        let length = self.count * self.stride;
        let mut compressed = json!({
            "buffer": 0, "byteOffset": at, "byteLength": self.stream.len(),
            "byteStride": self.stride, "count": self.count, "mode": self.mode,
        });
        if let Some(filter) = self.filter {
            compressed["filter"] = json!(filter);
        }
        builder.json["buffers"] = json!([
            {"byteLength": 0},
            {"byteLength": 1 << 20, "extensions": {extension: {"fallback": true}}},
        ]);
        builder.json["extensionsUsed"] = json!([extension]);
        builder.json["extensionsRequired"] = json!([extension]);
        let mut view = json!({
            "buffer": 1, "byteLength": length, "extensions": {extension: compressed},
        });
        if self.mode == "ATTRIBUTES" {
            view["byteStride"] = json!(self.stride);
        }
        builder.push("bufferViews", view)
    }
}

/// The square: positions with the exponential filter, triangles, and normals with the octahedral one.
pub fn square(extension: &str, version: i32) -> Builder {
    let mut builder = Builder::square();
    builder.bin.clear();
    builder.json["bufferViews"] = json!([]);
    let corners: Vec<[f32; 3]> = SQUARE.chunks(3).map(|c| [c[0], c[1], c[2]]).collect();
    let exponents = meshopt::encode_filter_exp(&corners, 15, meshopt::EncodeExpMode::Separate);
    let positions = encode(&exponents, version);
    let normals = meshopt::encode_filter_oct::<i8>(&[[0.0, 0.0, 1.0, 0.0]; 4], 8);
    let normals = encode(&normals, version);
    let triangles = meshopt::encode_index_buffer(&[0, 1, 2, 0, 2, 3], 4).expect("encoded");
    let attributes = |stream, stride, filter| View {
        stream,
        count: 4,
        stride,
        mode: "ATTRIBUTES",
        filter: Some(filter),
    };
    attributes(&positions, 12, "EXPONENTIAL").add(&mut builder, extension);
    attributes(&normals, 4, "OCTAHEDRAL").add(&mut builder, extension);
    let indices = View {
        stream: &triangles,
        count: 6,
        stride: 2,
        mode: "TRIANGLES",
        filter: None,
    };
    indices.add(&mut builder, extension);
    builder.json["accessors"] = json!([
        {"bufferView": 0, "componentType": F32, "type": "VEC3", "count": 4},
        {"bufferView": 2, "componentType": U16, "type": "SCALAR", "count": 6},
        {"bufferView": 1, "componentType": I8, "type": "VEC3", "count": 4, "normalized": true},
    ]);
    builder.attribute("NORMAL", 2);
    builder
}

pub fn encode<T>(elements: &[T], version: i32) -> Vec<u8> {
    meshopt::encode_vertex_buffer_level(elements, 2, Some(version)).expect("encoded")
}

#[test]
fn both_extensions_hold_the_square() {
    for (extension, version) in [
        ("EXT_meshopt_compression", 0),
        ("KHR_meshopt_compression", 1),
    ] {
        let scene = square(extension, version).scene();
        silent(&scene);
        assert_eq!(scene.meshes[0].positions, square_positions());
        assert_eq!(scene.triangle_count(), 2);
        assert!(scene.meshes[0].normals.iter().all(|n| *n == glam::Vec3::Z));
    }
}

#[test]
fn the_copy_beside_compressed_data_is_not_read() {
    let mut builder = square("EXT_meshopt_compression", 0);
    builder.json["buffers"][1]["uri"] = json!("not-there.bin");
    assert_eq!(builder.scene().triangle_count(), 2);
    // A view that is not compressed needs the buffer after all.
    let mut plain = builder.clone();
    plain.push("bufferViews", json!({"buffer": 1, "byteLength": 4}));
    assert!(
        plain.error().contains("buffer 1 (file \"not-there.bin\")"),
        "{}",
        plain.error()
    );
    builder.json["buffers"][1]["uri"] = json!(null);
    let view = builder.push("bufferViews", json!({"buffer": 1, "byteLength": 48}));
    builder.json["accessors"][0]["bufferView"] = json!(view);
    refused(
        builder,
        &["buffer view 3: it needs buffer 1, which has neither a URI nor"],
    );
}

#[test]
fn wrong_descriptions_are_refused() {
    let change = |view: usize, key: &str, value: Value| {
        let mut builder = square("EXT_meshopt_compression", 0);
        builder.json["bufferViews"][view]["extensions"]["EXT_meshopt_compression"][key] = value;
        builder
    };
    let here = "buffer view 0, EXT_meshopt_compression: ";
    refused(
        change(0, "buffer", json!(null)),
        &[here, "`buffer` is missing"],
    );
    refused(
        change(0, "buffer", json!(1)),
        &[here, "it needs buffer 1, which has neither"],
    );
    refused(
        change(0, "byteLength", json!(1_u64 << 40)),
        &[here, "do not fit in buffer 0"],
    );
    refused(
        change(0, "count", json!(5)),
        &[here, "5 elements of 12 bytes are not the 48 bytes"],
    );
    refused(
        change(0, "mode", json!("POINTS")),
        &[here, "`mode` must be"],
    );
    refused(
        change(0, "filter", json!("SMOOTH")),
        &[here, "`filter` must be"],
    );
    refused(
        change(0, "filter", json!("OCTAHEDRAL")),
        &[here, "`byteStride` is 12, which"],
    );
    refused(
        change(0, "mode", json!("INDICES")),
        &[here, "`byteStride` is 12, which"],
    );
    refused(
        change(2, "filter", json!("EXPONENTIAL")),
        &["buffer view 2", "indices must not have a `filter`"],
    );
    refused(
        change(0, "byteLength", json!(0)),
        &[here, "0 compressed bytes cannot hold 48 bytes"],
    );
}

/// The end of a stream is found from its length: a byte more or less is noticed.
#[test]
fn streams_of_another_length_are_refused() {
    for (extension, version) in [
        ("EXT_meshopt_compression", 0),
        ("KHR_meshopt_compression", 1),
    ] {
        for view in 0..3 {
            for step in [-1, 1] {
                let mut builder = square(extension, version);
                // The stream that follows, or these bytes, are behind it.
                builder.bin.extend([0; 4]);
                let length =
                    &mut builder.json["bufferViews"][view]["extensions"][extension]["byteLength"];
                *length = json!(length.as_i64().unwrap_or(0) + step);
                let here = format!("buffer view {view}, {extension}: its data is malformed (");
                refused(builder, &[&here, "export or copy the file again"]);
            }
        }
    }
}

/// Every byte of every stream with every bit flipped: a scene or a sentence.
#[test]
fn changed_streams_give_a_scene_or_a_sentence() {
    let (mut refused, mut loaded) = (0, 0);
    for (extension, version) in [
        ("EXT_meshopt_compression", 0),
        ("KHR_meshopt_compression", 1),
    ] {
        let whole = square(extension, version);
        for at in 0..whole.bin.len() {
            for bit in 0..8 {
                let mut changed = whole.clone();
                changed.bin[at] ^= 1 << bit;
                match changed.load_with(&Default::default()) {
                    Ok(scene) => {
                        scene.validate().unwrap_or_else(|error| panic!("{error}"));
                        loaded += 1;
                    }
                    Err(error) => {
                        let sentence = error.to_string();
                        assert!(sentence.starts_with("scene.gltf: "), "{sentence}");
                        refused += 1;
                    }
                }
            }
        }
    }
    assert!(
        refused > 100 && loaded > 100,
        "{refused} refused, {loaded} loaded"
    );
}
