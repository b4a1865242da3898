//! KTX 2.0 and WebP: `images/` holds small files, and beside each what another decoder made of it.
//!
//! The KTX2 files were written and decoded by Basis Universal 2.10, the WebP files by libwebp 1.6 (through Pillow).
//! `uastc_rgb.ktx2` is such a file without its Zstandard and smaller levels.

use std::fs;
use std::path::{Path, PathBuf};

use etendue::scene::Texels;
use serde_json::json;

use crate::common::*;
use crate::mutate::{Random, mutate_bytes};

fn path(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/gltf/images");
    folder.join(name)
}

/// The bytes of a file in `images/`.
pub fn file(name: &str) -> Vec<u8> {
    fs::read(path(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// The textured square, its texture an image of these bytes that an extension names.
pub fn with_image(bytes: &[u8], extension: &str) -> Builder {
    let mut builder = Builder::textured();
    let view = builder.view(bytes);
    let image = builder.push("images", json!({"name": "picture", "bufferView": view}));
    builder.json["textures"] = json!([{"extensions": {extension: {"source": image}}}]);
    builder.json["extensionsUsed"] = json!([extension]);
    builder.json["extensionsRequired"] = json!([extension]);
    builder
}

fn ktx2(bytes: &[u8]) -> Builder {
    with_image(bytes, "KHR_texture_basisu")
}

fn webp(bytes: &[u8]) -> Builder {
    with_image(bytes, "EXT_texture_webp")
}

/// Size and pixels of the only image.
fn pixels(builder: &Builder) -> ([u32; 2], Vec<[u8; 4]>) {
    let scene = builder.scene();
    silent(&scene);
    let image = &scene.images[0];
    match &image.texels {
        Texels::Rgba8(texels) => ([image.width, image.height], texels.clone()),
        Texels::Rgba16(_) => panic!("8 bits are expected"),
    }
}

fn reference(name: &str) -> ([u32; 2], Vec<[u8; 4]>) {
    let picture = image::load_from_memory(&file(name))
        .expect("a PNG")
        .into_rgba8();
    let size = [picture.width(), picture.height()];
    (size, picture.pixels().map(|pixel| pixel.0).collect())
}

/// Largest difference in any channel.
fn difference(a: &[[u8; 4]], b: &[[u8; 4]]) -> u8 {
    let channels = a.as_flattened().iter().zip(b.as_flattened());
    channels.map(|(a, b)| a.abs_diff(*b)).max().unwrap_or(0)
}

#[test]
fn basis_universal_is_decoded_as_by_its_authors() {
    for name in ["etc1s_rgb", "etc1s_rgba", "uastc_rgb", "uastc_rgba_zstd"] {
        let found = pixels(&ktx2(&file(&format!("{name}.ktx2"))));
        let expected = reference(&format!("{name}.png"));
        assert_eq!(found.0, expected.0, "{name}");
        assert_eq!(difference(&found.1, &expected.1), 0, "{name}");
    }
}

#[test]
fn webp_is_decoded_as_by_its_authors() {
    for name in ["lossy", "lossy_alpha", "lossless", "lossless_alpha"] {
        let found = pixels(&webp(&file(&format!("{name}.webp"))));
        let expected = reference(&format!("{name}.png"));
        assert_eq!(found.0, expected.0, "{name}");
        assert_eq!(difference(&found.1, &expected.1), 0, "{name}");
    }
}

#[test]
fn an_extension_s_image_goes_before_the_plain_one() {
    for (name, extension) in [
        ("uastc_rgb.ktx2", "KHR_texture_basisu"),
        ("lossless.webp", "EXT_texture_webp"),
    ] {
        let mut builder = with_image(&file(name), extension);
        builder.json["textures"][0]["source"] = json!(0);
        let scene = builder.scene();
        assert_eq!(scene.images[0].name, "picture", "{extension}");
        // The plain one is never looked at.
        builder.json["images"][0] = json!({"uri": "absent.png"});
        assert_eq!(builder.scene().images.len(), 1);
        builder.json["textures"][0]["extensions"][extension] = json!({});
        refused(builder, &["texture 0", extension, "`source` is missing"]);
    }
}

#[test]
fn formats_that_need_an_extension_are_shown_without_it_with_a_warning() {
    let mut builder = webp(&file("lossless.webp"));
    builder.json["textures"] = json!([{"source": 1}]);
    let scene = builder.scene();
    assert_eq!(scene.images[0].width, 32);
    warned(
        &scene,
        "image 1 \"picture\" of texture 0: glTF allows its format only through EXT_texture_webp",
    );
}

#[test]
fn a_transfer_function_that_no_slot_reads_is_worth_a_warning() {
    let linear = "image 1 \"picture\" of texture 0: its transfer function is linear, but a material reads it as colours";
    let builder = ktx2(&file("uastc_linear.ktx2"));
    let scene = builder.scene();
    warned(&scene, linear);
    assert_eq!((scene.images[0].width, scene.images[0].height), (20, 12));
    let mut as_data = builder.clone();
    as_data.json["materials"][0] =
        json!({"pbrMetallicRoughness": {"metallicRoughnessTexture": {"index": 0}}});
    assert_eq!(pixels(&as_data), reference("uastc_linear.png"));
    let mut srgb = ktx2(&file("uastc_rgb.ktx2"));
    srgb.json["materials"][0] = as_data.json["materials"][0].clone();
    warned(
        &srgb.scene(),
        "its transfer function is sRGB, but a material reads it as numbers",
    );
    // Alpha alone is linear whatever the colours are.
    srgb.json["materials"][0] = json!({"pbrMetallicRoughness": {"metallicFactor": 0}, "extensions": {
        "KHR_materials_specular": {"specularTexture": {"index": 0}},
    }});
    srgb.json["extensionsUsed"] = json!(["KHR_texture_basisu", "KHR_materials_specular"]);
    silent(&srgb.scene());
}

/// A KTX2 file of 2 × 2 plain pixels.
fn plain(format: u32, level: &[u8], pairs: &[(&str, &str)]) -> Vec<u8> {
    let mut bytes = b"\xABKTX 20\xBB\r\n\x1A\n".to_vec();
    let mut data = Vec::new();
    for (name, value) in pairs {
        let pair = format!("{name}\0{value}\0").into_bytes();
        data.extend(words(&[pair.len() as u32]));
        data.extend(&pair);
        data.resize(data.len().next_multiple_of(4), 0);
    }
    let (descriptor, length) = (104, 28 + 16);
    let level_at = descriptor + length + data.len() as u32;
    bytes.extend(words(&[format, 1, 2, 2, 0, 0, 1, 1, 0]));
    bytes.extend(words(&[
        descriptor,
        length,
        descriptor + length,
        data.len() as u32,
    ]));
    bytes.extend([0; 16]);
    bytes.extend(
        [u64::from(level_at), level.len() as u64, level.len() as u64]
            .map(u64::to_le_bytes)
            .concat(),
    );
    // Model RGBSDA, Rec. 709, sRGB.
    bytes.extend(words(&[
        length,
        0,
        0x0028_0002,
        0x0002_0101,
        0,
        4,
        0,
        0,
        0,
        0,
        0,
    ]));
    bytes.extend(data);
    bytes.extend(level);
    bytes
}

#[test]
fn plain_pixels_and_swizzles_are_read() {
    let level = [1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12];
    let (size, found) = pixels(&ktx2(&plain(29, &level, &[])));
    assert_eq!(size, [2, 2]);
    assert_eq!(
        found,
        [
            [1, 2, 3, 255],
            [4, 5, 6, 255],
            [7, 8, 9, 255],
            [10, 11, 12, 255]
        ]
    );
    let grey = plain(
        15,
        &[9, 8, 7, 6],
        &[("KTXorientation", "rd"), ("KTXswizzle", "rrr1")],
    );
    assert_eq!(pixels(&ktx2(&grey)).1, [9, 8, 7, 6].map(|c| [c, c, c, 255]));
}

#[test]
fn ktx2_files_that_are_wrong_are_refused_by_name() {
    let subject = "image 1 \"picture\" of texture 0: ";
    let level = [0; 12];
    let says = |bytes: &[u8], part: &str| refused(ktx2(bytes), &[subject, part]);
    let with = |at: usize, word: u32| {
        let mut bytes = plain(29, &level, &[]);
        bytes[at..at + 4].copy_from_slice(&word.to_le_bytes());
        bytes
    };
    says(&with(12, 91), "its pixels are of VkFormat 91");
    says(&with(12, 0), "colour model 1");
    says(&with(20, 0), "it is 0 × 2 pixels");
    says(
        &with(20, 1 << 26),
        "its header promises 67108864 × 2 pixels",
    );
    says(
        &with(20, 1 << 20),
        "its level has 12 bytes, expected 6291456",
    );
    says(&with(28, 2), "depth");
    says(&with(32, 3), "layers");
    says(&with(36, 6), "faces");
    says(&with(40, 900), "its index of 900 levels is damaged");
    says(&with(44, 3), "packed with zlib");
    says(&with(44, 77), "unknown scheme 77");
    says(&with(44, 2), "it is no Zstandard frame");
    says(&with(48, 5000), "44 bytes from byte 5000 on do not fit");
    says(&with(80, u32::MAX), "do not fit");
    says(&with(104 + 12, 0x0007_0101), "its transfer function is 7");
    says(
        &plain(29, &level[1..], &[]),
        "its level has 11 bytes, expected 12",
    );
    says(
        &plain(29, &level, &[("KTXswizzle", "rgbx")]),
        "its KTXswizzle",
    );
    says(
        &plain(29, &level, &[("KTXorientation", "ru")]),
        "its KTXorientation is \"ru\"",
    );
    says(&plain(29, &level, &[])[..40], "it is cut off");
    let mut basis = file("uastc_rgba_zstd.ktx2");
    let descriptor = u32::from_le_bytes(basis[48..52].try_into().expect("a word")) as usize;
    basis[descriptor + 15] |= 1;
    says(&basis, "premultiplied");
    let mut basis = file("uastc_rgba_zstd.ktx2");
    basis[descriptor + 31] = 6;
    says(&basis, "its channels are of kinds [6]");
}

#[test]
fn webp_files_that_are_wrong_are_refused_by_name() {
    let subject = "image 1 \"picture\" of texture 0: ";
    refused(webp(&file("animated.webp")), &[subject, "animated"]);
    let lossy = file("lossy.webp");
    refused(webp(&lossy[..60]), &[subject, "the WebP cannot be decoded"]);
    // A frame of 16383 × 16383 in a picture of 32 × 32.
    let mut lying = file("lossy_alpha.webp");
    let frame = lying
        .windows(4)
        .position(|w| w == b"VP8 ")
        .expect("a frame");
    lying[frame + 14..frame + 18].copy_from_slice(&[0xFF, 0x3F, 0xFF, 0x3F]);
    refused(webp(&lying), &[subject, "its frame 16383 × 16383"]);
    // All of it promised by a few bytes.
    let mut huge = file("lossy.webp");
    let frame = huge.windows(4).position(|w| w == b"VP8 ").expect("a frame");
    huge[frame + 14..frame + 18].copy_from_slice(&[0xFF, 0x3F, 0xFF, 0x3F]);
    refused(
        webp(&huge),
        &[subject, "its header promises 16383 × 16383 pixels"],
    );
}

/// Whatever the bytes: pixels, or a sentence.
#[test]
fn mutated_images_never_panic() {
    let text = std::env::var("ETENDUE_FUZZ_CASES").ok();
    let cases: u64 = text.and_then(|text| text.parse().ok()).unwrap_or(2000);
    let names = [
        "etc1s_rgb.ktx2",
        "etc1s_rgba.ktx2",
        "uastc_rgb.ktx2",
        "uastc_rgba_zstd.ktx2",
        "lossy_alpha.webp",
        "lossless_alpha.webp",
    ];
    let seeds: Vec<Vec<u8>> = names.iter().map(|name| file(name)).collect();
    let mut loaded = 0;
    for case in 0..cases {
        let mut random = Random(case);
        let mut bytes = seeds[random.below(seeds.len())].clone();
        mutate_bytes(&mut bytes, &mut random);
        if random.below(8) == 0 {
            bytes.truncate(random.below(bytes.len() + 1));
        }
        match ktx2(&bytes).load() {
            Ok(scene) => {
                scene.validate().expect("a loaded scene is valid");
                loaded += 1;
            }
            Err(error) => {
                let sentence = error.to_string();
                let ok = sentence.contains("image 1 \"picture\" of texture 0: ")
                    && sentence.len() < 1000;
                assert!(ok, "case {case}: {sentence}");
            }
        }
    }
    println!("{loaded} of {cases} loaded");
    assert!(loaded > cases / 20 && loaded < cases, "{loaded}");
}
