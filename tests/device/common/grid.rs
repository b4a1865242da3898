//! Cells over the sphere, and quadrature inside of them.

use glam::{DMat3, DVec3};
use rayon::prelude::*;

/// Abscissae and weights of Gauss-Legendre quadrature with 4 points on [-1, 1]
/// (Abramowitz & Stegun, table 25.4).
const GAUSS: [(f64, f64); 4] = [
    (-0.861_136_311_594_052_6, 0.347_854_845_137_453_85),
    (-0.339_981_043_584_856_26, 0.652_145_154_862_546_1),
    (0.339_981_043_584_856_26, 0.652_145_154_862_546_1),
    (0.861_136_311_594_052_6, 0.347_854_845_137_453_85),
];

/// Quadrature points of a cell.
pub const POINTS: usize = GAUSS.len() * GAUSS.len();

/// A product of edges in 1 - cos(theta), 0 at the pole and 2 opposite, and in azimuth.
pub struct SphereGrid {
    /// Rising edges of 1 - cos(theta).
    pub nu: Vec<f64>,
    /// Rising edges of the azimuth, 2π from first to last.
    pub phi: Vec<f64>,
    /// Columns: azimuth 0, azimuth π/2, the pole.
    pub axes: DMat3,
}

impl SphereGrid {
    pub fn cells(&self) -> usize {
        (self.nu.len() - 1) * (self.phi.len() - 1)
    }

    /// The quadrature points, [`POINTS`] for each cell in turn, and their weights in solid angle.
    pub fn points(&self) -> (Vec<[f32; 4]>, Vec<f64>) {
        let mut directions = Vec::with_capacity(self.cells() * POINTS);
        let mut weights = Vec::with_capacity(directions.capacity());
        // In theta, where also a density over (theta, phi) is smooth at the poles.
        let theta: Vec<f64> = self.nu.iter().map(|nu| angle(*nu)).collect();
        for theta in theta.windows(2) {
            for phi in self.phi.windows(2) {
                let half = [0.5 * (theta[1] - theta[0]), 0.5 * (phi[1] - phi[0])];
                for (x, wx) in GAUSS {
                    for (y, wy) in GAUSS {
                        let theta = 0.5 * (theta[0] + theta[1]) + half[0] * x;
                        let phi = 0.5 * (phi[0] + phi[1]) + half[1] * y;
                        let d = self.axes * direction(theta, phi);
                        directions.push(d.as_vec3().extend(0.0).to_array());
                        weights.push(wx * wy * half[0] * half[1] * theta.sin());
                    }
                }
            }
        }
        (directions, weights)
    }

    /// The same with each interval cut in `n`.
    pub fn refined(&self, n: usize) -> Self {
        let cut = |edges: &[f64]| {
            let mut all = vec![edges[0]];
            for e in edges.windows(2) {
                all.extend(even(e[0], e[1], n).into_iter().skip(1));
            }
            all
        };
        Self {
            nu: cut(&self.nu),
            phi: cut(&self.phi),
            axes: self.axes,
        }
    }

    /// Integrals over the cells from those over the cells of `refined(n)`.
    pub fn gathered(&self, n: usize, refined: &[f64]) -> Vec<f64> {
        let columns = self.phi.len() - 1;
        let mut cells = vec![0.0; self.cells()];
        for (i, value) in refined.iter().enumerate() {
            let (row, column) = (i / (n * columns), i % (n * columns));
            cells[row / n * columns + column / n] += value;
        }
        cells
    }

    /// Integrals over the cells of a function known at the points.
    pub fn integrate(weights: &[f64], values: impl Iterator<Item = f64>) -> Vec<f64> {
        let terms: Vec<f64> = weights.iter().zip(values).map(|(w, v)| w * v).collect();
        terms.chunks(POINTS).map(|c| c.iter().sum()).collect()
    }

    /// Counts directions in the cells; those of no length are lost and counted apart.
    pub fn histogram(&self, directions: &[[f32; 3]]) -> (Vec<u32>, u32) {
        let to_local = self.axes.transpose();
        let count = |chunk: &[[f32; 3]]| {
            let mut counts = vec![0; self.cells() + 1];
            for d in chunk {
                counts[self.cell(to_local * DVec3::from(d.map(f64::from)))] += 1;
            }
            counts
        };
        let add = |a: Vec<u32>, b: Vec<u32>| a.iter().zip(b).map(|(a, b)| a + b).collect();
        let empty = || vec![0; self.cells() + 1];
        let mut counts = directions.par_chunks(1 << 16).map(count).reduce(empty, add);
        let lost = counts.pop().unwrap_or_default();
        (counts, lost)
    }

    fn cell(&self, d: DVec3) -> usize {
        let r = d.length();
        if r < 0.5 {
            return self.cells();
        }
        // Near the poles the cosine has no digits left for its distance from 1 and -1.
        let flat = d.x * d.x + d.y * d.y;
        let from_pole = flat / (r * (r + d.z.abs()));
        let nu = if d.z > 0.0 {
            from_pole
        } else {
            2.0 - from_pole
        };
        let turn = std::f64::consts::TAU;
        let phi = self.phi[0] + (d.y.atan2(d.x) - self.phi[0]).rem_euclid(turn);
        interval(&self.nu, nu) * (self.phi.len() - 1) + interval(&self.phi, phi)
    }
}

/// The interval between edges that holds x, or the nearest.
fn interval(edges: &[f64], x: f64) -> usize {
    edges.partition_point(|e| *e <= x).clamp(1, edges.len() - 1) - 1
}

/// theta of 1 - cos(theta), with all digits near the pole.
fn angle(nu: f64) -> f64 {
    2.0 * (0.5 * nu).sqrt().min(1.0).asin()
}

fn direction(theta: f64, phi: f64) -> DVec3 {
    let r = theta.sin();
    DVec3::new(r * phi.cos(), r * phi.sin(), theta.cos())
}

/// `n` equal intervals.
pub fn even(from: f64, to: f64, n: usize) -> Vec<f64> {
    (0..=n)
        .map(|i| from + (to - from) * i as f64 / n as f64)
        .collect()
}

/// `n` intervals, about as wide as the width of a centre near it, and wider in proportion to their distance from it
/// elsewhere.
pub fn clustered_about(from: f64, to: f64, centers: &[(f64, f64)], n: usize) -> Vec<f64> {
    let y = |x: f64| -> f64 {
        let terms = centers.iter().map(|(c, width)| ((x - c) / width).asinh());
        terms.sum()
    };
    if centers.is_empty() {
        return even(from, to, n);
    }
    let inverse = |target: f64| {
        let (mut low, mut high) = (from, to);
        for _ in 0..80 {
            let middle = 0.5 * (low + high);
            if y(middle) < target {
                low = middle;
            } else {
                high = middle;
            }
        }
        0.5 * (low + high)
    };
    let mut edges: Vec<f64> = even(y(from), y(to), n).into_iter().map(inverse).collect();
    (edges[0], edges[n]) = (from, to);
    edges
}

/// Cells of equal size about +z, with an edge at the equator.
pub fn even_grid() -> SphereGrid {
    SphereGrid {
        nu: even(0.0, 2.0, 40),
        phi: even(-std::f64::consts::PI, std::f64::consts::PI, 48),
        axes: DMat3::IDENTITY,
    }
}
