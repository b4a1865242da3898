//! OpenEXR files: lossless there and back, and readable in every shape that others write.
#![allow(clippy::unwrap_used)] // A test that cannot set itself up has failed.

use std::path::Path;

use etendue::image::{self, Channel, ImageError, Layer, Metadata, Picture, read_rgb};
use exr::prelude::{
    AnyChannel, AnyChannels, Blocks, Compression, Encoding, FlatSamples, Image, ImageAttributes,
    IntegerBounds, LayerAttributes, LineOrder, MetaData, SampleType, Vec2, WritableImage, f16,
};

fn channel(name: &str, samples: Vec<f32>) -> Channel {
    let name = name.to_owned();
    Channel { name, samples }
}

/// Floats of every kind but NaN.
fn samples(count: usize, seed: u32) -> Vec<f32> {
    let special = [
        0.0,
        -0.0,
        1e-42,
        f32::MAX,
        f32::INFINITY,
        f32::NEG_INFINITY,
        1.0 / 3.0,
    ];
    let scattered = (0..count as u32).map(|i| {
        let bits = i.wrapping_add(seed).wrapping_mul(2_654_435_761);
        let value = f32::from_bits(bits);
        if value.is_nan() { 1.5 } else { value }
    });
    special.into_iter().chain(scattered).take(count).collect()
}

fn picture(width: usize, height: usize) -> Picture {
    let mut picture = Picture::new(width, height);
    for (index, name) in ["", "albedo", "light.direct"].iter().enumerate() {
        let seed = 1000 * index as u32;
        let channels = ["R", "G", "B"]
            .iter()
            .zip(seed..)
            .map(|(n, seed)| channel(n, samples(width * height, seed)));
        picture.layers.push(Layer {
            name: (*name).into(),
            channels: channels.collect(),
        });
    }
    let extra = |name| channel(name, samples(width * height, 77));
    picture.layers[0].channels.push(extra("A"));
    picture.layers[1].channels.push(extra("id"));
    picture
}

fn metadata() -> Metadata {
    let entries = [
        ("software", "etendue 0.1.0"),
        ("comments", ""),
        ("etendue.scene_hash", "0123abcd"),
        ("etendue.command", "etendue render \"a b.gltf\" -o é.exr\n"),
        (
            "a name of more than thirty-one bytes, which needs long names",
            "x",
        ),
    ];
    Metadata(entries.map(|(k, v)| (k.into(), v.into())).into())
}

fn bits(picture: &Picture) -> Vec<Vec<u32>> {
    let channels = picture.layers.iter().flat_map(|layer| &layer.channels);
    channels
        .map(|c| c.samples.iter().map(|s| s.to_bits()).collect())
        .collect()
}

#[test]
fn there_and_back_bit_for_bit() {
    let folder = tempfile::tempdir().unwrap();
    for (width, height) in [(1, 1), (37, 53), (16, 16), (1000, 1)] {
        let path = folder.path().join(format!("{width}x{height}.exr"));
        let written = picture(width, height);
        image::exr::write(&path, &written, &metadata()).unwrap();
        let (read, texts) = image::exr::read(&path).unwrap();
        assert_eq!(read.channel_names(), written.channel_names());
        assert_eq!(bits(&read), bits(&written));
        assert_eq!(texts, metadata());
    }
}

#[test]
fn a_nan_stays_a_nan() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("nan.exr");
    let written = Picture::new(1, 1).with_rgb("", &[f32::NAN, 1.0, 2.0]);
    image::exr::write(&path, &written, &Metadata::default()).unwrap();
    let (read, _) = image::exr::read(&path).unwrap();
    let samples = read.interleaved_rgb("").unwrap();
    assert!(samples[0].is_nan() && samples[1..] == [1.0, 2.0]);
}

#[test]
fn the_file_is_one_part_of_scan_lines_in_zip() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.exr");
    image::exr::write(&path, &picture(20, 40), &metadata()).unwrap();
    let meta = MetaData::read_from_file(&path, true).unwrap();
    assert_eq!(meta.headers.len(), 1);
    let header = &meta.headers[0];
    assert_eq!(header.compression, Compression::ZIP16);
    assert!(!header.blocks.has_tiles());
    let channels = &header.channels.list;
    assert!(channels.iter().all(|c| c.sample_type == SampleType::F32));
    let names: Vec<String> = channels.iter().map(|c| c.name.to_string()).collect();
    assert!(names.is_sorted() && names.contains(&"light.direct.R".to_owned()));
}

/// Writes with crate `exr` directly, as another program would: 4 × 2 pixels.
fn write_other(path: &Path, encoding: Encoding, parts: &[(&str, &[(&str, FlatSamples)])]) {
    let part = |(name, channels): &(&str, &[(&str, FlatSamples)])| {
        let stored = channels
            .iter()
            .map(|(name, samples)| AnyChannel::new(*name, samples.clone()));
        let attributes = match *name {
            "" => LayerAttributes::default(),
            name => LayerAttributes::named(name),
        };
        let channels = AnyChannels::sort(stored.collect());
        exr::image::Layer::new((4, 2), attributes, encoding, channels)
    };
    let bounds = IntegerBounds::from_dimensions((4, 2));
    let layers: Vec<_> = parts.iter().map(part).collect();
    let image = Image::from_layers(ImageAttributes::new(bounds), layers);
    image.write().to_file(path).unwrap();
}

fn ramp() -> Vec<f32> {
    (0..8_u8).map(|i| f32::from(i) * 0.5).collect()
}

