//! Broken picture files: an error that names the file, whatever the bytes; never a
//! panic, never memory that the file cannot back.
//!
//! `ETENDUE_MUTATIONS` sets the number of cases for each kind of file.
#![allow(clippy::unwrap_used)] // A test that cannot set itself up has failed.

use std::path::Path;

use etendue::image::{Metadata, Picture, exr, read_rgb};

/// SplitMix64 (Steele, Lea, Flood 2014).
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    fn below(&mut self, n: usize) -> usize {
        (self.next() % n.max(1) as u64) as usize
    }
}

fn cases() -> usize {
    let set = std::env::var("ETENDUE_MUTATIONS").ok();
    set.and_then(|n| n.parse().ok()).unwrap_or(1000)
}

/// One to four changes, most of them in the header, where they matter most.
fn mutate(bytes: &mut Vec<u8>, random: &mut Random, header: usize) {
    for _ in 0..=random.below(4) {
        let in_header = random.below(4) > 0;
        let end = if in_header { header } else { bytes.len() };
        let at = random.below(end.min(bytes.len()));
        match random.below(6) {
            0 if random.below(4) == 0 => bytes.truncate(at),
            1 if at < bytes.len() => bytes[at] ^= 1 << random.below(8),
            2 if at < bytes.len() => bytes[at] = random.next() as u8,
            3 if at < bytes.len() => drop(bytes.remove(at)),
            4 => bytes.insert(at, random.next() as u8),
            // A count, a size or a coordinate that lies.
            _ if at + 4 <= bytes.len() => {
                let lies = [0, 1, -1, i32::MAX, i32::MIN, 1 << 30, 65536, -2];
                let lie = lies[random.below(lies.len())];
                bytes[at..at + 4].copy_from_slice(&lie.to_le_bytes());
            }
            _ => {}
        }
    }
}

fn read_all(path: &Path) {
    if let Err(error) = exr::read(path) {
        let name = path.to_str().unwrap();
        assert!(error.to_string().starts_with(name), "{error}");
    }
    if let Ok(map) = read_rgb(path) {
        assert_eq!(map.texels.len(), map.width * map.height);
        let mut components = map.texels.iter().flatten();
        assert!(components.all(|c| c.is_finite() && *c >= 0.0));
    }
}

fn run(seed: u64, original: &[u8], header: usize) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("broken");
    let mut random = Random(seed);
    for _ in 0..cases() {
        let mut bytes = original.to_vec();
        mutate(&mut bytes, &mut random, header);
        std::fs::write(&path, &bytes).unwrap();
        read_all(&path);
    }
}

fn small_exr(folder: &Path) -> Vec<u8> {
    let path = folder.join("small.exr");
    let samples: Vec<f32> = (0..8 * 20 * 3_u16).map(|i| f32::from(i % 7)).collect();
    let picture = Picture::new(8, 20)
        .with_rgb("", &samples)
        .with_rgb("albedo", &samples);
    let metadata = Metadata([("etendue.spp".to_owned(), "64".to_owned())].into());
    exr::write(&path, &picture, &metadata).unwrap();
    std::fs::read(path).unwrap()
}

#[test]
fn mutated_exr() {
    let folder = tempfile::tempdir().unwrap();
    run(1, &small_exr(folder.path()), 700);
}

