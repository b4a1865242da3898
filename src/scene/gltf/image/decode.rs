//! From a picture file's bytes to pixels, without trust in what its header promises.

use std::io::Cursor;

use ::image::codecs::jpeg::JpegDecoder;
use ::image::codecs::png::PngDecoder;
use ::image::{DynamicImage, ImageDecoder, ImageError, Limits};

use super::super::buffer::Data;
use super::{Transfer, ktx2, webp};
use crate::scene::Texels;

/// The formats that are read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Format {
    Png,
    Jpeg,
    Webp,
    Ktx2,
}

/// A decoded picture.
#[derive(Debug)]
pub(super) struct Pixels {
    pub width: u32,
    pub height: u32,
    pub texels: Texels,
    pub transfer: Option<Transfer>,
}

/// Most pixels that an image may have.
const MOST_PIXELS: u64 = 1 << 28;

/// Pixels that a file of a format that codes a plain area in no bits at all (WebP, Basis Universal)
/// may stand for beyond [`Promise::per_byte`] of its bytes: 4096².
const PLAIN_PIXELS: u64 = 1 << 24;

/// Pixels that a file's bytes may stand for.
#[derive(Debug, Clone, Copy)]
pub(super) struct Promise {
    /// Whatever its length.
    base: u64,
    /// For each byte.
    per_byte: u64,
}

impl Promise {
    /// Deflate packs up to 1032 to 1, and a pixel may be one bit.
    pub const PNG: Self = Self {
        base: 0,
        per_byte: 8 * 1032,
    };
    /// A block of 8 × 8 pixels takes a bit at least.
    pub const JPEG: Self = Self {
        base: 0,
        per_byte: 8 * 64,
    };
    /// No number of bits is too small for a plain area: what PNG may do, and some room.
    pub const PLAIN: Self = Self {
        base: PLAIN_PIXELS,
        per_byte: 8 * 1032,
    };
}

/// What all images of a scene may take together.
#[derive(Debug, Clone, Copy)]
pub(in super::super) struct Budget<'a> {
    data: &'a Data<'a>,
}

impl<'a> Budget<'a> {
    /// The budget that follows from the bytes read for the scene.
    pub fn new(data: &'a Data<'a>) -> Self {
        Self { data }
    }

    /// Refuse a size that the `length` bytes of a file of this format cannot stand for, or that is
    /// too much together with the other images.
    pub(super) fn admit(
        &self,
        format: &str,
        (width, height): (u32, u32),
        length: usize,
        promise: Promise,
    ) -> Result<(), String> {
        let pixels = u64::from(width) * u64::from(height);
        if pixels == 0 || pixels > MOST_PIXELS {
            return Err(format!(
                "it is {width} × {height} pixels, expected at least 1 and at most {MOST_PIXELS}"
            ));
        }
        let most = (length as u64).saturating_mul(promise.per_byte);
        if pixels > most.saturating_add(promise.base) {
            return Err(format!(
                "its header promises {width} × {height} pixels, more than its {length} bytes can hold; the {format} is damaged"
            ));
        }
        match self.data.charge_pixels(pixels) {
            true => Ok(()),
            false => Err(format!(
                "its {width} × {height} pixels are too many together with the other images"
            )),
        }
    }
}

impl Format {
    /// The format that begins as `bytes` do.
    pub fn of(bytes: &[u8]) -> Option<Self> {
        let begins = |at: usize, with: &[u8]| bytes.get(at..).is_some_and(|b| b.starts_with(with));
        let kinds = [
            (begins(0, b"\x89PNG"), Self::Png),
            (begins(0, b"\xFF\xD8"), Self::Jpeg),
            (begins(0, b"RIFF") && begins(8, b"WEBP"), Self::Webp),
            (begins(0, &ktx2::IDENTIFIER), Self::Ktx2),
        ];
        let found = kinds.into_iter().find(|(matches, _)| *matches);
        found.map(|(_, format)| format)
    }
}

/// The pixels of a file; or why there are none.
pub(super) fn decode(bytes: &[u8], budget: &Budget) -> Result<Pixels, String> {
    let cursor = Cursor::new(bytes);
    let picture = match Format::of(bytes) {
        Some(Format::Png) => {
            let decoder = PngDecoder::new(cursor).map_err(|error| damaged("PNG", &error))?;
            run("PNG", decoder, bytes, Promise::PNG, budget)
        }
        Some(Format::Jpeg) => {
            let decoder = JpegDecoder::new(cursor).map_err(|error| damaged("JPEG", &error))?;
            run("JPEG", decoder, bytes, Promise::JPEG, budget)
        }
        Some(Format::Webp) => {
            let decoder = webp::open(bytes)?;
            run("WebP", decoder, bytes, Promise::PLAIN, budget)
        }
        Some(Format::Ktx2) => return ktx2::decode(bytes, budget),
        None => Err(format!(
            "expected a PNG, JPEG, WebP or KTX2 image, found {}; convert it",
            guess_format(bytes)
        )),
    };
    picture.map(into_pixels)
}

/// Decode, but only a header whose promises the bytes can keep.
fn run(
    format: &str,
    mut decoder: impl ImageDecoder,
    bytes: &[u8],
    promise: Promise,
    budget: &Budget,
) -> Result<DynamicImage, String> {
    budget.admit(format, decoder.dimensions(), bytes.len(), promise)?;
    let mut limits = Limits::default();
    limits.max_alloc = Some(MOST_PIXELS * 16);
    decoder
        .set_limits(limits)
        .map_err(|error| damaged(format, &error))?;
    DynamicImage::from_decoder(decoder).map_err(|error| damaged(format, &error))
}

/// The sentence about a file that its decoder refuses.
pub(super) fn damaged(format: &str, error: &ImageError) -> String {
    let reason = error.to_string().replace(['\n', '\r'], " ");
    format!("the {format} cannot be decoded ({reason}); export the image again")
}

fn guess_format(bytes: &[u8]) -> &'static str {
    match bytes {
        [] => "nothing",
        [0xAB, b'K', b'T', b'X', b' ', b'1', ..] => "a KTX 1 texture",
        [b'D', b'D', b'S', b' ', ..] => "a DDS texture",
        [b'G', b'I', b'F', ..] => "a GIF image",
        [b'B', b'M', ..] => "a BMP image",
        [_, _, _, _, b'f', b't', b'y', b'p', ..] => "an AVIF or HEIF image",
        _ => "something else",
    }
}

/// RGBA with 8 bits a channel, or 16 if the file has them.
fn into_pixels(image: DynamicImage) -> Pixels {
    let (width, height) = (image.width(), image.height());
    let texels = match image {
        DynamicImage::ImageLuma16(_)
        | DynamicImage::ImageLumaA16(_)
        | DynamicImage::ImageRgb16(_)
        | DynamicImage::ImageRgba16(_) => {
            let raw = image.into_rgba16().into_raw();
            let texel = |c: &[u16]| [c[0], c[1], c[2], c[3]];
            Texels::Rgba16(raw.chunks_exact(4).map(texel).collect())
        }
        image => Texels::Rgba8(quads(image.into_rgba8().into_raw())),
    };
    Pixels {
        width,
        height,
        texels,
        transfer: None,
    }
}

/// The same bytes, four by four.
pub(super) fn quads(bytes: Vec<u8>) -> Vec<[u8; 4]> {
    bytemuck::allocation::try_cast_vec(bytes).unwrap_or_else(|(_, bytes)| {
        bytes
            .chunks_exact(4)
            .map(|c| [c[0], c[1], c[2], c[3]])
            .collect()
    })
}