#[test]
fn every_sample_type_compression_and_tiling_is_read() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("other.exr");
    let channels = [
        (
            "R",
            FlatSamples::F16(ramp().into_iter().map(f16::from_f32).collect()),
        ),
        ("G", FlatSamples::F32(ramp())),
        ("id", FlatSamples::U32((0..8).map(|i| i * 1000).collect())),
    ];
    let compressions = [
        Compression::Uncompressed,
        Compression::RLE,
        Compression::ZIP1,
        Compression::ZIP16,
        Compression::PIZ,
        Compression::PXR24,
        Compression::B44,
    ];
    let line_order = LineOrder::Increasing;
    for compression in compressions {
        for blocks in [Blocks::ScanLines, Blocks::Tiles(Vec2(3, 2))] {
            let encoding = Encoding {
                compression,
                blocks,
                line_order,
            };
            write_other(&path, encoding, &[("", &channels)]);
            let (picture, _) = image::exr::read(&path).unwrap();
            assert_eq!(picture.channel_names(), ["R", "G", "id"]);
            let samples = |i: usize| &picture.layers[0].channels[i].samples;
            assert_eq!(samples(1), &ramp(), "{compression}");
            let integers: Vec<f32> = (0..8_u16).map(|i| f32::from(i * 1000)).collect();
            assert_eq!(samples(2), &integers, "{compression}");
            if compression != Compression::B44 {
                assert_eq!(samples(0), &ramp(), "{compression}");
            }
        }
    }
}

#[test]
fn parts_become_layers() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("parts.exr");
    let float = FlatSamples::F32(ramp());
    let rgb = ["R", "G", "B"].map(|n| (n, float.clone()));
    let dotted = [("depth.Z", float.clone()), ("other.Z", float.clone())];
    let encoding = Encoding::SMALL_LOSSLESS;
    write_other(&path, encoding, &[("beauty", &rgb), ("depth", &dotted)]);
    let (picture, _) = image::exr::read(&path).unwrap();
    let names: Vec<_> = picture.layers.iter().map(|l| l.name.as_str()).collect();
    assert_eq!(names, ["beauty", "depth", "depth.other"]);
    // Without a main layer the first with colour is the picture.
    assert_eq!(read_rgb(&path).unwrap().texels[3], [1.5; 3]);
}

/// A picture of 2 × 2 pixels with these layers.
fn with(layers: Vec<(&str, Vec<Channel>)>) -> Picture {
    let mut picture = Picture::new(2, 2);
    for (name, channels) in layers {
        let name = name.to_owned();
        picture.layers.push(Layer { name, channels });
    }
    picture
}

#[test]
fn pictures_that_contradict_themselves_are_refused_and_leave_no_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.exr");
    let one = || channel("R", vec![0.0; 4]);
    let wrong = [
        with(vec![]),
        with(vec![("", vec![])]),
        with(vec![("", vec![channel("R", vec![0.0; 3])])]),
        with(vec![("", vec![one(), one()])]),
        with(vec![("a", vec![one()]), ("a", vec![one()])]),
        with(vec![("", vec![channel("", vec![0.0; 4])])]),
        with(vec![("", vec![channel("a.R", vec![0.0; 4])])]),
        with(vec![("a\0b", vec![one()])]),
        with(vec![("", vec![channel(&"x".repeat(256), vec![0.0; 4])])]),
        Picture::new(0, 2).with_rgb("", &[]),
    ];
    for picture in wrong {
        let error = image::exr::write(&path, &picture, &Metadata::default()).unwrap_err();
        assert!(
            matches!(error, ImageError::InvalidPicture { .. }),
            "{error}"
        );
    }
    for key in ["", "channels", "dataWindow", "a\0b"] {
        let metadata = Metadata([(key.to_owned(), String::new())].into());
        let error = image::exr::write(&path, &with(vec![("", vec![one()])]), &metadata);
        let error = error.unwrap_err();
        assert!(
            matches!(error, ImageError::InvalidMetadata { .. }),
            "{error}"
        );
    }
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}

#[test]
fn a_folder_that_is_not_there_is_named() {
    let picture = Picture::new(1, 1).with_rgb("", &[0.0; 3]);
    let path = "/no/such/folder/a.exr";
    let error = image::exr::write(path, &picture, &Metadata::default()).unwrap_err();
    assert!(error.to_string().starts_with(path), "{error}");
    let error = image::exr::read(path).unwrap_err();
    assert!(error.to_string().starts_with(path), "{error}");
}

#[test]
fn environment_maps_are_told_apart_by_content() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("map.hdr");
    let picture = Picture::new(2, 1).with_rgb("", &[1.0, 2.0, -3.0, f32::NAN, 0.5, 0.25]);
    image::exr::write(&path, &picture, &Metadata::default()).unwrap();
    let map = read_rgb(&path).unwrap();
    assert_eq!((map.width, map.height, map.clamped), (2, 1, 2));
    assert_eq!(map.texels, [[1.0, 2.0, 0.0], [0.0, 0.5, 0.25]]);
    std::fs::write(&path, "#?RGBE\n\n-Y 1 +X 1\n\u{40}\u{20}\0\u{7f}").unwrap();
    assert_eq!(read_rgb(&path).unwrap().texels, [[0.125, 0.0625, 0.0]]);
}

#[test]
fn what_is_no_environment_map_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("map.exr");
    std::fs::write(&path, "neither").unwrap();
    let error = read_rgb(&path).unwrap_err();
    assert!(matches!(error, ImageError::UnknownFormat { .. }), "{error}");
    let error = read_rgb(folder.path()).unwrap_err();
    assert!(matches!(error, ImageError::NotAFile { .. }), "{error}");
    let depth = with(vec![("depth", vec![channel("Z", vec![0.0; 4])])]);
    image::exr::write(&path, &depth, &Metadata::default()).unwrap();
    let error = read_rgb(&path).unwrap_err().to_string();
    assert!(error.contains("depth.Z"), "{error}");
}
