//! Containers, external files and images.

use etendue::scene::*;
use serde_json::json;

use crate::common::*;
use crate::pictures::*;

#[test]
fn both_forms_of_a_file_hold_the_same_scene() {
    let builder = Builder::textured();
    let glb = builder.scene();
    let folder = tempfile::TempDir::new().expect("a temporary folder");
    std::fs::create_dir(folder.path().join("a b")).expect("writable");
    std::fs::write(folder.path().join("a b/data.bin"), &builder.bin).expect("writable");
    let mut external = builder.json.clone();
    external["buffers"] = json!([{"uri": "a%20b/data.bin", "byteLength": builder.bin.len()}]);
    let text = format!("\u{FEFF}  {external}");
    let gltf = load_in(folder.path(), "scene.whatever", text.as_bytes()).expect("the same scene");
    assert_eq!(gltf.meshes[0].positions, glb.meshes[0].positions);
    assert_eq!(gltf.meshes[0].indices, [[0, 1, 2], [0, 2, 3]]);
    assert_eq!(gltf.meshes[0].name, "square");
    assert_eq!(gltf.instances[0].name, "node");
    silent(&gltf);
    // The hash covers the file and what it refers to.
    let mut hasher = blake3::Hasher::new();
    hasher.update(text.as_bytes()).update(&builder.bin);
    assert_eq!(gltf.hash, *hasher.finalize().as_bytes());
}

#[test]
fn data_uris_hold_buffers_and_images() {
    use base64::Engine;
    let mut builder = Builder::textured();
    let encode = |bytes: &[u8]| {
        format!(
            "data:application/gltf-buffer;base64,{}",
            base64::engine::general_purpose::STANDARD.encode(bytes)
        )
    };
    builder.json["images"] = json!([{"uri": encode(&png_rgba8())}]);
    builder.json["buffers"] =
        json!([{"uri": encode(&builder.bin), "byteLength": builder.bin.len()}]);
    let scene = load_bytes(builder.json.to_string().as_bytes()).expect("it is well-formed");
    assert_eq!(scene.triangle_count(), 2);
    assert_eq!((scene.images[0].width, scene.images[0].height), (2, 2));
}

#[test]
fn images_of_every_kind_are_decoded() {
    use image::ExtendedColorType as Color;
    let decode = |bytes: &[u8]| {
        let mut builder = Builder::textured();
        let view = builder.view(bytes);
        builder.json["images"][0]["bufferView"] = json!(view);
        builder.scene().images.remove(0)
    };
    let eight = |bytes: &[u8]| match decode(bytes).texels {
        Texels::Rgba8(texels) => texels,
        Texels::Rgba16(_) => panic!("8 bits were expected"),
    };
    let sixteen = |bytes: &[u8]| match decode(bytes).texels {
        Texels::Rgba16(texels) => texels,
        Texels::Rgba8(_) => panic!("16 bits were expected"),
    };
    assert_eq!(eight(&png(1, 1, Color::L8, &[7])), [[7, 7, 7, 255]]);
    assert_eq!(eight(&png(1, 1, Color::La8, &[7, 9])), [[7, 7, 7, 9]]);
    assert_eq!(eight(&png(1, 1, Color::Rgb8, &[1, 2, 3])), [[1, 2, 3, 255]]);
    assert_eq!(eight(&png_rgba8())[3], [255, 255, 255, 128]);
    let wide = |values: &[u16]| {
        values
            .iter()
            .flat_map(|v| v.to_ne_bytes())
            .collect::<Vec<u8>>()
    };
    assert_eq!(
        sixteen(&png(1, 1, Color::L16, &wide(&[777]))),
        [[777, 777, 777, 65535]]
    );
    assert_eq!(
        sixteen(&png(1, 1, Color::Rgb16, &wide(&[1, 2, 3]))),
        [[1, 2, 3, 65535]]
    );
    assert_eq!(
        sixteen(&png(1, 1, Color::Rgba16, &wide(&[1, 2, 3, 4]))),
        [[1, 2, 3, 4]]
    );
    let palette: [(&[u8; 4], &[u8]); 2] = [(b"PLTE", &[1, 2, 3, 4, 5, 6]), (b"tRNS", &[9])];
    let indexed = raw_png([2, 1], [1, 3, 0], &palette, &[0, 0b0100_0000]);
    assert_eq!(eight(&indexed), [[1, 2, 3, 9], [4, 5, 6, 255]]);
    // Adam7 on 2 × 2 pixels: the corner, its right neighbour, the second row.
    let interlaced = raw_png([2, 2], [8, 0, 1], &[], &[0, 1, 0, 2, 0, 3, 4]);
    let grey: Vec<u8> = eight(&interlaced).iter().map(|texel| texel[0]).collect();
    assert_eq!(grey, [1, 2, 3, 4]);
    assert_eq!(eight(&jpeg_rgb()).len(), 256);
    let jpeg = eight(&jpeg_gray());
    assert!(
        jpeg.len() == 64 && jpeg.iter().all(|t| t[0].abs_diff(100) <= 1 && t[3] == 255),
        "{jpeg:?}"
    );
}

#[test]
fn an_image_used_twice_is_decoded_once() {
    let mut builder = Builder::textured();
    builder.push("textures", json!({"source": 0, "sampler": 0}));
    builder.json["samplers"] = json!([{}]);
    let again = builder.json["images"][0].clone();
    builder.push("images", again);
    builder.push("textures", json!({"source": 1}));
    builder.json["materials"][0]["emissiveFactor"] = json!([1, 1, 1]);
    builder.json["materials"][0]["emissiveTexture"] = json!({"index": 1});
    builder.json["materials"][0]["pbrMetallicRoughness"]["metallicRoughnessTexture"] =
        json!({"index": 2});
    let scene = builder.scene();
    assert_eq!((scene.textures.len(), scene.images.len()), (3, 1));
}
