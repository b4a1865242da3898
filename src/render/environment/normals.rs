//! Which block of an environment to choose, for a surface with a given normal: in proportion to the light that comes
//! from it times the cosine at the surface. So no sample is lost below the horizon, and few near it.

use std::f64::consts::PI;
use std::ops::Range;

use glam::{DVec2, DVec3};
use rayon::prelude::*;

use super::distribution::Grid;
use super::row_span;
use crate::render::cdf::{fixed_point_cdf, probabilities};

/// Normals are told apart on a square of this many cells a side, the octahedral map of the sphere.
const NORMALS: usize = 16;
/// A table for each, and one for what receives light from all sides.
pub const TABLES: usize = NORMALS * NORMALS + 1;

/// A quarter of a block: what it sheds, and where it is.
struct Quarter {
    block: usize,
    weight: f64,
    direction: DVec3,
    /// Farthest that a direction in it may be from `direction`, as points of the unit sphere.
    radius: f64,
}

/// The tables of [`Grid`], given the weights of the halves of blocks in each row of cells.
pub fn tables(grid: Grid, halves: &[Vec<f64>]) -> Vec<u32> {
    let quarters = quarters(grid, halves);
    let normal = |index: usize| (index + 1 < TABLES).then(|| normal_of(index));
    let tables = (0..TABLES).into_par_iter();
    tables
        .flat_map_iter(|index| table(grid, &quarters, normal(index)))
        .collect()
}

fn quarters(grid: Grid, halves: &[Vec<f64>]) -> Vec<Quarter> {
    let (columns, rows) = (grid.columns.halves(), grid.rows.halves());
    let places =
        (0..rows.runs()).flat_map(|row| (0..columns.runs()).map(move |column| (column, row)));
    let quarter = |(column, row)| {
        let cells = rows.cells_of(row);
        let weight: f64 = halves[cells.clone()].iter().map(|r| r[column]).sum();
        (weight > 0.0).then(|| Quarter::new(grid, columns.cells_of(column), cells, weight))
    };
    places.filter_map(quarter).collect()
}

impl Quarter {
    fn new(grid: Grid, columns: Range<usize>, rows: Range<usize>, weight: f64) -> Self {
        let block_row = grid.rows.run_of(rows.start);
        let (width, height) = (grid.columns.count as f64, grid.rows.count - 1);
        let ends = [
            row_span(rows.start, height).0,
            row_span(rows.end - 1, height).1,
        ];
        let v = ends.map(|row| row / height as f64);
        let u = [columns.start, columns.end].map(|column| (column as f64 + 0.5) / width);
        // A parallel is nowhere longer than the equator.
        let half = DVec2::new(PI * (u[1] - u[0]), 0.5 * PI * (v[1] - v[0]));
        Self {
            block: block_row * grid.columns.runs() + grid.columns.run_of(columns.start),
            weight,
            direction: direction(0.5 * (u[0] + u[1]), 0.5 * (v[0] + v[1])),
            radius: 2.0 * (0.5 * half.length().min(PI)).sin(),
        }
    }
}

fn direction(u: f64, v: f64) -> DVec3 {
    let (phi, theta) = (2.0 * PI * u - PI, PI * v);
    DVec3::new(
        theta.sin() * phi.cos(),
        theta.cos(),
        theta.sin() * phi.sin(),
    )
}

/// Middle of the normals of a table, and how far from it they may be.
fn normal_of(index: usize) -> (DVec3, f64) {
    let at = |x: f64, y: f64| {
        let cell = DVec2::new((index % NORMALS) as f64 + x, (index / NORMALS) as f64 + y);
        octahedral(2.0 * cell / NORMALS as f64 - 1.0)
    };
    let middle = at(0.5, 0.5);
    let corners = [at(0.0, 0.0), at(1.0, 0.0), at(0.0, 1.0), at(1.0, 1.0)];
    let radius = corners
        .iter()
        .map(|c| c.distance(middle))
        .fold(0.0, f64::max);
    (middle, 1.05 * radius)
}

/// The direction of a point of the square [-1, 1]².
fn octahedral(p: DVec2) -> DVec3 {
    let z = 1.0 - p.x.abs() - p.y.abs();
    let below = (-z).max(0.0);
    DVec3::new(p.x - below.copysign(p.x), p.y - below.copysign(p.y), z).normalize()
}

fn table(grid: Grid, quarters: &[Quarter], normal: Option<(DVec3, f64)>) -> Vec<u32> {
    let columns = grid.columns.runs();
    let mut weights = vec![0.0; grid.blocks()];
    for quarter in quarters {
        let cosine = normal.map_or(1.0, |(n, radius)| {
            mean_cosine(n.dot(quarter.direction), quarter.radius + radius)
        });
        weights[quarter.block] += quarter.weight * cosine;
    }
    let mut table = vec![0; grid.table_length()];
    let (of_rows, rest) = table.split_at_mut(grid.rows.runs());
    let (of_blocks, chances) = rest.split_at_mut(grid.blocks());
    let sums: Vec<f64> = weights
        .chunks(columns)
        .zip(of_blocks.chunks_mut(columns))
        .map(|(weights, ends)| fixed_point_cdf(weights, ends))
        .collect();
    fixed_point_cdf(&sums, of_rows);
    for (row, p) in probabilities(of_rows).enumerate() {
        // The blocks of a row that is never chosen mean nothing.
        if sums[row] > 0.0 {
            let blocks = row * columns..(row + 1) * columns;
            let of_row = probabilities(&of_blocks[blocks.clone()]);
            for (chance, q) in chances[blocks].iter_mut().zip(of_row) {
                *chance = ((p * q) as f32).to_bits();
            }
        }
    }
    table
}

/// About the mean of the cosine, or 0 below the horizon, at most `radius` around where it is `cosine`; 0 only if all
/// of it is below.
fn mean_cosine(cosine: f64, radius: f64) -> f64 {
    if cosine >= radius {
        cosine
    } else {
        (cosine + radius).max(0.0).powi(2) / (4.0 * radius)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cosine_is_0_only_below_the_horizon() {
        for radius in [1e-6, 0.01, 0.5, 2.0] {
            assert_eq!(mean_cosine(-radius, radius), 0.0);
            assert_eq!(mean_cosine(-1.0 - radius, radius), 0.0);
            assert!(mean_cosine(-0.999 * radius, radius) > 0.0);
            assert_eq!(mean_cosine(radius, radius), radius);
        }
        assert_eq!(mean_cosine(0.7, 0.1), 0.7);
    }

    #[test]
    fn the_normals_of_all_tables_cover_the_sphere() {
        let middles: Vec<(DVec3, f64)> = (0..TABLES - 1).map(normal_of).collect();
        for i in 0..10_000 {
            // A spiral of even points.
            let z = 1.0 - (2.0 * f64::from(i) + 1.0) / 10_000.0;
            let (sin, cos) = (2.4 * f64::from(i)).sin_cos();
            let r = (1.0 - z * z).sqrt();
            let normal = DVec3::new(r * cos, r * sin, z);
            assert!(
                middles
                    .iter()
                    .any(|(m, radius)| m.distance(normal) < *radius)
            );
        }
    }
}
