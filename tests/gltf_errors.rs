//! Malformed files: each is refused with a sentence that names the file, the object and what was expected.

mod gltf_common;

use etendue::scene::gltf::{LoadOptions, load};
use gltf_common::*;
use serde_json::{Value, json};
use tempfile::TempDir;

/// Change the square at a JSON pointer's parent and expect a sentence with these parts.
fn refused(builder: Builder, parts: &[&str]) {
    let sentence = builder.error();
    assert!(sentence.contains("scene.gltf: "), "{sentence}");
    assert!(!sentence.contains('\n'), "{sentence}");
    for part in parts {
        assert!(sentence.contains(part), "{part:?} is not in: {sentence}");
    }
}

/// The textured square with a value set at a JSON pointer.
fn with(pointer: &str, value: Value) -> Builder {
    let mut builder = Builder::textured();
    set(&mut builder.json, pointer, value);
    builder
}

fn set(json: &mut Value, pointer: &str, value: Value) {
    let mut at = json;
    for key in pointer.split('/') {
        at = match key.parse::<usize>() {
            Ok(index) => &mut at[index],
            Err(_) => &mut at[key],
        };
    }
    *at = value;
}

#[test]
fn references_must_exist() {
    let cases = [
        (
            "scene",
            json!(7),
            "`scene` refers to scene 7, but the file has 1 scene",
        ),
        (
            "scenes/0/nodes",
            json!([4]),
            "scene 0: `nodes` refers to node 4",
        ),
        (
            "nodes/0/mesh",
            json!(3),
            "node 0 \"node\": `mesh` refers to mesh 3, but the file has 1 mesh",
        ),
        (
            "nodes/0/camera",
            json!(0),
            "`camera` refers to camera 0, but the file has no camera",
        ),
        ("nodes/0/skin", json!(0), "`skin` refers to skin 0"),
        (
            "nodes/0/children",
            json!([9]),
            "`children` refers to node 9",
        ),
        (
            "meshes/0/primitives/0/material",
            json!(1),
            "primitive 0: `material` refers to material 1",
        ),
        (
            "meshes/0/primitives/0/indices",
            json!(99),
            "`indices` refers to accessor 99",
        ),
        (
            "meshes/0/primitives/0/attributes/POSITION",
            json!(99),
            "`POSITION` refers to accessor 99",
        ),
        (
            "meshes/0/primitives/0/attributes/WEIGHTS_0",
            json!(99),
            "`WEIGHTS_0` refers to accessor 99",
        ),
        (
            "accessors/0/bufferView",
            json!(99),
            "accessor 0: `bufferView` refers to buffer view 99",
        ),
        (
            "bufferViews/0/buffer",
            json!(5),
            "buffer view 0: `buffer` refers to buffer 5",
        ),
        (
            "materials/0/pbrMetallicRoughness/baseColorTexture/index",
            json!(2),
            "material 0 \"paint\", pbrMetallicRoughness, baseColorTexture: `index` refers to texture 2",
        ),
        (
            "textures/0/source",
            json!(8),
            "texture 0: `source` refers to image 8",
        ),
        (
            "textures/0/sampler",
            json!(0),
            "texture 0: `sampler` refers to sampler 0",
        ),
        (
            "images/0/bufferView",
            json!(99),
            "image 0 \"checks\": `bufferView` refers to buffer view 99",
        ),
        (
            "nodes/0/extensions",
            json!({"KHR_lights_punctual": {"light": 0}}),
            "`light` refers to light 0",
        ),
    ];
    for (pointer, value, part) in cases {
        refused(with(pointer, value), &[part]);
    }
}

