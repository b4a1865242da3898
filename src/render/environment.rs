//! The environment as the device holds it: texels with their densities, and the cumulative
//! distributions by which a texel is found.

use std::f64::consts::PI;

use glam::DVec3;
use rayon::prelude::*;

use super::cdf::{fixed_point_cdf, probabilities};
use crate::scene::EnvironmentImage;

/// Texels and distribution of an equirectangular environment.
#[derive(Debug, Clone, Default)]
pub struct EnvironmentTable {
    /// RGB radiance, and the density over (u, v) with which points of the texel are drawn, over 2π².
    pub texels: Vec<[f32; 4]>,
    /// Lower ends of the intervals, in 2⁻³¹: of the rows, then in each row of its columns. Empty if
    /// no texel sheds light.
    pub cdf: Vec<u32>,
    /// Mean radiance over the sphere.
    pub mean: DVec3,
}

impl EnvironmentTable {
    /// Builds the distribution in f64. A texel's weight is the luminance that bilinear look-up
    /// gives on average inside of it, times its solid angle: zero only where the radiance is.
    pub fn new(image: &EnvironmentImage) -> Self {
        let cdf = cdf(image);
        Self {
            texels: texels(image, &cdf),
            cdf,
            mean: mean_radiance(image),
        }
    }

    /// Whether it sheds any light.
    pub fn is_black(&self) -> bool {
        self.cdf.is_empty()
    }
}

fn luminance([r, g, b]: [f32; 3]) -> f64 {
    0.2126 * f64::from(r) + 0.7152 * f64::from(g) + 0.0722 * f64::from(b)
}

/// Sine of the polar angle in the middle of a row, to which the solid angle of its texels is proportional.
fn sin_theta(row: usize, height: usize) -> f64 {
    (PI * (row as f64 + 0.5) / height as f64).sin()
}

/// The marginal distribution of the rows, then the rows' own.
fn cdf(image: &EnvironmentImage) -> Vec<u32> {
    let (width, height) = (image.width, image.height);
    let mut cdf = vec![0; height + width * height];
    let (marginal, conditional) = cdf.split_at_mut(height);
    let sums: Vec<f64> = conditional
        .par_chunks_mut(width)
        .enumerate()
        .map(|(y, row)| fixed_point_cdf(&row_weights(image, y), row))
        .collect();
    if fixed_point_cdf(&sums, marginal) > 0.0 {
        cdf
    } else {
        Vec::new()
    }
}

fn row_weights(image: &EnvironmentImage, y: usize) -> Vec<f64> {
    let (width, height) = (image.width, image.height);
    // The mean of a bilinear interpolant over a texel weighs neighbours 1 : 6 : 1 in each direction.
    let (above, below) = (y.saturating_sub(1), (y + 1).min(height - 1));
    let at = |x: usize, y: usize| luminance(image.texels[y * width + x]);
    let mean = |x: usize| (at(x, above) + 6.0 * at(x, y) + at(x, below)) / 8.0;
    let means: Vec<f64> = (0..width).map(mean).collect();
    let solid_angle = sin_theta(y, height);
    (0..width)
        .map(|x| {
            let (left, right) = ((x + width - 1) % width, (x + 1) % width);
            (means[left] + 6.0 * means[x] + means[right]) / 8.0 * solid_angle
        })
        .collect()
}

/// The device's texels. The densities are those that the distribution realises.
fn texels(image: &EnvironmentImage, cdf: &[u32]) -> Vec<[f32; 4]> {
    let (width, height) = (image.width, image.height);
    let mut texels: Vec<[f32; 4]> = image
        .texels
        .par_iter()
        .map(|&[r, g, b]| [r, g, b, 0.0])
        .collect();
    if cdf.is_empty() {
        return texels;
    }
    let scale = image.texels.len() as f64 / (2.0 * PI * PI);
    let (marginal, conditional) = cdf.split_at(height);
    let rows: Vec<f64> = probabilities(marginal).collect();
    texels
        .par_chunks_mut(width)
        .zip(conditional.par_chunks(width))
        .zip(rows)
        .for_each(|((texels, columns), row)| {
            // The columns of a row that is never chosen mean nothing.
            if row > 0.0 {
                for (texel, column) in texels.iter_mut().zip(probabilities(columns)) {
                    texel[3] = (row * column * scale) as f32;
                }
            }
        });
    texels
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

#[cfg(test)]
mod tests {
    use super::*;

    fn image(
        width: usize,
        height: usize,
        at: impl Fn(usize, usize) -> [f32; 3],
    ) -> EnvironmentImage {
        let texel = |i: usize| at(i % width, i / width);
        EnvironmentImage {
            width,
            height,
            texels: (0..width * height).map(texel).collect(),
        }
    }

    /// Integral of the density over the unit square.
    fn integral(table: &EnvironmentTable) -> f64 {
        let densities = table.texels.iter().map(|t| f64::from(t[3]));
        densities.sum::<f64>() * 2.0 * PI * PI / table.texels.len() as f64
    }

    #[test]
    fn a_single_texel_has_all_of_the_probability() {
        let table = EnvironmentTable::new(&image(1, 1, |_, _| [1.0, 2.0, 3.0]));
        assert_eq!(table.cdf, [0, 0]);
        assert_eq!(table.texels, [[1.0, 2.0, 3.0, (0.5 / (PI * PI)) as f32]]);
    }

    #[test]
    fn black_has_no_distribution() {
        let table = EnvironmentTable::new(&image(3, 2, |_, _| [0.0; 3]));
        assert!(table.is_black());
        assert_eq!(table.texels, [[0.0; 4]; 6]);
    }

    #[test]
    fn light_and_density_are_in_the_same_places() {
        // A sun of 1e6 times the rest; black rows and columns; light that f32 sums would lose.
        let table = EnvironmentTable::new(&image(256, 128, |x, y| match (x, y) {
            (200, 40) => [1e6, 9e5, 8e5],
            (_, 90..) | (20..30, _) => [0.0; 3],
            (100, 80) => [0.0, 1e-30, 0.0],
            _ => [0.5, 0.25, 1.0],
        }));
        assert!(
            (integral(&table) - 1.0).abs() < 1e-6,
            "{}",
            integral(&table)
        );
        for (i, texel) in table.texels.iter().enumerate() {
            let (x, y) = (i % 256, i / 256);
            // One more texel in each direction gets light by interpolation.
            let black = y > 90 || (21..29).contains(&x);
            assert_eq!(texel[3] == 0.0, black, "column {x}, row {y}");
        }
    }
}
