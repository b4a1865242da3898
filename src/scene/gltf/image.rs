//! Images: PNG and JPEG, told apart by their first bytes.

use std::io::Cursor;
use std::ops::Range;
use std::path::PathBuf;
use std::sync::Arc;

use ::image::codecs::jpeg::JpegDecoder;
use ::image::codecs::png::PngDecoder;
use ::image::{DynamicImage, ImageDecoder, ImageError, Limits};

use super::buffer::Data;
use super::error::LoadError;
use super::files::Files;
use super::json::{Item, shorten};
use crate::scene::{Image, Texels};

/// An image as it is in the file.
#[derive(Debug)]
pub(super) struct Encoded<'a> {
    file: PathBuf,
    /// Image, texture and file name, for messages.
    label: String,
    name: String,
    bytes: Source<'a>,
}

#[derive(Debug)]
enum Source<'a> {
    File(Arc<Vec<u8>>),
    View(&'a [u8]),
}

/// Most pixels that an image may have.
const MOST_PIXELS: u64 = 1 << 28;

/// Find the bytes of the image `item`, which `texture` needs.
pub(super) fn find<'a>(
    item: &Item,
    texture: &Item,
    data: &'a Data,
    files: &mut Files,
) -> Result<Encoded<'a>, LoadError> {
    let view = item.index("bufferView", "buffer view", data.views().len())?;
    let uri = item.text("uri")?;
    let bytes = match (view, uri) {
        (Some(view), _) => Source::View(data.view(view)?),
        (None, Some(uri)) => Source::File(files.load(item, uri)?),
        (None, None) => return Err(item.fault("it has neither `uri` nor `bufferView`")),
    };
    let mut label = format!("{} of {}", item.label(), texture.label());
    let mut name = item.name().to_owned();
    if let Some(uri) = uri.filter(|uri| !uri.starts_with("data:")) {
        label.push_str(&format!(" (file {:?})", shorten(uri)));
        if name.is_empty() {
            name = uri.to_owned();
        }
    }
    Ok(Encoded {
        file: item.file().to_owned(),
        label,
        name,
        bytes,
    })
}

impl Encoded<'_> {
    fn bytes(&self) -> &[u8] {
        match &self.bytes {
            Source::File(bytes) => bytes,
            Source::View(bytes) => bytes,
        }
    }

    /// Equal for images that are the same bytes in memory.
    pub fn identity(&self) -> Range<usize> {
        let range = self.bytes().as_ptr_range();
        range.start as usize..range.end as usize
    }

    /// The pixels.
    pub fn decode(&self, data: &Data) -> Result<Image, LoadError> {
        let pixels = self.decode_pixels(data);
        let texels = pixels
            .map(into_texels)
            .map_err(|problem| LoadError::Image {
                path: self.file.clone(),
                object: self.label.clone(),
                problem,
            })?;
        let ((width, height), texels) = texels;
        Ok(Image {
            name: self.name.clone(),
            width,
            height,
            texels,
        })
    }

    fn decode_pixels(&self, data: &Data) -> Result<DynamicImage, String> {
        /// Most pixels that a byte of PNG may stand for: deflate packs up to 1032 to 1, and a
        /// pixel may be one bit.
        const PNG_PIXELS_PER_BYTE: u64 = 8 * 1032;
        /// Most pixels that a byte of JPEG may stand for: an 8 × 8 block takes a bit at least.
        const JPEG_PIXELS_PER_BYTE: u64 = 8 * 64;
        let bytes = self.bytes();
        let cursor = Cursor::new(bytes);
        if bytes.starts_with(b"\x89PNG") {
            let decoder = PngDecoder::new(cursor).map_err(|error| damaged("PNG", &error))?;
            return self.run("PNG", decoder, PNG_PIXELS_PER_BYTE, data);
        }
        if bytes.starts_with(b"\xFF\xD8") {
            let decoder = JpegDecoder::new(cursor).map_err(|error| damaged("JPEG", &error))?;
            return self.run("JPEG", decoder, JPEG_PIXELS_PER_BYTE, data);
        }
        Err(format!(
            "expected a PNG or JPEG image, found {}; convert it",
            guess_format(bytes)
        ))
    }

    /// Decode, but only a header whose promises the bytes can keep.
    fn run(
        &self,
        format: &str,
        mut decoder: impl ImageDecoder,
        pixels_per_byte: u64,
        data: &Data,
    ) -> Result<DynamicImage, String> {
        let (width, height) = decoder.dimensions();
        let pixels = u64::from(width) * u64::from(height);
        if pixels == 0 || pixels > MOST_PIXELS {
            return Err(format!(
                "it is {width} × {height} pixels, expected at least 1 and at most {MOST_PIXELS}"
            ));
        }
        let length = self.bytes().len() as u64;
        if pixels > length.saturating_mul(pixels_per_byte) {
            return Err(format!(
                "its header promises {width} × {height} pixels, more than its {length} bytes can hold; the {format} is damaged"
            ));
        }
        if !data.charge_pixels(pixels) {
            return Err(format!(
                "its {width} × {height} pixels are too many together with the other images"
            ));
        }
        let mut limits = Limits::default();
        limits.max_alloc = Some(MOST_PIXELS * 16);
        decoder
            .set_limits(limits)
            .map_err(|error| damaged(format, &error))?;
        DynamicImage::from_decoder(decoder).map_err(|error| damaged(format, &error))
    }
}

fn damaged(format: &str, error: &ImageError) -> String {
    let reason = error.to_string().replace(['\n', '\r'], " ");
    format!("the {format} cannot be decoded ({reason}); export the image again")
}

fn guess_format(bytes: &[u8]) -> &'static str {
    match bytes {
        [] => "nothing",
        [0xAB, b'K', b'T', b'X', b' ', ..] => "a KTX texture",
        [
            b'R',
            b'I',
            b'F',
            b'F',
            _,
            _,
            _,
            _,
            b'W',
            b'E',
            b'B',
            b'P',
            ..,
        ] => "a WebP image",
        [b'D', b'D', b'S', b' ', ..] => "a DDS texture",
        [b'G', b'I', b'F', ..] => "a GIF image",
        [b'B', b'M', ..] => "a BMP image",
        [_, _, _, _, b'f', b't', b'y', b'p', ..] => "an AVIF or HEIF image",
        _ => "something else",
    }
}

/// RGBA with 8 bits a channel, or 16 if the file has them.
fn into_texels(image: DynamicImage) -> ((u32, u32), Texels) {
    let size = (image.width(), image.height());
    let texels = match image {
        DynamicImage::ImageLuma16(_)
        | DynamicImage::ImageLumaA16(_)
        | DynamicImage::ImageRgb16(_)
        | DynamicImage::ImageRgba16(_) => {
            let raw = image.into_rgba16().into_raw();
            Texels::Rgba16(
                raw.chunks_exact(4)
                    .map(|c| [c[0], c[1], c[2], c[3]])
                    .collect(),
            )
        }
        image => {
            let raw = image.into_rgba8().into_raw();
            Texels::Rgba8(
                bytemuck::allocation::try_cast_vec(raw).unwrap_or_else(|(_, raw)| {
                    raw.chunks_exact(4)
                        .map(|c| [c[0], c[1], c[2], c[3]])
                        .collect()
                }),
            )
        }
    };
    (size, texels)
}