#[test]
fn values_must_have_their_type_and_range() {
    let cases = [
        ("asset/version", json!("1.0"), "the glTF version is \"1.0\""),
        ("asset/minVersion", json!("2.1"), "`minVersion` is \"2.1\""),
        ("asset", json!(null), "`asset` is missing"),
        (
            "nodes",
            json!({}),
            "`nodes` must be an array, found an object",
        ),
        (
            "nodes/0",
            json!(3),
            "node 0: expected a JSON object, found 3",
        ),
        (
            "nodes/0/mesh",
            json!(-1),
            "`mesh` must be a non-negative integer, found -1",
        ),
        (
            "nodes/0/mesh",
            json!(0.5),
            "`mesh` must be a non-negative integer, found 0.5",
        ),
        ("nodes/0/mesh", json!("0"), "found the string \"0\""),
        (
            "nodes/0/matrix",
            json!([1, 2]),
            "`matrix` must be an array of 16 finite numbers, found an array of 2 values",
        ),
        (
            "nodes/0/scale",
            json!([1, 2, "x"]),
            "`scale` must be an array of 3 finite numbers",
        ),
        (
            "accessors/0/componentType",
            json!(5124),
            "`componentType` is 5124",
        ),
        ("accessors/0/type", json!("VEC5"), "`type` must be SCALAR"),
        ("accessors/0/count", json!(0), "`count` is 0"),
        ("accessors/0/count", json!(null), "`count` is missing"),
        (
            "accessors/0/count",
            json!(5),
            "5 elements of 12 bytes, 12 apart, from byte 0 on do not fit in buffer view 0, which has 48 bytes",
        ),
        ("accessors/0/count", json!(u64::MAX), "do not fit"),
        ("accessors/0/byteOffset", json!(u64::MAX), "do not fit"),
        ("accessors/0/byteOffset", json!(4), "do not fit"),
        (
            "accessors/0/type",
            json!("VEC2"),
            "POSITION must be VEC3, found VEC2",
        ),
        (
            "accessors/1/componentType",
            json!(5122),
            "indices must be unsigned integers",
        ),
        ("bufferViews/0/byteStride", json!(8), "overlap"),
        ("bufferViews/0/byteStride", json!(u64::MAX), "do not fit"),
        (
            "bufferViews/0/byteLength",
            json!(1_000_000),
            "1000000 bytes from byte 0 on do not fit in buffer 0",
        ),
        (
            "bufferViews/0/byteOffset",
            json!(u64::MAX),
            "do not fit in buffer 0",
        ),
        (
            "bufferViews/0/byteLength",
            json!(null),
            "`byteLength` is missing",
        ),
        (
            "meshes/0/primitives/0/mode",
            json!(7),
            "`mode` is 7, expected 0 to 6",
        ),
        (
            "materials/0/alphaMode",
            json!("GLASS"),
            "`alphaMode` must be OPAQUE, MASK or BLEND, found \"GLASS\"",
        ),
        (
            "materials/0/extensions",
            json!({"KHR_materials_ior": {"ior": 0.5}}),
            "material 0 \"paint\", KHR_materials_ior: `ior` is 0.5, expected 0 or at least 1",
        ),
        (
            "materials/0/emissiveFactor",
            json!([1e300, 0, 0]),
            "`emissiveFactor` is 1e300, beyond the largest 32-bit float",
        ),
        (
            "materials/0/normalTexture",
            json!({"scale": 1}),
            "normalTexture: `index` is missing",
        ),
        (
            "textures/0/source",
            json!(null),
            "texture 0: it has no image",
        ),
        (
            "images/0/bufferView",
            json!(null),
            "it has neither `uri` nor `bufferView`",
        ),
        ("samplers", json!([{"wrapS": 1}]), "sampler 0: `wrapS` is 1"),
        (
            "samplers",
            json!([{"magFilter": 1}]),
            "sampler 0: `magFilter` is 1",
        ),
        (
            "cameras",
            json!([{"type": "fisheye"}]),
            "camera 0: `type` must be perspective or orthographic",
        ),
        (
            "cameras",
            json!([{"type": "perspective", "perspective": {"yfov": 4}}]),
            "`yfov` is 4",
        ),
        (
            "cameras",
            json!([{"type": "perspective"}]),
            "`perspective` is missing",
        ),
        (
            "cameras",
            json!([{"type": "orthographic", "orthographic": {"xmag": 0, "ymag": 1}}]),
            "`xmag` is 0",
        ),
        (
            "extensions",
            json!({"KHR_lights_punctual": {"lights": [{"type": "area"}]}}),
            "light 0: `type` must be point, spot or directional",
        ),
        (
            "extensionsRequired",
            json!(3),
            "`extensionsRequired` must be an array",
        ),
        (
            "extensionsRequired",
            json!([3]),
            "must be an array of names",
        ),
    ];
    for (pointer, value, part) in cases {
        refused(with(pointer, value), &[part]);
    }
}

