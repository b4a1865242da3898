//! The decoders of compressed buffer views against meshoptimizer's, over many kinds of data.

use meshopt::{EncodeExpMode, encode_vertex_buffer_level};
use serde_json::json;

use crate::common::*;
use crate::meshopt_data::{View, encode};
use crate::mutate::Random;

const KHR: &str = "KHR_meshopt_compression";

/// Elements that are in part smooth, in part constant, in part noise.
fn elements<const N: usize>(count: usize, random: &mut Random) -> Vec<[u8; N]> {
    let kinds: Vec<usize> = (0..N).map(|_| random.below(5)).collect();
    let row = |index: usize, random: &mut Random| {
        std::array::from_fn(|byte| match kinds[byte] {
            0 => 42,
            1 => (index / 3) as u8,
            2 => (index as u8)
                .wrapping_mul(7)
                .wrapping_add(random.below(2) as u8),
            3 if random.below(9) > 0 => random.below(4) as u8,
            _ => random.next() as u8,
        })
    };
    (0..count).map(|index| row(index, random)).collect()
}

/// A file whose meshes show all bytes of a compressed view: the integers at each multiple of 4 bytes, and those a
/// byte later, are positions.
fn shown(view: &View, component: u32, step: usize) -> Builder {
    let mut builder = Builder::empty();
    view.add(&mut builder, KHR);
    let mut primitives = Vec::new();
    for channel in 0..view.stride / (4 * step) {
        for shift in [0, step] {
            let at = 4 * step * channel + shift;
            let accessor = json!({"bufferView": 0, "byteOffset": at, "componentType": component, "type": "VEC3", "count": view.count});
            let accessor = builder.push("accessors", accessor);
            primitives.push(json!({"attributes": {"POSITION": accessor}}));
        }
    }
    builder.json["meshes"] = json!([{"primitives": primitives}]);
    builder.json["nodes"] = json!([{"mesh": 0}]);
    builder.json["scenes"][0]["nodes"] = json!([0]);
    builder
}

/// The decoded bytes of a view of whole channels.
fn decoded(view: &View) -> Vec<u8> {
    let scene = shown(view, U8, 1).scene();
    let mut bytes = vec![0; view.count * view.stride];
    for (number, mesh) in scene.meshes.iter().enumerate() {
        assert_eq!(mesh.positions.len(), view.count);
        let at = 4 * (number / 2) + number % 2;
        for (element, position) in mesh.positions.iter().enumerate() {
            let row = &mut bytes[element * view.stride + at..][..3];
            row.copy_from_slice(&position.to_array().map(|c| c as u8));
        }
    }
    bytes
}

fn round_trip<const N: usize>(random: &mut Random) {
    // Multiples of three, since three vertices make a triangle; around the sizes of groups and blocks.
    for count in [3, 15, 18, 48, 255, 258, 600] {
        let elements = elements::<N>(count, random);
        for (version, level) in [(0, 0), (1, 0), (1, 1), (1, 2), (1, 3)] {
            let stream = encode_vertex_buffer_level(&elements, level, Some(version));
            let view = View {
                stream: &stream.expect("encoded"),
                count,
                stride: N,
                mode: "ATTRIBUTES",
                filter: None,
            };
            assert!(
                decoded(&view) == elements.as_flattened(),
                "{count} elements of {N} bytes, version {version}, level {level}"
            );
        }
    }
}

#[test]
fn attributes_survive_the_reference_encoder() {
    let mut random = Random(11);
    round_trip::<4>(&mut random);
    round_trip::<8>(&mut random);
    round_trip::<12>(&mut random);
    round_trip::<20>(&mut random);
    round_trip::<64>(&mut random);
    round_trip::<256>(&mut random);
}

