//! The environment as the device holds it: texels with their probabilities, and an alias table.

use glam::DVec3;

use super::alias::alias_table;
use crate::scene::EnvironmentImage;

/// Texels and distribution of an equirectangular environment.
#[derive(Debug, Clone, Default)]
pub struct EnvironmentTable {
    /// RGB radiance, and the probability that the texel is chosen.
    pub texels: Vec<[f32; 4]>,
    /// Bits of the alias threshold, and the alias.
    pub alias: Vec<[u32; 2]>,
    /// Mean radiance over the sphere.
    pub mean: DVec3,
}

impl EnvironmentTable {
    /// Builds the distribution in f64. A texel's weight is the luminance that bilinear look-up
    /// gives on average inside of it, times its solid angle: zero only where the radiance is.
    pub fn new(image: &EnvironmentImage) -> Self {
        let weights = weights(image);
        let mean = mean_radiance(image);
        let entries = alias_table(&weights).unwrap_or_default();
        let texels = image
            .texels
            .iter()
            .enumerate()
            .map(|(i, &[r, g, b])| [r, g, b, entries.get(i).map_or(0.0, |e| e.probability)])
            .collect();
        let alias = entries
            .iter()
            .map(|e| [e.threshold.to_bits(), e.alias])
            .collect();
        Self {
            texels,
            alias,
            mean,
        }
    }

    /// Whether it sheds any light.
    pub fn is_black(&self) -> bool {
        self.alias.is_empty()
    }
}

fn luminance([r, g, b]: [f32; 3]) -> f64 {
    0.2126 * f64::from(r) + 0.7152 * f64::from(g) + 0.0722 * f64::from(b)
}

/// Sine of the polar angle in the middle of a row, to which the solid angle of its texels is proportional.
fn sin_theta(row: usize, height: usize) -> f64 {
    (std::f64::consts::PI * (row as f64 + 0.5) / height as f64).sin()
}

fn weights(image: &EnvironmentImage) -> Vec<f64> {
    let (width, height) = (image.width, image.height);
    let at = |x: usize, y: usize| luminance(image.texels[y * width + x]);
    // The mean of a bilinear interpolant over a texel weighs neighbours 1 : 6 : 1 in each direction.
    let row_mean = |x: usize, y: usize| {
        let (left, right) = ((x + width - 1) % width, (x + 1) % width);
        (at(left, y) + 6.0 * at(x, y) + at(right, y)) / 8.0
    };
    (0..height)
        .flat_map(|y| (0..width).map(move |x| (x, y)))
        .map(|(x, y)| {
            let (above, below) = (y.saturating_sub(1), (y + 1).min(height - 1));
            let mean = (row_mean(x, above) + 6.0 * row_mean(x, y) + row_mean(x, below)) / 8.0;
            mean * sin_theta(y, height)
        })
        .collect()
}

fn mean_radiance(image: &EnvironmentImage) -> DVec3 {
    let mut sum = DVec3::ZERO;
    let mut total = 0.0;
    for (y, row) in image.texels.chunks(image.width).enumerate() {
        let weight = sin_theta(y, image.height);
        let row_sum: DVec3 = row.iter().map(|&t| DVec3::from(t.map(f64::from))).sum();
        sum += row_sum * weight;
        total += weight * image.width as f64;
    }
    sum / total
}
