//! KTX 2.0 files that hold plain pixels, 8 bits a channel. KHR_texture_basisu allows none, but tools
//! write them.

use super::decode::{Budget, Promise};
use super::ktx2::{Container, Packing};
use super::zstd;

/// What the bytes of a pixel are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Layout {
    channels: usize,
    /// Blue comes first.
    reversed: bool,
}

impl Layout {
    /// Of a `VkFormat` with unsigned 8-bit channels, normalised or sRGB-encoded.
    pub fn of(format: u32) -> Option<Self> {
        let (channels, reversed) = match format {
            9 | 15 => (1, false),
            16 | 22 => (2, false),
            23 | 29 => (3, false),
            30 | 36 => (3, true),
            37 | 43 => (4, false),
            44 | 50 => (4, true),
            _ => return None,
        };
        Some(Self { channels, reversed })
    }

    /// RGBA of a pixel's bytes; what is not there is 0, and alpha 1.
    fn texel(self, bytes: &[u8]) -> [u8; 4] {
        let mut texel = [0, 0, 0, 255];
        texel[..self.channels].copy_from_slice(bytes);
        if self.reversed {
            texel.swap(0, 2);
        }
        texel
    }
}

/// The pixels of the largest level.
pub(super) fn decode(
    container: &Container,
    layout: Layout,
    budget: &Budget,
) -> Result<Vec<[u8; 4]>, String> {
    let size = (container.width, container.height);
    budget.admit("KTX2", size, container.level.len(), Promise::PLAIN)?;
    let length = size.0 as usize * size.1 as usize * layout.channels;
    let stored = match container.packing {
        Packing::Zstandard => container.unpacked,
        _ => container.level.len() as u64,
    };
    if stored != length as u64 {
        return Err(format!(
            "its level has {stored} bytes, expected {length}; the KTX2 is damaged"
        ));
    }
    let texels = |bytes: &[u8]| {
        let pixels = bytes.chunks_exact(layout.channels);
        pixels.map(|pixel| layout.texel(pixel)).collect()
    };
    match container.packing {
        Packing::Zstandard => Ok(texels(&zstd::inflate(container.level, length)?)),
        _ => Ok(texels(container.level)),
    }
}

/// Takes each channel from where a swizzle, four letters of `rgba01`, says.
pub(super) fn swizzle(pixels: &mut [[u8; 4]], letters: [u8; 4]) {
    if letters == *b"rgba" {
        return;
    }
    for pixel in pixels {
        let [r, g, b, a] = *pixel;
        *pixel = letters.map(|letter| match letter {
            b'r' => r,
            b'g' => g,
            b'b' => b,
            b'a' => a,
            b'1' => 255,
            _ => 0,
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn layouts_put_channels_in_their_places() {
        let texel = |format: u32, bytes: &[u8]| Layout::of(format).map(|l| l.texel(bytes));
        assert_eq!(texel(9, &[1]), Some([1, 0, 0, 255]));
        assert_eq!(texel(16, &[1, 2]), Some([1, 2, 0, 255]));
        assert_eq!(texel(23, &[1, 2, 3]), Some([1, 2, 3, 255]));
        assert_eq!(texel(36, &[1, 2, 3]), Some([3, 2, 1, 255]));
        assert_eq!(texel(44, &[1, 2, 3, 4]), Some([3, 2, 1, 4]));
        assert_eq!(Layout::of(91), None);
    }

    #[test]
    fn swizzles_name_where_channels_come_from() {
        let mut pixels = [[1, 2, 3, 4]];
        swizzle(&mut pixels, *b"ar01");
        assert_eq!(pixels, [[4, 1, 0, 255]]);
    }
}