#[test]
fn huge_numbers_in_the_text_are_refused() {
    let text = Builder::empty()
        .json
        .to_string()
        .replace("\"2.0\"", "\"2.0\",\"x\":1e999");
    let error = load_bytes(text.as_bytes())
        .expect_err("1e999 is not finite")
        .to_string();
    assert!(error.contains("number out of range at line 1"), "{error}");
}

#[test]
fn required_extensions_must_be_supported() {
    let mut builder = Builder::square();
    builder.json["extensionsRequired"] =
        json!(["KHR_texture_transform", "KHR_draco_mesh_compression"]);
    refused(
        builder,
        &[
            "requires the extension KHR_draco_mesh_compression",
            "not supported",
            "export",
        ],
    );
}

#[test]
fn hierarchies_must_be_trees() {
    let nodes = |nodes: Value, roots: Value| {
        let mut builder = Builder::square();
        builder.json["nodes"] = nodes;
        builder.json["scenes"][0]["nodes"] = roots;
        builder
    };
    refused(
        nodes(json!([{"children": [0]}]), json!([0])),
        &["node 0: it is its own descendant"],
    );
    refused(
        nodes(
            json!([{}, {"children": [2]}, {"children": [1]}]),
            json!([0]),
        ),
        &["node 1: it is its own descendant"],
    );
    refused(
        nodes(
            json!([{"children": [2]}, {"children": [2]}, {}]),
            json!([0]),
        ),
        &["node 2: it is a child of node 0 and of node 1"],
    );
    refused(
        nodes(json!([{"children": [1, 1]}, {}]), json!([0])),
        &["node 1: it is a child of node 0 and of node 0"],
    );
    refused(
        nodes(json!([{}]), json!([0, 0])),
        &["node 0: the scene lists it although"],
    );
    refused(
        nodes(json!([{"children": [1]}, {}]), json!([0, 1])),
        &["node 1: the scene lists it although"],
    );
}

#[test]
fn transforms_must_stay_finite() {
    let mut builder = Builder::square();
    builder.json["nodes"] = json!([
        {"scale": [1e200, 1, 1], "children": [1]},
        {"name": "deep", "scale": [1e200, 1, 1]},
    ]);
    refused(builder, &["node 1 \"deep\": its transform is not finite"]);
}

#[test]
fn indices_must_be_in_range() {
    let indexed = |bytes: &[u8], component, count| {
        let mut builder = Builder::square();
        let indices = builder.accessor(bytes, component, "SCALAR", count);
        builder.json["meshes"][0]["primitives"][0]["indices"] = json!(indices);
        builder
    };
    refused(
        indexed(&[0, 1, 2, 0, 2, 4], U8, 6),
        &["mesh 0 \"square\", primitive 0: index 5 of 6 refers to vertex 4, but it has 4 vertices"],
    );
    for (bytes, component) in [
        (vec![0, 1, 255], U8),
        (shorts(&[0, 1, 65535]), U16),
        (words(&[0, 1, u32::MAX]), U32),
    ] {
        refused(
            indexed(&bytes, component, 3),
            &["index 2 of 3", "primitive restart"],
        );
    }
}

#[test]
fn attributes_must_have_one_length() {
    let mut builder = Builder::square();
    let normals = builder.accessor(&floats(&[0.0; 9]), F32, "VEC3", 3);
    builder.attribute("NORMAL", normals);
    refused(
        builder,
        &["primitive 0: attribute \"NORMAL\" has 3 elements, but POSITION has 4"],
    );
}

#[test]
fn sparse_accessors_are_checked() {
    let sparse = |sparse: Value| {
        let mut builder = Builder::square();
        builder.view(&[3, 0]);
        builder.view(&floats(&[1.0, 2.0, 3.0]));
        builder.json["accessors"][0]["sparse"] = sparse;
        builder
    };
    let good = json!({"count": 1, "indices": {"bufferView": 2, "componentType": 5121}, "values": {"bufferView": 3}});
    assert!(sparse(good.clone()).load().is_ok());
    let change = |pointer: &str, value: Value| {
        let mut changed = good.clone();
        set(&mut changed, pointer, value);
        sparse(changed)
    };
    refused(
        change("count", json!(5)),
        &["accessor 0, sparse: it replaces 5 elements, but the accessor has 4"],
    );
    refused(
        change("count", json!(4)),
        &["accessor 0, sparse, indices", "do not fit"],
    );
    refused(change("indices", json!(null)), &["`indices` is missing"]);
    refused(
        change("values/bufferView", json!(null)),
        &["`bufferView` is missing"],
    );
    refused(
        change("indices/componentType", json!(5126)),
        &["`componentType` must be 5121, 5123 or 5125"],
    );
    let mut out_of_range = sparse(good);
    let at = out_of_range.bin.len() - 14;
    out_of_range.bin[at] = 4;
    refused(
        out_of_range,
        &["sparse index 0 is 4, but the accessor has 4 elements"],
    );
}

