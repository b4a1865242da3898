//! What is checked of a file before crate `exr` may allocate for it.

use std::collections::HashSet;
use std::io::{Cursor, Read};
use std::path::Path;

use ::exr::meta::MetaData;
use ::exr::meta::header::Header;
use ::exr::prelude::Vec2;

use super::FORMAT;
use crate::image::ImageError;

/// Bytes of pixels that any file may claim, however short it is.
const FREE: u64 = 64 << 20;

/// Bytes of pixels a byte of file: deflate reaches 1032 (zlib's *Technical
/// Details*), and no other lossless scheme of the format comes near that on
/// pictures that were not made for it. Twice, for stored and decoded pixels.
const EXPANSION: u64 = 2 * 1032;

/// Bytes of pixels at most, stored and decoded: a 32,768 × 16,384 map in half RGB needs 9 GiB.
const MOST: u64 = 12 << 30;

/// Reads the headers and refuses what this program does not read, and every
/// claim of a size that the file cannot back.
pub(super) fn headers(path: &Path, bytes: &[u8]) -> Result<MetaData, ImageError> {
    let mut cursor = Cursor::new(bytes);
    let meta = MetaData::read_from_buffered(&mut cursor, false)
        .map_err(|e| ImageError::malformed(path, FORMAT, e))?;
    let mut claimed = 0_u64;
    for header in &meta.headers {
        features(path, header)?;
        claimed = claimed.saturating_add(size_of_pixels(header));
        size(path, header, claimed, bytes.len() as u64)?;
    }
    same_size(path, &meta.headers)?;
    chunks(path, &meta.headers, cursor)?;
    Ok(meta)
}

fn features(path: &Path, header: &Header) -> Result<(), ImageError> {
    if header.deep {
        return Err(ImageError::unsupported(path, FORMAT, "deep data"));
    }
    if header.channels.list.is_empty() {
        return Err(ImageError::malformed(
            path,
            FORMAT,
            "a part has no channels",
        ));
    }
    match header
        .channels
        .list
        .iter()
        .find(|c| c.sampling != Vec2(1, 1))
    {
        Some(channel) => {
            let reason = format!("channel \"{}\" is subsampled", channel.name);
            Err(ImageError::unsupported(path, FORMAT, reason))
        }
        None => Ok(()),
    }
}

/// Bytes that the decoded pixels take: as stored, and as 32-bit floats.
fn size_of_pixels(header: &Header) -> u64 {
    let Vec2(width, height) = header.layer_size;
    let pixel = header.channels.bytes_per_pixel + 4 * header.channels.list.len();
    (width as u64)
        .saturating_mul(height as u64)
        .saturating_mul(pixel as u64)
}

fn size(path: &Path, header: &Header, claimed: u64, length: u64) -> Result<(), ImageError> {
    let limit = length.saturating_mul(EXPANSION).clamp(FREE, MOST);
    let Vec2(width, height) = header.layer_size;
    if width == 0 || height == 0 {
        return Err(ImageError::malformed(path, FORMAT, "a part has no pixels"));
    }
    if claimed > limit {
        return Err(ImageError::TooLarge {
            path: path.to_owned(),
            format: FORMAT,
            width: width as u64,
            height: height as u64,
            bytes: claimed,
            limit,
        });
    }
    Ok(())
}

fn same_size(path: &Path, headers: &[Header]) -> Result<(), ImageError> {
    let first = headers.first().map(|h| h.layer_size);
    match headers.iter().find(|h| Some(h.layer_size) != first) {
        Some(_) => Err(ImageError::unsupported(
            path,
            FORMAT,
            "parts of different sizes",
        )),
        None => Ok(()),
    }
}

/// Every block must lie in the file, and no two may be the same one: a block that
/// is missing would otherwise leave its rows black without a word.
fn chunks(path: &Path, headers: &[Header], mut cursor: Cursor<&[u8]>) -> Result<(), ImageError> {
    let malformed = |reason| ImageError::malformed(path, FORMAT, reason);
    let length = cursor.get_ref().len() as u64;
    let count: u64 = headers.iter().map(|h| h.chunk_count as u64).sum();
    let end = cursor.position().saturating_add(count.saturating_mul(8));
    if end > length {
        return Err(malformed("the file ends in its table of blocks"));
    }
    let mut seen = HashSet::new();
    for _ in 0..count {
        let mut offset = [0; 8];
        cursor
            .read_exact(&mut offset)
            .map_err(|e| ImageError::io(path, "read", e))?;
        let offset = u64::from_le_bytes(offset);
        if offset < end || offset >= length {
            return Err(malformed("a block is missing: the file is incomplete"));
        }
        if !seen.insert(offset) {
            return Err(malformed("two blocks share one place"));
        }
    }
    Ok(())
}
