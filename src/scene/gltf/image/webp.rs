//! WebP (EXT_texture_webp): what has to hold before it is decoded.
//!
//! RFC 9649, sections 2.3 to 2.7; RFC 6386, section 9.1.

use std::io::Cursor;

use ::image::ImageDecoder;
use ::image::codecs::webp::WebPDecoder;

use super::decode::damaged;

/// A decoder for a still picture whose frame is as large as its header says.
///
/// The decoder makes room for a lossy frame by the frame's own size and compares it with the header's
/// only afterwards, so that is done here.
pub(super) fn open(bytes: &[u8]) -> Result<WebPDecoder<Cursor<&[u8]>>, String> {
    let decoder = WebPDecoder::new(Cursor::new(bytes)).map_err(|error| damaged("WebP", &error))?;
    if decoder.has_animation() {
        return Err("it is an animated WebP, expected a still picture; convert it".to_owned());
    }
    let (width, height) = decoder.dimensions();
    match lossy_size(bytes) {
        Some((w, h)) if (w, h) != (width, height) => Err(format!(
            "its header says {width} × {height} pixels and its frame {w} × {h}; the WebP is damaged"
        )),
        _ => Ok(decoder),
    }
}

/// Columns and rows of the lossy frame, if there is one.
fn lossy_size(bytes: &[u8]) -> Option<(u32, u32)> {
    let mut rest = bytes.get(12..)?;
    loop {
        let (head, content) = rest.split_at_checked(8)?;
        let length = u32::from_le_bytes([head[4], head[5], head[6], head[7]]) as usize;
        if head.starts_with(b"VP8 ") {
            let side = |at: usize| {
                let pair = content.get(at..at + 2)?;
                Some(u32::from(u16::from_le_bytes([pair[0], pair[1]]) & 0x3FFF))
            };
            return Some((side(6)?, side(8)?));
        }
        // Chunks begin at even places.
        rest = content.get(length.checked_next_multiple_of(2)?..)?;
    }
}