#[test]
fn lying_counts_allocate_nothing() {
    let mut builder = Builder::square();
    builder.json["accessors"][0] =
        json!({"componentType": F32, "type": "VEC3", "count": 4_000_000_000_u64});
    builder.json["meshes"][0]["primitives"][0]["indices"] = json!(null);
    refused(
        builder,
        &["accessor 0: it promises 4000000000 elements, but refers to no buffer view"],
    );
}

#[test]
fn buffers_must_be_there_and_long_enough() {
    let mut builder = Builder::square();
    let folder = TempDir::new().expect("a temporary folder");
    let mut load = |buffer: Value| {
        builder.json["buffers"] = json!([buffer]);
        let loaded = load_in(
            folder.path(),
            "scene.gltf",
            builder.json.to_string().as_bytes(),
        );
        loaded.expect_err("the buffer is wrong").to_string()
    };
    let length = 60;
    let error = load(json!({"name": "b", "byteLength": length, "uri": "absent.bin"}));
    assert!(
        error.contains("cannot read buffer 0 \"b\" (file \"absent.bin\"): "),
        "{error}"
    );
    let error = load(json!({"byteLength": length, "uri": "data:;base64,AAAA"}));
    assert!(
        error.contains("buffer 0: `byteLength` promises 60 bytes, but there are only 3"),
        "{error}"
    );
    let error = load(json!({"byteLength": length, "uri": "data:;base64,A*AA"}));
    assert!(error.contains("is not valid base64"), "{error}");
    let error = load(json!({"byteLength": length}));
    assert!(
        error.contains("it needs buffer 0, which has neither a URI nor a binary chunk"),
        "{error}"
    );
    for uri in [
        "../up.bin",
        "/etc/passwd",
        "a/../../up.bin",
        "%2e%2e/up.bin",
        "http://a/b.bin",
        "file:///etc/passwd",
        "C:\\b.bin",
        "//host/b",
        "",
        ".",
        "a%00b",
    ] {
        let error = load(json!({"byteLength": length, "uri": uri}));
        assert!(error.contains("buffer 0: the URI "), "{uri}: {error}");
    }
}

#[cfg(unix)]
#[test]
fn symlinks_and_devices_do_not_lead_outside() {
    let outside = TempDir::new().expect("a temporary folder");
    std::fs::write(outside.path().join("secret.bin"), [0; 100]).expect("writable");
    let folder = TempDir::new().expect("a temporary folder");
    std::os::unix::fs::symlink(outside.path(), folder.path().join("link")).expect("a link");
    std::os::unix::fs::symlink("/dev/zero", folder.path().join("zero.bin")).expect("a link");
    std::fs::create_dir(folder.path().join("folder.bin")).expect("a folder");
    let mut builder = Builder::square();
    for (uri, part) in [
        ("link/secret.bin", "leaves the scene's folder"),
        ("zero.bin", "leaves the scene's folder"),
        ("folder.bin", "does not name a regular file"),
    ] {
        builder.json["buffers"] = json!([{"byteLength": 60, "uri": uri}]);
        let loaded = load_in(
            folder.path(),
            "scene.gltf",
            builder.json.to_string().as_bytes(),
        );
        let error = loaded.expect_err("it must not be read").to_string();
        assert!(error.contains(part), "{error}");
    }
}

#[test]
fn images_must_decode() {
    let image = |bytes: &[u8]| {
        let mut builder = Builder::textured();
        let view = builder.view(bytes);
        builder.json["images"][0]["bufferView"] = json!(view);
        builder
    };
    let subject = "image 0 \"checks\" of texture 0: ";
    refused(
        image(b"RIFF\0\0\0\0WEBPVP8 "),
        &[subject, "found a WebP image; convert it"],
    );
    refused(
        image(b"\xABKTX 20\xBB\r\n\x1A\n"),
        &[subject, "found a KTX texture"],
    );
    refused(image(b"what"), &[subject, "found something else"]);
    let png = png_rgba8();
    refused(image(&png[..40]), &[subject, "the PNG cannot be decoded"]);
    let jpeg = jpeg_gray();
    refused(image(&jpeg[..20]), &[subject, "the JPEG cannot be decoded"]);
}