/// Tiles, two parts and other compressions, as other programs write them.
#[test]
fn mutated_exr_of_tiles_and_parts() {
    use ::exr::prelude as e;
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("tiles.exr");
    for compression in [
        e::Compression::PIZ,
        e::Compression::B44,
        e::Compression::PXR24,
    ] {
        let encoding = e::Encoding {
            compression,
            blocks: e::Blocks::Tiles(e::Vec2(16, 16)),
            line_order: e::LineOrder::Increasing,
        };
        let part = |name: &str| {
            let samples = (0..64 * 4_u16)
                .map(|i| e::f16::from_f32(i.into()))
                .collect();
            let channel = e::AnyChannel::new("R", e::FlatSamples::F16(samples));
            let channels = e::AnyChannels::sort([channel].into_iter().collect());
            e::Layer::new((64, 4), e::LayerAttributes::named(name), encoding, channels)
        };
        let bounds = e::IntegerBounds::from_dimensions((64, 4));
        let layers = vec![part("one"), part("two")];
        let image = e::Image::from_layers(e::ImageAttributes::new(bounds), layers);
        e::WritableImage::write(&image).to_file(&path).unwrap();
        run(2, &std::fs::read(&path).unwrap(), 900);
    }
}

#[test]
fn mutated_hdr() {
    let mut bytes = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 3 +X 40\n".to_vec();
    for row in 0..3_u8 {
        bytes.extend([2, 2, 0, 40]);
        for component in 0..4_u8 {
            bytes.extend([128 + 30, component + row, 10]);
            bytes.extend(0..10);
        }
    }
    run(3, &bytes, 60);
    let mut old = b"#?RGBE\n\n+X 3 -Y 300\n".to_vec();
    old.extend([9, 8, 7, 130, 1, 1, 1, 43, 1, 1, 1, 1].repeat(3));
    run(4, &old, 40);
}

/// Cut anywhere, a file is an error: no part of a picture passes for the whole.
#[test]
fn truncated_files_are_errors() {
    let folder = tempfile::tempdir().unwrap();
    let bytes = small_exr(folder.path());
    let path = folder.path().join("cut.exr");
    for end in 0..bytes.len() {
        std::fs::write(&path, &bytes[..end]).unwrap();
        assert!(exr::read(&path).is_err(), "{end} of {} bytes", bytes.len());
    }
}

/// Two entries of the table that point at one block would leave black rows.
#[test]
fn a_block_that_is_missing_is_an_error() {
    let folder = tempfile::tempdir().unwrap();
    let bytes = small_exr(folder.path());
    let offset = |at: usize| u64::from_le_bytes(bytes[at..at + 8].try_into().unwrap());
    // 20 rows are two blocks: find the table of two, which the first block follows.
    let is_table = |&at: &usize| {
        let (first, second) = (offset(at), offset(at + 8));
        first == at as u64 + 16 && second > first && second < bytes.len() as u64
    };
    let table = (0..bytes.len() - 16).find(is_table).unwrap();
    let path = folder.path().join("gap.exr");
    for value in [offset(table), 0] {
        let mut broken = bytes.clone();
        broken[table + 8..table + 16].copy_from_slice(&value.to_le_bytes());
        std::fs::write(&path, &broken).unwrap();
        let error = exr::read(&path).unwrap_err().to_string();
        assert!(error.contains("block"), "{error}");
    }
}

/// A header that claims terabytes must cost nothing.
#[test]
fn a_lying_header_is_refused_before_memory_is_taken() {
    let folder = tempfile::tempdir().unwrap();
    let mut bytes = small_exr(folder.path());
    let name = b"dataWindow\0box2i\0\x10\0\0\0";
    let start = bytes.windows(name.len()).position(|w| w == name).unwrap();
    let at = start + name.len();
    let path = folder.path().join("huge.exr");
    let lies = [
        (1 << 20, 1 << 20),
        (i32::MAX / 4, 19),
        (7, i32::MAX / 4),
        (40_000, 40_000),
    ];
    for (x, y) in lies {
        bytes[at + 8..at + 12].copy_from_slice(&i32::to_le_bytes(x));
        bytes[at + 12..at + 16].copy_from_slice(&i32::to_le_bytes(y));
        std::fs::write(&path, &bytes).unwrap();
        let error = exr::read(&path).unwrap_err();
        let is_size = matches!(error, etendue::image::ImageError::TooLarge { .. });
        assert!(is_size, "{error}");
    }
}
