//! [`Picture`] to OpenEXR.

use std::collections::BTreeSet;
use std::path::Path;

use ::exr::image::{AnyChannel, AnyChannels, Encoding, FlatSamples, Image, Layer as Part};
use ::exr::meta::attribute::{AttributeValue, Text};
use ::exr::meta::header::{LayerAttributes, standard_names};
use ::exr::prelude::{SmallVec, Vec2, WritableImage};

use super::names;
use crate::image::{ImageError, Layer, Metadata, Picture, atomic};

/// Writes a picture: f32, ZIP16, one part with dotted channel names, the metadata
/// as text attributes. The file appears whole or not at all.
///
/// # Errors
/// An empty or contradictory picture (no channels, a wrong number of samples, a
/// name that is empty, repeated, or holds a NUL byte, a channel name with a dot),
/// a metadata name that OpenEXR reserves for a value of another kind, or
/// whatever the file system reports.
pub fn write(
    path: impl AsRef<Path>,
    picture: &Picture,
    metadata: &Metadata,
) -> Result<(), ImageError> {
    let path = path.as_ref();
    validate(path, picture)?;
    let part = Part::new(
        (picture.width, picture.height),
        attributes(path, metadata)?,
        Encoding::SMALL_LOSSLESS,
        channels(picture),
    );
    let image = Image::from_layer(part);
    atomic::write(path, |sink| {
        image
            .write()
            .to_buffered(sink)
            .map_err(|error| match error {
                ::exr::error::Error::Io(source) => ImageError::io(path, "write", source),
                other => ImageError::picture(path, "", "", &other.to_string()),
            })
    })
}

fn validate(path: &Path, picture: &Picture) -> Result<(), ImageError> {
    let Picture { width, height, .. } = *picture;
    // Coordinates in the file are i32.
    let is_storable = |n: usize| (1..=i32::MAX as usize).contains(&n);
    if !is_storable(width) || !is_storable(height) {
        let reason = format!("{width}x{height} pixels cannot be stored");
        return Err(ImageError::picture(path, "", "", &reason));
    }
    if picture.layers.iter().all(|layer| layer.channels.is_empty()) {
        return Err(ImageError::picture(path, "", "", "there are no channels"));
    }
    let mut seen = BTreeSet::new();
    for layer in &picture.layers {
        validate_layer(path, layer, width * height, &mut seen)?;
    }
    Ok(())
}

fn validate_layer(
    path: &Path,
    layer: &Layer,
    pixels: usize,
    seen: &mut BTreeSet<String>,
) -> Result<(), ImageError> {
    for channel in &layer.channels {
        let error = |reason: &str| ImageError::picture(path, &layer.name, &channel.name, reason);
        if channel.samples.len() != pixels {
            let count = channel.samples.len();
            return Err(error(&format!("{count} samples for {pixels} pixels")));
        }
        let name = names::join(&layer.name, &channel.name);
        // OpenEXR's limit on names, and on what this reader would take apart again.
        if channel.name.is_empty() || name.len() > 255 {
            return Err(error("the name must have 1 to 255 bytes"));
        }
        if channel.name.contains('.') || name.contains('\0') {
            return Err(error("a channel's name holds neither dot nor NUL"));
        }
        if !seen.insert(name) {
            return Err(error("the channel appears twice"));
        }
    }
    Ok(())
}

fn channels(picture: &Picture) -> AnyChannels<FlatSamples> {
    let each = |layer: &Layer| {
        let stored = layer.channels.iter().map(|channel| AnyChannel {
            name: text(&names::join(&layer.name, &channel.name)),
            sample_data: FlatSamples::F32(channel.samples.clone()),
            quantize_linearly: false,
            sampling: Vec2(1, 1),
        });
        stored.collect::<Vec<_>>()
    };
    AnyChannels::sort(picture.layers.iter().flat_map(each).collect())
}

fn attributes(path: &Path, metadata: &Metadata) -> Result<LayerAttributes, ImageError> {
    let mut attributes = LayerAttributes::default();
    for (key, value) in &metadata.0 {
        validate_key(path, key)?;
        let value = text(value);
        match key.as_str() {
            "capDate" => attributes.capture_date = Some(value),
            "comments" => attributes.comments = Some(value),
            "owner" => attributes.owner = Some(value),
            "software" => attributes.software_name = Some(value),
            _ => {
                attributes
                    .other
                    .insert(text(key), AttributeValue::Text(value));
            }
        }
    }
    Ok(attributes)
}

fn validate_key(path: &Path, key: &str) -> Result<(), ImageError> {
    const TEXTS: [&str; 4] = ["capDate", "comments", "owner", "software"];
    let error = |reason: &str| ImageError::InvalidMetadata {
        path: path.to_owned(),
        key: key.to_owned(),
        reason: reason.to_owned(),
    };
    if key.is_empty() || key.len() > 255 || key.contains('\0') {
        return Err(error("a name has 1 to 255 bytes, none of them NUL"));
    }
    if !TEXTS.contains(&key) && standard_names::ALL.contains(&key.as_bytes()) {
        return Err(error("OpenEXR gives this name another meaning"));
    }
    Ok(())
}

fn text(text: &str) -> Text {
    Text::from_bytes_unchecked(SmallVec::from_slice(text.as_bytes()))
}