/// Smooth 16-bit and 32-bit numbers, for which version 1 has channels of their own.
#[test]
fn wide_numbers_survive_the_reference_encoder() {
    let count = 300;
    let mut random = Random(1);
    let mut number = |i: usize| {
        let wave = (i as f32 * 0.1).sin();
        let short = (wave * 30000.0) as i16;
        let [a, b] = short.to_le_bytes();
        let [c, d] = (i as u16).wrapping_mul(300).to_le_bytes();
        // Three bits across the border of two bytes change, all others stay.
        let bits = 0x4049_0FDB ^ (random.below(8) as u32) << 14;
        let [e, f, g, h] = bits.to_le_bytes();
        [a, b, c, d, e, f, g, h]
    };
    let elements: Vec<[u8; 8]> = (0..count).map(&mut number).collect();
    let stream = encode_vertex_buffer_level(&elements, 3, Some(1)).expect("encoded");
    let channels = &stream[stream.len() - 2..];
    assert!(
        channels[0] == 1 && channels[1] & 15 == 2 && channels[1] > 15,
        "{channels:?}"
    );
    let view = View {
        stream: &stream,
        count,
        stride: 8,
        mode: "ATTRIBUTES",
        filter: None,
    };
    assert!(decoded(&view) == elements.as_flattened());
}

fn vectors(count: usize, random: &mut Random) -> Vec<[f32; 4]> {
    let unit = |random: &mut Random| {
        let mut v = [0.0; 4];
        v.fill_with(|| random.below(2001) as f32 / 1000.0 - 1.0);
        let length = v.iter().map(|c| c * c).sum::<f32>().sqrt().max(1e-3);
        v.map(|c| c / length)
    };
    (0..count).map(|_| unit(random)).collect()
}

/// What the loader makes of a filtered view of 16-bit numbers, four an element.
fn filtered<T>(encoded: &[T], stride: usize, filter: &str, component: u32) -> Vec<[f32; 4]> {
    let stream = encode(encoded, 1);
    let view = View {
        stream: &stream,
        count: encoded.len(),
        stride,
        mode: "ATTRIBUTES",
        filter: Some(filter),
    };
    let scene = shown(&view, component, stride / 4).scene();
    let pairs = scene.meshes[0]
        .positions
        .iter()
        .zip(&scene.meshes[1].positions);
    pairs
        .map(|(front, back)| [front.x, front.y, front.z, back.z])
        .collect()
}

fn near<T: Copy + Into<f32>>(found: &[[f32; 4]], expected: &[[T; 4]]) {
    assert_eq!(found.len(), expected.len());
    for (found, expected) in found.iter().zip(expected) {
        for (found, &expected) in found.iter().zip(expected) {
            // Both specifications allow a unit in the last place.
            assert!(
                (found - expected.into()).abs() <= 1.0,
                "{found}, not {}",
                expected.into()
            );
        }
    }
}

#[test]
fn filters_agree_with_the_reference_decoder() {
    let mut random = Random(5);
    let vectors = vectors(300, &mut random);
    for bits in [4, 7, 8] {
        let mut encoded = meshopt::encode_filter_oct::<i8>(&vectors, bits);
        let found = filtered(&encoded, 4, "OCTAHEDRAL", I8);
        meshopt::decode_filter_oct(&mut encoded);
        near(&found, &encoded);
        let colors = vectors.iter().map(|v| v.map(f32::abs)).collect::<Vec<_>>();
        let mut encoded = meshopt::encode_filter_color::<u8>(&colors, bits);
        let found = filtered(&encoded, 4, "COLOR", U8);
        meshopt::decode_filter_color(&mut encoded);
        near(&found, &encoded);
    }
    for bits in [5, 12, 16] {
        let mut encoded = meshopt::encode_filter_oct::<i16>(&vectors, bits);
        let found = filtered(&encoded, 8, "OCTAHEDRAL", I16);
        meshopt::decode_filter_oct(&mut encoded);
        near(&found, &encoded);
        let mut encoded = meshopt::encode_filter_quat(&vectors, bits);
        let found = filtered(&encoded, 8, "QUATERNION", I16);
        meshopt::decode_filter_quat(&mut encoded);
        near(&found, &encoded);
        let colors = vectors.iter().map(|v| v.map(f32::abs)).collect::<Vec<_>>();
        let mut encoded = meshopt::encode_filter_color::<u16>(&colors, bits);
        let found = filtered(&encoded, 8, "COLOR", U16);
        meshopt::decode_filter_color(&mut encoded);
        near(&found, &encoded);
    }
}