#[test]
fn gigantic_image_headers_allocate_nothing() {
    let mut png = png_rgba8();
    png[16..24].copy_from_slice(&[0, 0, 0x3F, 0xFF, 0, 0, 0x3F, 0xFF]);
    let crc = crc32(&png[12..29]);
    png[29..33].copy_from_slice(&crc.to_be_bytes());
    let mut builder = Builder::textured();
    let view = builder.view(&png);
    builder.json["images"][0]["bufferView"] = json!(view);
    refused(
        builder,
        &["its header promises 16383 × 16383 pixels, more than its"],
    );
}

/// CRC-32 as PNG has it.
fn crc32(bytes: &[u8]) -> u32 {
    let step = |crc: u32, _| {
        if crc & 1 == 1 {
            crc >> 1 ^ 0xEDB8_8320
        } else {
            crc >> 1
        }
    };
    !bytes
        .iter()
        .fold(!0, |crc, &byte| (0..8).fold(crc ^ u32::from(byte), step))
}

#[test]
fn textures_of_unsupported_extensions_say_so() {
    let mut builder = Builder::textured();
    builder.json["textures"] = json!([{"extensions": {"KHR_texture_basisu": {"source": 0}}}]);
    refused(
        builder,
        &[
            "texture 0: its image needs the extension KHR_texture_basisu",
            "PNG or JPEG",
        ],
    );
}

#[test]
fn containers_must_be_whole() {
    let refused = |bytes: &[u8], part: &str| {
        let error = load_bytes(bytes).expect_err("it is damaged").to_string();
        assert!(error.contains(part), "{error}");
    };
    let glb = Builder::square().glb();
    refused(b"", "not a glTF file");
    refused(b"solid cube", "not a glTF file");
    refused(
        b"{\"asset\":",
        "the JSON is malformed: EOF while parsing a value at line 1",
    );
    refused(b"{} trailing", "trailing characters");
    refused(b"{}", "`asset` is missing");
    refused(&glb[..10], "the GLB header is cut off");
    refused(&glb[..glb.len() - 1], "the GLB header promises");
    let change = |at: usize, byte: u8| {
        let mut bytes = glb.clone();
        bytes[at] = byte;
        bytes
    };
    refused(&change(4, 1), "the GLB container has version 1, expected 2");
    refused(&change(16, b'X'), "the first GLB chunk must be JSON");
    refused(&change(15, 0x7F), "GLB chunk 0 promises");
    let deep = "[".repeat(100_000);
    refused(
        format!("{{\"a\":{deep}").as_bytes(),
        "recursion limit exceeded",
    );
}

#[test]
fn unknown_scenes_list_the_known_ones() {
    let mut builder = Builder::square();
    builder.json["scenes"] = json!([{"name": "day", "nodes": [0]}, {"name": "night", "nodes": []}]);
    let folder = TempDir::new().expect("a temporary folder");
    let path = folder.path().join("scene.glb");
    std::fs::write(&path, builder.glb()).expect("writable");
    let open = |scene: &str| {
        let Ok(scene) = scene.parse();
        load(&path, &LoadOptions { scene: Some(scene) })
    };
    assert_eq!(open("night").expect("it exists").scene_index, 1);
    assert_eq!(open("0").expect("it exists").scene_index, 0);
    let error = open("dusk").expect_err("no such scene").to_string();
    assert!(
        error.ends_with("there is no scene \"dusk\"; choose one of 0 \"day\", 1 \"night\""),
        "{error}"
    );
}

#[test]
fn files_must_be_readable() {
    let folder = TempDir::new().expect("a temporary folder");
    let error = load(folder.path(), &LoadOptions::default())
        .expect_err("a folder")
        .to_string();
    assert!(error.contains("it is a folder"), "{error}");
    let error = load(&folder.path().join("none.glb"), &LoadOptions::default());
    assert!(
        error
            .expect_err("absent")
            .to_string()
            .contains("none.glb: cannot read the file")
    );
}
