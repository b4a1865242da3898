//! The environment as the device holds it: texels with densities, and the cumulative distributions
//! by which a cell between texels is found.

use std::f64::consts::PI;

use glam::DVec3;
use rayon::prelude::*;

use super::cdf::probabilities;
use super::emission::luminance;
use crate::scene::EnvironmentImage;
use distribution::{Grid, distribution};

mod distribution;
mod normals;

/// Texels and distribution of an equirectangular environment.
///
/// What is chosen is a cell between the centres of four texels, in which radiance is bilinear: as
/// many columns of cells as of texels, the last between the last and the first, and one row more,
/// the first and the last of half a texel, at the poles, where radiance depends on the column alone.
#[derive(Debug, Clone, Default)]
pub struct EnvironmentTable {
    /// RGB radiance, and the mean density over (u, v) with which points of the cell to the right
    /// and below are drawn once its block is chosen, over 2π². The first and the last row are there twice, as the
    /// poles' own.
    pub texels: Vec<[f32; 4]>,
    /// What a cell is chosen by (see [`Grid`]). Empty if no texel sheds light.
    pub cdf: Vec<u32>,
    /// Mean radiance over the sphere.
    pub mean: DVec3,
}

impl EnvironmentTable {
    /// Builds the distribution in f64. A cell's weight is its mean luminance times its solid
    /// angle: zero only where the radiance is.
    pub fn new(image: &EnvironmentImage) -> Self {
        let cdf = distribution(image);
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

/// Sine of the polar angle in the middle of a row, to which the solid angle of its texels is proportional.
fn sin_theta(row: usize, height: usize) -> f64 {
    (PI * (row as f64 + 0.5) / height as f64).sin()
}

/// Where a row of cells begins and ends, in rows of texels from the top.
fn row_span(row: usize, height: usize) -> (f64, f64) {
    let middle = row as f64;
    ((middle - 0.5).max(0.0), (middle + 0.5).min(height as f64))
}

fn row_weights(image: &EnvironmentImage, row: usize) -> Vec<f64> {
    let (width, height) = (image.width, image.height);
    let (above, below) = (row.saturating_sub(1), row.min(height - 1));
    let at =
        |x: usize, y: usize| luminance(DVec3::from(image.texels[y * width + x].map(f64::from)));
    let means: Vec<f64> = (0..width)
        .map(|x| 0.5 * (at(x, above) + at(x, below)))
        .collect();
    // cos(a) - cos(b), without its cancellation.
    let (a, b) = row_span(row, height);
    let angle = |rows: f64| 0.5 * PI * rows / height as f64;
    let solid_angle = 2.0 * angle(a + b).sin() * angle(b - a).sin();
    (0..width)
        .map(|x| 0.5 * (means[x] + means[(x + 1) % width]) * solid_angle)
        .collect()
}

/// The device's texels. The densities are those that the distribution realises.
fn texels(image: &EnvironmentImage, cdf: &[u32]) -> Vec<[f32; 4]> {
    let (width, height) = (image.width, image.height);
    let grid = Grid::new(image);
    let mut texels = vec![[0.0; 4]; width * (height + 2)];
    texels
        .par_chunks_mut(width)
        .enumerate()
        .for_each(|(row, texels)| {
            let y = row.saturating_sub(1).min(height - 1);
            for (texel, [r, g, b]) in texels.iter_mut().zip(&image.texels[y * width..]) {
                *texel = [*r, *g, *b, 0.0];
            }
            if row < grid.rows.count && !cdf.is_empty() {
                write_densities(grid, cdf, row, texels);
            }
        });
    texels
}

/// Of the cells of a row.
fn write_densities(grid: Grid, cdf: &[u32], row: usize, texels: &mut [[f32; 4]]) {
    let (width, height) = (grid.columns.count, grid.rows.count - 1);
    let (a, b) = row_span(row, height);
    let area = (b - a) / (width as f64 * height as f64);
    for block in 0..grid.columns.runs() {
        let p = grid.row_probability(cdf, block, row);
        // The columns of a row that is never chosen mean nothing.
        if p > 0.0 {
            let columns = grid.columns.cells_of(block);
            let cells = &cdf[row * width..][columns.clone()];
            for (texel, q) in texels[columns].iter_mut().zip(probabilities(cells)) {
                texel[3] = (p * q / (area * 2.0 * PI * PI)) as f32;
            }
        }
    }
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

    /// Integral of the density, for the normals of each table, over the unit square.
    fn integrals(table: &EnvironmentTable, image: &EnvironmentImage) -> Vec<f64> {
        let grid = Grid::new(image);
        let columns = grid.columns.runs();
        let mut of_blocks = vec![0.0; grid.blocks()];
        for row in 0..grid.rows.count {
            let (a, b) = row_span(row, image.height);
            for column in 0..columns {
                let cells = &table.texels[row * image.width..][grid.columns.cells_of(column)];
                let densities = cells.iter().map(|t| f64::from(t[3]));
                let block = grid.rows.run_of(row) * columns + column;
                of_blocks[block] += densities.sum::<f64>() * (b - a);
            }
        }
        let area = 2.0 * PI * PI / (image.width * image.height) as f64;
        let length = grid.table_length();
        let tables = &table.cdf[table.cdf.len() - length * normals::TABLES..];
        let chance = |word: &u32| f64::from(f32::from_bits(*word)) * area;
        let integral = |table: &[u32]| {
            let chances = table[length - grid.blocks()..].iter().map(chance);
            chances.zip(&of_blocks).map(|(p, d)| p * d).sum()
        };
        tables.chunks(length).map(integral).collect()
    }

    #[test]
    fn a_single_texel_has_all_of_the_probability() {
        let image = image(1, 1, |_, _| [1.0, 2.0, 3.0]);
        let table = EnvironmentTable::new(&image);
        for integral in integrals(&table, &image) {
            assert!((integral - 1.0).abs() < 1e-6, "{integral}");
        }
        // Two blocks of half a texel, each with all of its own density.
        let cell = [1.0, 2.0, 3.0, (1.0 / (PI * PI)) as f32];
        assert_eq!(table.texels, [cell, cell, [1.0, 2.0, 3.0, 0.0]]);
    }

    #[test]
    fn black_has_no_distribution() {
        let table = EnvironmentTable::new(&image(3, 2, |_, _| [0.0; 3]));
        assert!(table.is_black());
        assert_eq!(table.texels, [[0.0; 4]; 12]);
    }

    #[test]
    fn light_and_density_are_in_the_same_places() {
        // A sun of 1e6 times the rest; black rows and columns; light that f32 sums would lose.
        let (width, height) = (256, 128);
        let image = image(width, height, |x, y| match (x, y) {
            (200, 40) => [1e6, 9e5, 8e5],
            (_, 90..) | (20..30, _) => [0.0; 3],
            (100, 80) => [0.0, 1e-30, 0.0],
            _ => [0.5, 0.25, 1.0],
        });
        let table = EnvironmentTable::new(&image);
        for integral in integrals(&table, &image) {
            assert!((integral - 1.0).abs() < 1e-5, "{integral}");
        }
        let is_black = |x: usize, y: usize| image.texels[y * width + x] == [0.0; 3];
        for row in 0..=height {
            for x in 0..width {
                let (above, below) = (row.saturating_sub(1), row.min(height - 1));
                let right = (x + 1) % width;
                let corners = [(x, above), (right, above), (x, below), (right, below)];
                let black = corners.iter().all(|&(x, y)| is_black(x, y));
                let density = table.texels[row * width + x][3];
                assert_eq!(density == 0.0, black, "column {x}, row {row}");
            }
        }
    }
}
