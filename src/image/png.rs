//! 8-bit sRGB PNG, for people to look at.

mod chunks;

use std::path::Path;

use ::image::codecs::png::PngEncoder;
use ::image::{ExtendedColorType, ImageEncoder};

use super::tone_map::encode;
use super::{DisplaySettings, ImageError, Metadata, Picture, atomic};

/// Writes the main layer through exposure and tone map. The file appears whole or not at all.
///
/// A pixel with a NaN or infinite component is magenta (255, 0, 255), to be seen.
///
/// # Errors
/// A picture without a main layer of R, G, B (or Y) or of the wrong number of
/// samples, or whatever the file system reports.
pub fn write(
    path: impl AsRef<Path>,
    picture: &Picture,
    settings: &DisplaySettings,
) -> Result<(), ImageError> {
    write_with_metadata(path, picture, settings, &Metadata::default())
}

/// As [`write`], with the metadata as international text (iTXt) chunks. A name that
/// PNG cannot hold (79 bytes of Latin letters at most) is an error.
///
/// # Errors
/// As [`write`].
pub fn write_with_metadata(
    path: impl AsRef<Path>,
    picture: &Picture,
    settings: &DisplaySettings,
    metadata: &Metadata,
) -> Result<(), ImageError> {
    let path = path.as_ref();
    let mut png = encode_pixels(path, picture, settings)?;
    let mut extra = chunks::srgb();
    for (key, value) in &metadata.0 {
        let chunk = chunks::text(key, value).map_err(|reason| ImageError::InvalidMetadata {
            path: path.to_owned(),
            key: key.clone(),
            reason: reason.to_owned(),
        })?;
        extra.extend(chunk);
    }
    chunks::insert(&mut png, &extra);
    atomic::write(path, |sink| {
        sink.write_all(&png)
            .map_err(|e| ImageError::io(path, "write", e))
    })
}

fn encode_pixels(
    path: &Path,
    picture: &Picture,
    settings: &DisplaySettings,
) -> Result<Vec<u8>, ImageError> {
    let error = |reason: &str| ImageError::picture(path, "", "", reason);
    let main = picture.layer("").and_then(|layer| layer.rgb());
    let [r, g, b] = main.ok_or_else(|| error("a PNG needs channels R, G, B"))?;
    let pixels = picture.width.saturating_mul(picture.height);
    if pixels == 0 || [r, g, b].iter().any(|c| c.len() != pixels) {
        return Err(error("the number of samples is not that of the pixels"));
    }
    let colours = r.iter().zip(g).zip(b);
    let bytes: Vec<u8> = colours
        .flat_map(|((&r, &g), &b)| encode([r, g, b], settings))
        .collect();
    let size = u32::try_from(picture.width).and_then(|w| Ok((w, u32::try_from(picture.height)?)));
    let (width, height) = size.map_err(|_| error("too many pixels for a PNG"))?;
    let mut png = Vec::new();
    PngEncoder::new(&mut png)
        .write_image(&bytes, width, height, ExtendedColorType::Rgb8)
        .map_err(|e| error(&e.to_string()))?;
    Ok(png)
}

#[cfg(test)]
#[allow(clippy::unwrap_used)] // A test that cannot set itself up has failed.
mod tests {
    use super::*;
    use crate::image::ToneMap;

    #[test]
    fn pixels_and_texts_are_read_back() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        let samples = [0.0, 0.214_041_14, 1.0, f32::NAN, 0.0, 0.0];
        let picture = Picture::new(1, 2).with_rgb("", &samples);
        let settings = DisplaySettings {
            exposure_ev: 0.0,
            tone_map: ToneMap::None,
        };
        let mut metadata = Metadata::default();
        metadata.0.insert("scene".into(), "étendue".into());
        write_with_metadata(&path, &picture, &settings, &metadata).unwrap();
        let image = ::image::open(&path).unwrap().into_rgb8();
        assert_eq!(image.dimensions(), (1, 2));
        assert_eq!(image.into_raw(), [0, 128, 255, 255, 0, 255]);
        let bytes = std::fs::read(&path).unwrap();
        let text = "scene\0\0\0\0\0étendue".as_bytes();
        assert!(bytes.windows(text.len()).any(|w| w == text));
    }

    #[test]
    fn a_picture_without_colour_is_refused_by_name() {
        let picture = Picture::new(1, 1).with_rgb("albedo", &[0.0; 3]);
        let error = write("x.png", &picture, &DisplaySettings::default()).unwrap_err();
        assert!(error.to_string().starts_with("x.png: "), "{error}");
        let picture = Picture::new(2, 1).with_rgb("", &[0.0; 3]);
        assert!(write("x.png", &picture, &DisplaySettings::default()).is_err());
    }
}
