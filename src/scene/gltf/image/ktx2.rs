//! KTX 2.0 (KHR_texture_basisu): the container, of which the largest level is taken.
//!
//! KTX File Format Specification, version 2; Khronos Data Format Specification 1.3, section 5.

use std::ops::Range;

use super::super::json::shorten;
use super::Transfer;
use super::decode::{Budget, Pixels};
use super::ktx2_pixels::Layout;
use super::{ktx2_basis, ktx2_pixels};

/// The first bytes of every file.
pub(super) const IDENTIFIER: [u8; 12] = *b"\xABKTX 20\xBB\r\n\x1A\n";

/// What is needed of a file; every range in it is inside of the file.
#[derive(Debug)]
pub(super) struct Container<'a> {
    /// The whole file.
    pub bytes: &'a [u8],
    /// Columns, at least 1.
    pub width: u32,
    /// Rows, at least 1.
    pub height: u32,
    /// How pixels are coded.
    pub coding: Coding,
    /// How the bytes of the level are packed.
    pub packing: Packing,
    /// The largest level as it is stored.
    pub level: &'a [u8],
    /// Bytes of it once unpacked, as the file says.
    pub unpacked: u64,
    /// How colours are encoded, if the file says.
    pub transfer: Option<Transfer>,
    /// Where each of R, G, B and A comes from: a letter of `rgba01`.
    pub swizzle: [u8; 4],
}

/// How the pixels of a file are coded.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Coding {
    /// Basis Universal's ETC1S.
    Etc1s,
    /// Basis Universal's UASTC.
    Uastc,
    /// Not at all.
    Plain(Layout),
}

/// `supercompressionScheme`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Packing {
    /// 0.
    None,
    /// 1: a part of ETC1S.
    BasisLz,
    /// 2.
    Zstandard,
}

/// The pixels of a file's largest level; or why there are none.
pub(super) fn decode(bytes: &[u8], budget: &Budget) -> Result<Pixels, String> {
    let container = read(bytes).map_err(|problem| {
        format!("{problem}; expected KTX2 as KHR_texture_basisu has it: export the image again")
    })?;
    let mut pixels = match container.coding {
        Coding::Plain(layout) => ktx2_pixels::decode(&container, layout, budget)?,
        Coding::Etc1s | Coding::Uastc => ktx2_basis::decode(&container, budget)?,
    };
    ktx2_pixels::swizzle(&mut pixels, container.swizzle);
    Ok(Pixels {
        width: container.width,
        height: container.height,
        texels: crate::scene::Texels::Rgba8(pixels),
        transfer: container.transfer,
    })
}

/// Bytes of a level in the index.
const LEVEL_ENTRY: usize = 24;
/// Where the index of levels begins.
const LEVELS: usize = 80;

fn read(bytes: &[u8]) -> Result<Container<'_>, String> {
    let [depth, layers, faces] = [28, 32, 36].map(|at| word(bytes, at));
    if (depth?, faces?) != (0, 1) || layers? > 1 {
        return Err("it is no plain picture but has depth, layers or faces".to_owned());
    }
    let packing = match word(bytes, 44)? {
        0 => Packing::None,
        1 => Packing::BasisLz,
        2 => Packing::Zstandard,
        3 => return Err("it is packed with zlib".to_owned()),
        other => return Err(format!("it is packed by the unknown scheme {other}")),
    };
    check_levels(bytes)?;
    let level = range(long(bytes, LEVELS)?, long(bytes, LEVELS + 8)?, bytes)?;
    let descriptor = section(bytes, 48)?;
    let coding = coding(word(bytes, 12)?, &bytes[descriptor.clone()], packing)?;
    let pairs = section(bytes, 56)?;
    Ok(Container {
        bytes,
        width: word(bytes, 20)?,
        height: word(bytes, 24)?,
        coding,
        packing,
        level: &bytes[level],
        unpacked: long(bytes, LEVELS + 16)?,
        transfer: transfer(&bytes[descriptor])?,
        swizzle: swizzle(&bytes[pairs])?,
    })
}

/// The index is there, and no longer than halving the sides admits.
fn check_levels(bytes: &[u8]) -> Result<(), String> {
    const MOST: u32 = 32;
    let levels = word(bytes, 40)?;
    let end = LEVELS + LEVEL_ENTRY * levels.clamp(1, MOST) as usize;
    match levels <= MOST && end <= bytes.len() {
        true => Ok(()),
        false => Err(format!("its index of {levels} levels is damaged")),
    }
}

/// Colour models of the data format descriptor.
const MODEL_ETC1S: u32 = 163;
const MODEL_UASTC: u32 = 166;

