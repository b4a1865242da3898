//! Against the format's definition, and against crate `image` as the oracle.
#![allow(clippy::unwrap_used)] // A test that cannot set itself up has failed.

use std::io::Cursor;

use ::image::ImageDecoder;
use ::image::codecs::hdr::{HdrDecoder, HdrEncoder};

use super::*;

fn decode_bytes(bytes: &[u8]) -> Result<Texels, ImageError> {
    decode(Path::new("test.hdr"), bytes)
}

fn file(resolution: &str, texels: &[u8]) -> Vec<u8> {
    let mut bytes = format!("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n{resolution}\n").into_bytes();
    bytes.extend_from_slice(texels);
    bytes
}

/// A picture with runs and noise, over many binades.
pub(super) fn encoded(width: usize, height: usize) -> Vec<u8> {
    let texel = |i: usize| {
        let noise = (i as u32).wrapping_mul(2_654_435_761) >> 8;
        let scale = 2_f32.powi((i / width) as i32 % 60 - 30);
        let value = if i % 50 < 20 {
            1.0
        } else {
            noise as f32 / 65536.0
        };
        ::image::Rgb([value * scale, scale, 0.25 * value * scale])
    };
    let pixels: Vec<_> = (0..width * height).map(texel).collect();
    let mut bytes = Vec::new();
    HdrEncoder::new(&mut bytes)
        .encode(&pixels, width, height)
        .unwrap();
    bytes
}

#[test]
fn values_are_mantissa_times_power_of_two() {
    assert_eq!(scanline::to_rgb([128, 64, 0, 129]), [1.0, 0.5, 0.0]);
    assert_eq!(scanline::to_rgb([255, 255, 255, 0]), [0.0; 3]);
    assert_eq!(scanline::to_rgb([1, 0, 0, 1])[0], 2_f32.powi(-135));
    assert_eq!(
        scanline::to_rgb([255, 0, 0, 255])[0],
        255.0 * 2_f32.powi(119)
    );
}

#[test]
fn agrees_with_another_decoder_bit_for_bit() {
    for (width, height) in [(7, 3), (8, 1), (200, 61), (1000, 3)] {
        let bytes = encoded(width, height);
        let other = HdrDecoder::new(Cursor::new(&bytes)).unwrap();
        let mut expected = vec![0; other.total_bytes() as usize];
        other.read_image(&mut expected).unwrap();
        let (w, h, texels) = decode_bytes(&bytes).unwrap();
        assert_eq!((w, h), (width, height));
        let got: Vec<u8> = bytemuck::cast_slice(&texels).to_vec();
        assert_eq!(got, expected);
    }
}

#[test]
fn turned_pictures_are_set_upright() {
    // Texels 1 to 6 by their red mantissa, in the order of the file.
    let texels: Vec<u8> = (1..=6).flat_map(|r| [r, 0, 0, 136]).collect();
    let reds = |resolution: &str| {
        let (width, height, texels) = decode_bytes(&file(resolution, &texels)).unwrap();
        let reds: Vec<f32> = texels.iter().map(|t| t[0]).collect();
        (width, height, reds)
    };
    let expected = |r: [i32; 6]| r.map(|r| r as f32).to_vec();
    assert_eq!(reds("-Y 2 +X 3"), (3, 2, expected([1, 2, 3, 4, 5, 6])));
    assert_eq!(reds("+Y 2 +X 3"), (3, 2, expected([4, 5, 6, 1, 2, 3])));
    assert_eq!(reds("-Y 2 -X 3"), (3, 2, expected([3, 2, 1, 6, 5, 4])));
    assert_eq!(reds("+Y 2 -X 3"), (3, 2, expected([6, 5, 4, 3, 2, 1])));
    assert_eq!(reds("+X 3 -Y 2"), (3, 2, expected([1, 3, 5, 2, 4, 6])));
    assert_eq!(reds("-X 3 +Y 2"), (3, 2, expected([6, 4, 2, 5, 3, 1])));
}

#[test]
fn old_runs_multiply() {
    let texels = [9, 0, 0, 136, 1, 1, 1, 2, 1, 1, 1, 1, 7, 0, 0, 136];
    let (_, _, texels) = decode_bytes(&file("-Y 1 +X 260", &texels)).unwrap();
    assert!(texels[..259].iter().all(|t| t[0] == 9.0));
    assert_eq!(texels[259][0], 7.0);
}

#[test]
fn mistakes_are_errors() {
    let wrong = [
        b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n".to_vec(),
        b"#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 1 +X 1\n\0\0\0\0".to_vec(),
        file("-Y 1", &[0; 4]),
        file("-Y 1 +Y 1", &[0; 4]),
        file("-Y 0 +X 1", &[0; 4]),
        file("-Y 4294967295 +X 4294967295", &[0; 4]),
        file("-Y 30000 +X 30000", &[0; 4]),
        file("-Y 1 +X 1", &[]),
        file("-Y 1 +X 4", &[1, 1, 1, 4]),
        file("-Y 1 +X 4", &[2, 0, 0, 136, 1, 1, 1, 9]),
        file("-Y 1 +X 9", &[2, 2, 0, 8, 137, 0, 137, 0, 137, 0, 137, 0]),
        file("-Y 1 +X 8", &[2, 2, 0, 8, 0, 0]),
        file("-Y 1 +X 8", &[2, 2, 0, 8, 140, 0]),
    ];
    for bytes in wrong {
        let error = decode_bytes(&bytes).unwrap_err();
        assert!(error.to_string().starts_with("test.hdr: "), "{error}");
    }
    // A chain of runs of nothing must neither overflow nor hang.
    let mut chain = vec![9, 0, 0, 136];
    chain.extend([1, 1, 1, 0].repeat(40));
    assert!(decode_bytes(&file("-Y 1 +X 9", &chain)).is_err());
}
