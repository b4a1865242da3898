//! OpenEXR to [`Picture`].

use std::io::Cursor;
use std::path::Path;

use ::exr::error::Error;
use ::exr::image::{AnyChannels, FlatSamples, Layers};
use ::exr::meta::attribute::{AttributeValue, Text};
use ::exr::meta::header::LayerAttributes;
use ::exr::prelude::{ReadChannels, ReadLayers, f16};

use super::{FORMAT, check, names};
use crate::host::guard;
use crate::image::{Channel, ImageError, Metadata, Picture, source};

/// Reads any flat OpenEXR file; half and u32 samples become f32 (u32 above 2²⁴ is rounded).
///
/// Layers are ordered by name, the main one first; channels R, G, B, A, X, Y, Z,
/// then by name. The metadata is every text attribute. The picture covers the
/// data window; where it lies in the display window is not kept.
///
/// # Errors
/// A file that cannot be read, is malformed, claims more than its length can
/// back, or is deep, subsampled, or of several parts of different sizes.
pub fn read(path: impl AsRef<Path>) -> Result<(Picture, Metadata), ImageError> {
    let path = path.as_ref();
    decode(path, &source::read(path)?)
}

/// As [`read`], from the file's bytes; the path is for messages.
pub(in crate::image) fn decode(
    path: &Path,
    bytes: &[u8],
) -> Result<(Picture, Metadata), ImageError> {
    guard::catch(|| decode_unguarded(path, bytes)).unwrap_or_else(|| {
        let reason = "its contents contradict each other";
        Err(ImageError::malformed(path, FORMAT, reason))
    })
}

fn decode_unguarded(path: &Path, bytes: &[u8]) -> Result<(Picture, Metadata), ImageError> {
    check::headers(path, bytes)?;
    let image = ::exr::image::read::read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .all_layers()
        .all_attributes()
        // A panic on one of the crate's own threads would end the process.
        .non_parallel()
        .from_buffered(Cursor::new(bytes))
        .map_err(|e| from_exr(path, e))?;
    let mut metadata = Metadata::default();
    insert_texts(&mut metadata, image.attributes.other.iter());
    for layer in &image.layer_data {
        insert_attributes(&mut metadata, &layer.attributes);
    }
    Ok((picture(path, image.layer_data)?, metadata))
}

fn from_exr(path: &Path, error: Error) -> ImageError {
    match error {
        Error::NotSupported(what) => ImageError::unsupported(path, FORMAT, what),
        Error::Io(source) => ImageError::io(path, "read", source),
        other => ImageError::malformed(path, FORMAT, other),
    }
}

fn picture(path: &Path, parts: Layers<AnyChannels<FlatSamples>>) -> Result<Picture, ImageError> {
    let size = parts.first().map_or((0, 0), |p| (p.size.0, p.size.1));
    let mut picture = Picture::new(size.0, size.1);
    let is_multi_part = parts.len() > 1;
    for part in parts {
        let name = part
            .attributes
            .layer_name
            .as_ref()
            .filter(|_| is_multi_part);
        let part_name = name.map_or(String::new(), text);
        for stored in part.channel_data.list {
            let full_name = text(&stored.name);
            let (layer, name) = names::split(&full_name);
            let channel = Channel {
                name: name.to_owned(),
                samples: to_f32(stored.sample_data),
            };
            let layer = names::layer_in_part(&part_name, layer);
            if !names::insert(&mut picture.layers, layer, channel) {
                let reason = format!("channel \"{full_name}\" appears twice");
                return Err(ImageError::malformed(path, FORMAT, reason));
            }
        }
    }
    names::sort(&mut picture.layers);
    Ok(picture)
}

fn to_f32(samples: FlatSamples) -> Vec<f32> {
    match samples {
        FlatSamples::F16(samples) => samples.into_iter().map(f16::to_f32).collect(),
        FlatSamples::F32(samples) => samples,
        FlatSamples::U32(samples) => samples.into_iter().map(|s| s as f32).collect(),
    }
}

/// The text attributes for which crate `exr` has a field, and those for which it has none.
fn insert_attributes(metadata: &mut Metadata, attributes: &LayerAttributes) {
    let fields = [
        ("capDate", &attributes.capture_date),
        ("comments", &attributes.comments),
        ("owner", &attributes.owner),
        ("software", &attributes.software_name),
    ];
    for (key, value) in fields {
        if let Some(value) = value {
            metadata.0.insert(key.to_owned(), text(value));
        }
    }
    insert_texts(metadata, attributes.other.iter());
}

fn insert_texts<'a>(
    metadata: &mut Metadata,
    attributes: impl Iterator<Item = (&'a Text, &'a AttributeValue)>,
) {
    for (key, value) in attributes {
        if let AttributeValue::Text(value) = value {
            metadata.0.insert(text(key), text(value));
        }
    }
}

/// Names and texts are bytes in the file; UTF-8 by custom.
fn text(text: &Text) -> String {
    String::from_utf8_lossy(text.bytes()).into_owned()
}