#[test]
fn exponents_are_exact() {
    let mut random = Random(3);
    let value = |random: &mut Random| {
        let scale = 2.0_f32.powi(random.below(120) as i32 - 60);
        (random.below(20001) as f32 / 10000.0 - 1.0) * scale
    };
    let values: Vec<[f32; 3]> = (0..300)
        .map(|_| [(); 3].map(|()| value(&mut random)))
        .collect();
    for mode in [EncodeExpMode::Separate, EncodeExpMode::SharedVector] {
        let mut encoded = meshopt::encode_filter_exp(&values, 20, mode);
        let stream = encode(&encoded, 1);
        let view = View {
            stream: &stream,
            count: 300,
            stride: 12,
            mode: "ATTRIBUTES",
            filter: Some("EXPONENTIAL"),
        };
        let mut builder = shown(&view, F32, 3);
        // The second primitive would begin inside of a number.
        builder.json["meshes"][0]["primitives"] = json!([{"attributes": {"POSITION": 0}}]);
        builder.json["accessors"]
            .as_array_mut()
            .expect("a list")
            .truncate(1);
        let scene = builder.scene();
        meshopt::decode_filter_exp(&mut encoded);
        let expected: Vec<[f32; 3]> = encoded.iter().map(|v| v.map(f32::from_bits)).collect();
        let found: Vec<[f32; 3]> = scene.meshes[0]
            .positions
            .iter()
            .map(|p| p.to_array())
            .collect();
        assert_eq!(found, expected);
    }
}

/// A grid, whose triangles share edges, then triangles of random corners.
fn triangles(random: &mut Random) -> Vec<u32> {
    let mut indices = Vec::new();
    for cell in 0..400_u32 {
        let at = cell / 20 * 21 + cell % 20;
        indices.extend([at, at + 1, at + 21, at + 21, at + 1, at + 22]);
    }
    for _ in 0..200 {
        indices.extend([(); 3].map(|()| random.below(441) as u32));
    }
    indices
}

#[test]
fn indices_agree_with_the_reference_decoder() {
    let mut random = Random(9);
    let indices = triangles(&mut random);
    for (mode, stride) in [
        ("TRIANGLES", 2),
        ("TRIANGLES", 4),
        ("INDICES", 2),
        ("INDICES", 4),
    ] {
        let (stream, expected): (Vec<u8>, Vec<u32>) = match mode {
            "TRIANGLES" => {
                let stream = meshopt::encode_index_buffer(&indices, 441).expect("encoded");
                let expected = meshopt::decode_index_buffer(&stream, indices.len());
                (stream, expected.expect("decoded"))
            }
            _ => {
                let stream = meshopt::encode_index_sequence(&indices, 441).expect("encoded");
                (stream, indices.clone())
            }
        };
        let view = View {
            stream: &stream,
            count: indices.len(),
            stride,
            mode,
            filter: None,
        };
        let mut builder = Builder::empty();
        view.add(&mut builder, KHR);
        let positions = builder.floats(&[0.5; 3 * 441], "VEC3");
        let component = if stride == 2 { U16 } else { U32 };
        let accessor = json!({"bufferView": 0, "componentType": component, "type": "SCALAR", "count": indices.len()});
        let accessor = builder.push("accessors", accessor);
        builder.json["meshes"] =
            json!([{"primitives": [{"attributes": {"POSITION": positions}, "indices": accessor}]}]);
        builder.json["nodes"] = json!([{"mesh": 0}]);
        builder.json["scenes"][0]["nodes"] = json!([0]);
        let scene = builder.scene();
        assert!(
            scene.meshes[0].indices.as_flattened() == expected,
            "{mode} {stride}"
        );
    }
}
