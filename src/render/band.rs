//! The film in bands of rows, each small enough for one binding.

use super::error::RenderError;
use super::layout::{FilmPixel, Frame};

const TILE: u32 = 8;

/// A run of rows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Band {
    /// Columns of the picture.
    pub width: u32,
    /// First row.
    pub first_row: u32,
    /// Number of rows.
    pub rows: u32,
}

/// Cuts a picture into bands whose films are at most `limit` bytes each.
///
/// # Errors
/// Eight rows do not fit.
pub fn bands(width: u32, height: u32, limit: u64) -> Result<Vec<Band>, RenderError> {
    let row_bytes = u64::from(width) * size_of::<FilmPixel>() as u64;
    let rows =
        (limit / row_bytes / u64::from(TILE) * u64::from(TILE)).min(u64::from(u32::MAX)) as u32;
    if rows == 0 {
        return Err(RenderError::Setting(format!(
            "a picture {width} pixels wide does not fit the device's buffer bindings of {limit} bytes: ask for a narrower one"
        )));
    }
    Ok((0..height)
        .step_by(rows as usize)
        .map(|first_row| Band {
            width,
            first_row,
            rows: rows.min(height - first_row),
        })
        .collect())
}

impl Band {
    fn tiles_x(&self) -> u32 {
        self.width.div_ceil(TILE)
    }

    /// Number of 8×8 tiles.
    pub fn tile_count(&self) -> u32 {
        self.tiles_x() * self.rows.div_ceil(TILE)
    }

    /// The frame of this band.
    pub fn frame(&self, base: Frame) -> Frame {
        Frame {
            // The last rows of a band's tiles may lie beyond it.
            end_row: self.first_row + self.rows,
            tiles_x: self.tiles_x(),
            tile_step: tile_step(self.tile_count()),
            first_row: self.first_row,
            tile_count: self.tile_count(),
            ..base
        }
    }

    /// Pixels of the picture among `count` work items from `first` on (both multiples of 64).
    pub fn pixels_in(&self, first: u32, count: u32) -> u64 {
        let step = u64::from(tile_step(self.tile_count()));
        let tiles = u64::from(self.tile_count());
        (first / 64..(first + count).div_ceil(64))
            .map(|item| {
                let tile = (u64::from(item) * step % tiles) as u32;
                let (x, y) = (tile % self.tiles_x() * TILE, tile / self.tiles_x() * TILE);
                u64::from((self.width - x).min(TILE)) * u64::from((self.rows - y).min(TILE))
            })
            .sum()
    }
}

/// A step coprime to the number of tiles, near its golden section, so that successive tiles lie
/// far apart; the product of any tile's index with it stays below 2³².
fn tile_step(tiles: u32) -> u32 {
    let largest = (u32::MAX / tiles.max(1)).min(tiles);
    let golden = ((f64::from(largest) * 0.618_034) as u32).max(1);
    (1..=golden)
        .rev()
        .find(|&step| gcd(step, tiles) == 1)
        .unwrap_or(1)
}

fn gcd(a: u32, b: u32) -> u32 {
    if b == 0 { a } else { gcd(b, a % b) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bands_cover_the_picture_once() {
        for (width, height) in [(1, 1), (7, 9), (512, 512), (1920, 1080), (7680, 4320)] {
            let bands = bands(width, height, 1 << 24).expect("fits");
            let rows: u32 = bands.iter().map(|b| b.rows).sum();
            assert_eq!(rows, height);
            let pixels: u64 = bands
                .iter()
                .map(|b| b.pixels_in(0, b.tile_count() * 64))
                .sum();
            assert_eq!(pixels, u64::from(width) * u64::from(height));
        }
    }

    #[test]
    fn too_wide_a_picture_is_refused() {
        assert!(bands(65_536, 1, 1 << 20).is_err());
    }

    #[test]
    fn tile_steps_permute() {
        for tiles in [1, 2, 3, 64, 1000, 65_536, 1 << 20] {
            let step = tile_step(tiles);
            assert_eq!(gcd(step, tiles), 1, "{tiles} tiles");
            assert!(u64::from(step) * u64::from(tiles - 1) <= u64::from(u32::MAX));
        }
    }
}
