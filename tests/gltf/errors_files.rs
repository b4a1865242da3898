//! Damaged containers, external files and images.

use etendue::scene::gltf::{LoadOptions, load};
use serde_json::{Value, json};
use tempfile::TempDir;

use crate::common::*;
use crate::pictures::*;

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
fn unknown_scenes_list_the_known_ones() {
    let mut builder = Builder::square();
    builder.json["scenes"] = json!([{"name": "day", "nodes": [0]}, {"name": "night", "nodes": []}]);
    let folder = TempDir::new().expect("a temporary folder");
    let path = folder.path().join("scene.glb");
    std::fs::write(&path, builder.glb()).expect("writable");
    let open = |scene: &str| {
        let Ok(scene) = scene.parse();
        load(
            &path,
            &LoadOptions {
                scene: Some(scene),
                ..LoadOptions::default()
            },
        )
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
