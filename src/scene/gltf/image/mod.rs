//! Images: PNG, JPEG, WebP and KTX 2.0, told apart by their first bytes.

mod decode;
mod ktx2;
mod ktx2_basis;
mod ktx2_pixels;
mod webp;
mod zstd;

use std::ops::Range;
use std::path::PathBuf;
use std::sync::Arc;

pub(super) use decode::Budget;

use super::buffer::Data;
use super::error::LoadError;
use super::files::Files;
use super::json::{Item, shorten};
use crate::scene::{Image, Texels};

/// An image as it is in the file.
#[derive(Debug)]
pub(super) struct Encoded<'a> {
    file: PathBuf,
    /// Image, user and file name, for messages.
    label: String,
    name: String,
    bytes: Source<'a>,
}

#[derive(Debug)]
enum Source<'a> {
    File(Arc<Vec<u8>>),
    View(&'a [u8]),
    /// No bytes: [`Encoded::magenta`].
    Magenta,
}

/// How a picture file says that its numbers are encoded, if it does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Transfer {
    /// As light.
    Linear,
    /// By sRGB's transfer function.
    Srgb,
}

/// An image's pixels, and what its file says about them.
#[derive(Debug)]
pub(super) struct Decoded {
    /// The pixels.
    pub image: Image,
    /// Their encoding, if the file states it (KTX 2.0).
    pub transfer: Option<Transfer>,
}

/// Find the bytes of the image `item`, which `user` (as in `texture 3`) needs.
pub(super) fn find<'a>(
    item: &Item,
    user: &str,
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
    let mut label = format!("{} of {user}", item.label());
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
    /// What is shown in place of an image that is wrong.
    pub fn magenta() -> Self {
        Self {
            file: PathBuf::new(),
            label: String::new(),
            name: "magenta".to_owned(),
            bytes: Source::Magenta,
        }
    }

    fn bytes(&self) -> &[u8] {
        match &self.bytes {
            Source::File(bytes) => bytes,
            Source::View(bytes) => bytes,
            Source::Magenta => &[],
        }
    }

    /// Image, user and file name, for messages.
    pub fn label(&self) -> &str {
        &self.label
    }

    /// Equal for images that are the same bytes in memory.
    pub fn identity(&self) -> Range<usize> {
        let range = self.bytes().as_ptr_range();
        range.start as usize..range.end as usize
    }

    /// The extension through which alone glTF allows an image of this format, if there is one.
    pub fn needs_extension(&self) -> Option<&'static str> {
        match decode::Format::of(self.bytes())? {
            decode::Format::Png | decode::Format::Jpeg => None,
            decode::Format::Webp => Some("EXT_texture_webp"),
            decode::Format::Ktx2 => Some("KHR_texture_basisu"),
        }
    }

    /// The pixels.
    pub fn decode(&self, budget: &Budget) -> Result<Decoded, LoadError> {
        if matches!(self.bytes, Source::Magenta) {
            return Ok(magenta());
        }
        let decoded = decode::decode(self.bytes(), budget);
        let pixels = decoded.map_err(|problem| LoadError::Image {
            path: self.file.clone(),
            object: self.label.clone(),
            problem,
        })?;
        Ok(Decoded {
            image: Image {
                name: self.name.clone(),
                width: pixels.width,
                height: pixels.height,
                texels: pixels.texels,
            },
            transfer: pixels.transfer,
        })
    }
}

/// One pixel that no author would want.
pub(super) fn magenta() -> Decoded {
    Decoded {
        image: Image {
            name: "magenta".to_owned(),
            width: 1,
            height: 1,
            texels: Texels::Rgba8(vec![[255, 0, 255, 255]]),
        },
        transfer: None,
    }
}
