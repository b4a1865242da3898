//! Radiance HDR (.hdr, .pic): four bytes a pixel, run-length coded.
//!
//! Format: G. Ward, "Real Pixels", *Graphics Gems II* (1991), and Radiance's
//! `color.c` and `resolu.c`. Our own decoder, since the one in crate `image` takes
//! neither the signature `#?RGBE` nor turned pictures, allocates what the header
//! claims, and may overflow on a chain of runs.

use std::path::Path;

use super::ImageError;

mod scanline;

/// The format's name in messages.
const FORMAT: &str = "Radiance HDR";

/// Texels at most: a 16,384 × 16,384 map.
const MOST_TEXELS: u64 = 1 << 28;

/// Texels a byte of file. The runs of today's encoding reach 127 texels in 8 bytes;
/// the rest is room for the encoding of 1991, whose runs are longer.
const EXPANSION: u64 = 256;

/// What begins every file: Radiance writes the first, Greg Ward's other tools the second.
const SIGNATURES: [&[u8]; 2] = [b"#?RADIANCE", b"#?RGBE"];

/// Width, height, texels row-major from the top left.
pub(super) type Texels = (usize, usize, Vec<[f32; 3]>);

/// Whether the bytes begin as a Radiance HDR file does.
pub(super) fn is_hdr(bytes: &[u8]) -> bool {
    SIGNATURES.iter().any(|s| bytes.starts_with(s))
}

/// Decodes a file's bytes; the path is for messages.
///
/// `EXPOSURE` and `COLORCORR` lines are passed over, as stb_image, three.js and the
/// glTF sample viewer do, so that a map is as bright here as there.
pub(super) fn decode(path: &Path, bytes: &[u8]) -> Result<Texels, ImageError> {
    let malformed = |reason: &str| ImageError::malformed(path, FORMAT, reason);
    let mut rest = bytes;
    read_header(path, &mut rest)?;
    let line = take_line(&mut rest).ok_or_else(|| malformed("the header does not end"))?;
    let layout = Layout::parse(&line).ok_or_else(|| malformed("bad resolution line"))?;
    check_size(path, &layout, bytes.len() as u64)?;
    // Grow with what has been decoded, not with what is claimed.
    let mut scanlines = Vec::new();
    for _ in 0..layout.scanlines {
        scanline::decode(&mut rest, layout.length, &mut scanlines).map_err(malformed)?;
    }
    Ok(layout.upright(scanlines))
}

fn read_header(path: &Path, rest: &mut &[u8]) -> Result<(), ImageError> {
    loop {
        let line = take_line(rest);
        let line =
            line.ok_or_else(|| ImageError::malformed(path, FORMAT, "the header does not end"))?;
        match line.trim().split_once('=') {
            None if line.trim().is_empty() => return Ok(()),
            Some((key, value)) if key.trim() == "FORMAT" && value.trim() != "32-bit_rle_rgbe" => {
                return Err(ImageError::unsupported(path, FORMAT, value.trim()));
            }
            _ => {}
        }
    }
}

/// Cuts off a line and its line feed; no line of a header is longer than 4 KiB.
fn take_line(rest: &mut &[u8]) -> Option<String> {
    let end = rest.iter().take(4096).position(|&b| b == b'\n')?;
    let line = String::from_utf8_lossy(&rest[..end]).into_owned();
    *rest = &rest[end + 1..];
    Some(line)
}

fn check_size(path: &Path, layout: &Layout, length: u64) -> Result<(), ImageError> {
    let texels = layout.scanlines as u64 * layout.length as u64;
    let limit = MOST_TEXELS.min(length.saturating_mul(EXPANSION));
    if texels <= limit {
        return Ok(());
    }
    let (width, height) = layout.size();
    Err(ImageError::TooLarge {
        path: path.to_owned(),
        format: FORMAT,
        width: width as u64,
        height: height as u64,
        bytes: texels.saturating_mul(12),
        limit: limit * 12,
    })
}

/// The resolution line: which way scan lines run, how many there are, how long each is.
#[derive(Debug, PartialEq)]
struct Layout {
    scanlines: usize,
    length: usize,
    /// Scan lines are columns.
    is_transposed: bool,
    /// The first scan line is the bottom row, or the right column.
    flips_scanlines: bool,
    /// A scan line begins at the right, or at the bottom.
    flips_texels: bool,
}

impl Layout {
    /// "-Y 512 +X 1024" is the common one: rows from the top, each from the left.
    fn parse(line: &str) -> Option<Layout> {
        let words: Vec<&str> = line.split_whitespace().collect();
        let [major, scanlines, minor, length] = words[..] else {
            return None;
        };
        let is_transposed = match (&major.get(1..)?, &minor.get(1..)?) {
            (&"Y", &"X") => false,
            (&"X", &"Y") => true,
            _ => return None,
        };
        // Y counts upwards, X to the right.
        let flips = |axis: &str| match axis {
            "-Y" | "+X" => Some(false),
            "+Y" | "-X" => Some(true),
            _ => None,
        };
        let count = |word: &str| word.parse::<u32>().ok().filter(|&n| n > 0);
        Some(Layout {
            scanlines: count(scanlines)? as usize,
            length: count(length)? as usize,
            is_transposed,
            flips_scanlines: flips(major)?,
            flips_texels: flips(minor)?,
        })
    }

    fn size(&self) -> (usize, usize) {
        match self.is_transposed {
            false => (self.length, self.scanlines),
            true => (self.scanlines, self.length),
        }
    }

    /// Scan lines as they came to rows from the top left.
    fn upright(&self, scanlines: Vec<[f32; 3]>) -> Texels {
        let (width, height) = self.size();
        if !(self.is_transposed || self.flips_scanlines || self.flips_texels) {
            return (width, height, scanlines);
        }
        let source = |x: usize, y: usize| {
            let (line, texel) = if self.is_transposed { (x, y) } else { (y, x) };
            let turn = |i: usize, n: usize, flip: bool| if flip { n - 1 - i } else { i };
            let line = turn(line, self.scanlines, self.flips_scanlines);
            line * self.length + turn(texel, self.length, self.flips_texels)
        };
        let rows = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        let texels = rows.map(|(x, y)| scanlines[source(x, y)]).collect();
        (width, height, texels)
    }
}

#[cfg(test)]
#[path = "hdr/tests.rs"]
mod tests;