fn coding(format: u32, descriptor: &[u8], packing: Packing) -> Result<Coding, String> {
    let model = word(descriptor, 12)? & 0xFF;
    if format != 0 {
        let layout = Layout::of(format);
        let layout = layout.ok_or_else(|| format!("its pixels are of VkFormat {format}"))?;
        return match packing {
            Packing::BasisLz => Err("its plain pixels claim to be packed with BasisLZ".to_owned()),
            _ => Ok(Coding::Plain(layout)),
        };
    }
    if word(descriptor, 12)? >> 24 & 1 != 0 {
        return Err("its colours are premultiplied by alpha".to_owned());
    }
    let channels = channels(descriptor)?;
    match (model, packing, channels.as_slice()) {
        // RGB, RGB and alpha, or red alone in all three.
        (MODEL_ETC1S, Packing::BasisLz, [0] | [0, 15] | [3]) => Ok(Coding::Etc1s),
        (MODEL_UASTC, Packing::None | Packing::Zstandard, [0] | [3] | [4]) => Ok(Coding::Uastc),
        (MODEL_ETC1S | MODEL_UASTC, ..) => Err(format!(
            "its channels are of kinds {channels:?} with {packing:?} packing"
        )),
        _ => Err(format!(
            "its pixels are of colour model {model} and {packing:?} packing"
        )),
    }
}

/// The kind of each channel of the data format descriptor's samples.
fn channels(descriptor: &[u8]) -> Result<Vec<u32>, String> {
    let samples = descriptor.len().saturating_sub(28) / 16;
    let kind = |sample: usize| Ok(word(descriptor, 28 + 16 * sample)? >> 24 & 15);
    // More than four channels are no picture.
    (0..samples.min(5)).map(kind).collect()
}

fn transfer(descriptor: &[u8]) -> Result<Option<Transfer>, String> {
    match word(descriptor, 12)? >> 16 & 0xFF {
        0 => Ok(None),
        1 => Ok(Some(Transfer::Linear)),
        2 => Ok(Some(Transfer::Srgb)),
        other => Err(format!(
            "its transfer function is {other}, not linear or sRGB"
        )),
    }
}

/// `KTXswizzle`, which the pixels go through; a picture turned by `KTXorientation` is refused.
fn swizzle(pairs: &[u8]) -> Result<[u8; 4], String> {
    let text = |name: &str| value(pairs, name).map(|v| v.strip_suffix(b"\0").unwrap_or(v));
    if let Some(found) = text("KTXorientation").filter(|&found| found != b"rd") {
        return Err(format!(
            "its KTXorientation is {:?}, not \"rd\"",
            shorten(&String::from_utf8_lossy(found))
        ));
    }
    let Some(found) = text("KTXswizzle") else {
        return Ok(*b"rgba");
    };
    let letters: Option<[u8; 4]> = found.try_into().ok();
    letters
        .filter(|letters| letters.iter().all(|letter| b"rgba01".contains(letter)))
        .ok_or_else(|| "its KTXswizzle is not four letters of rgba01".to_owned())
}

/// The value of a name among the key/value pairs; what is damaged ends the search.
fn value<'a>(mut pairs: &'a [u8], name: &str) -> Option<&'a [u8]> {
    loop {
        let length = word(pairs, 0).ok()? as usize;
        let pair = pairs.get(4..4_usize.checked_add(length)?)?;
        let found = pair.strip_prefix(name.as_bytes());
        if let Some(value) = found.and_then(|rest| rest.strip_prefix(b"\0")) {
            return Some(value);
        }
        pairs = pairs.get(4 + length.checked_next_multiple_of(4)?..)?;
    }
}

/// The section whose 32-bit offset and length are at a place.
fn section(bytes: &[u8], at: usize) -> Result<Range<usize>, String> {
    let [offset, length] = [at, at + 4].map(|at| word(bytes, at));
    range(offset?.into(), length?.into(), bytes)
}

/// A range inside of the file.
pub(super) fn range(offset: u64, length: u64, bytes: &[u8]) -> Result<Range<usize>, String> {
    let end = offset.checked_add(length);
    let end = end.filter(|&end| end <= bytes.len() as u64);
    let end = end.ok_or_else(|| {
        format!(
            "{length} bytes from byte {offset} on do not fit in its {}",
            bytes.len()
        )
    })?;
    Ok(offset as usize..end as usize)
}

/// The 64-bit number at a place.
pub(super) fn long(bytes: &[u8], at: usize) -> Result<u64, String> {
    let [low, high] = [at, at + 4].map(|at| word(bytes, at));
    Ok(u64::from(low?) | u64::from(high?) << 32)
}

/// The 32-bit number at a place.
pub(super) fn word(bytes: &[u8], at: usize) -> Result<u32, String> {
    let word = bytes.get(at..at + 4).and_then(|word| word.try_into().ok());
    word.map(u32::from_le_bytes)
        .ok_or_else(|| "it is cut off".to_owned())
}
