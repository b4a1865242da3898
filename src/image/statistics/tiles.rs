//! Pictures cut into square tiles, each with its mean and the mean's variance.

use super::MeanImage;
use super::welch::Estimate;

/// One tile of one channel, in both pictures.
pub(super) struct Tile {
    /// Left column.
    pub x: usize,
    /// Top row.
    pub y: usize,
    /// Columns; fewer at the right edge.
    pub width: usize,
    /// Rows; fewer at the bottom.
    pub height: usize,
    /// 0, 1, 2: red, green, blue.
    pub channel: usize,
    /// Means of either picture.
    pub estimates: [Estimate; 2],
}

/// Every tile of every channel.
pub(super) fn all<'a>(
    images: [&'a MeanImage<'a>; 2],
    (width, height): (usize, usize),
    tile: usize,
) -> impl Iterator<Item = Tile> + 'a {
    let corners = (0..height)
        .step_by(tile)
        .flat_map(move |y| (0..width).step_by(tile).map(move |x| (x, y)));
    corners.flat_map(move |(x, y)| {
        let (w, h) = (tile.min(width - x), tile.min(height - y));
        (0..3).map(move |channel| {
            let indices = || {
                let rows = (y..y + h).map(move |row| row * width);
                rows.flat_map(move |row| (row + x..row + x + w).map(move |i| 3 * i + channel))
            };
            Tile {
                x,
                y,
                width: w,
                height: h,
                channel,
                estimates: images.map(|image| estimate(image, indices(), (w * h) as f64)),
            }
        })
    })
}

/// Pixels are independent, so the tile's variance is the sum of theirs over n², and
/// its degrees of freedom follow from Welch and Satterthwaite: (Σv)² / Σ(v²/ν).
fn estimate(image: &MeanImage, indices: impl Iterator<Item = usize>, n: f64) -> Estimate {
    let (mut mean, mut variance, mut squares) = (0.0, 0.0, 0.0);
    for index in indices {
        let v = f64::from(image.variance_of_mean[index]);
        mean += f64::from(image.mean[index]);
        variance += v;
        squares += v * v;
    }
    let pixels = if squares > 0.0 {
        variance * variance / squares
    } else {
        n
    };
    Estimate {
        mean: mean / n,
        variance: variance / (n * n),
        degrees_of_freedom: image.degrees_of_freedom * pixels,
    }
}
