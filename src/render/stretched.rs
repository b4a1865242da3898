//! Albedo of stretched GGX lobes, as `shaders/bsdf/albedo.wgsl` looks it up: by the cosine of the direction, its
//! azimuth, the roughness across the stretch and how far that along it goes beyond.

use glam::DVec3;
use rayon::prelude::*;

use super::microfacets::stretched_reflection;

/// Values along each axis, the first the fastest: cosines (i / (n - 1))⁴; cosines of the azimuth from the stretch,
/// (i / (n - 1))²; roughnesses across, (i / (n - 1))²; and the root of the roughness along, i / (n - 1) of its way from
/// that across to 1.
const SIZES: [usize; 4] = [24, 8, 16, 8];
/// Nodes of the quadrature along the sides of the unit square.
const NODES: [usize; 2] = [48, 24];

/// What values are raised by, so that where interpolation finds too little no lobe is taken to lose more than it does,
/// which would let it gain.
const MARGIN: f64 = 1.008;

/// Number of values.
pub const COUNT: usize = SIZES[0] * SIZES[1] * SIZES[2] * SIZES[3];

/// All values.
pub fn table() -> Vec<f32> {
    let raised = |i| (MARGIN * value(place(i))).min(1.0) as f32;
    (0..COUNT).into_par_iter().map(raised).collect()
}

/// Where a value is, along each axis from 0 to 1.
fn place(index: usize) -> [f64; 4] {
    let mut rest = index;
    SIZES.map(|n| {
        let i = rest % n;
        rest /= n;
        i as f64 / (n - 1) as f64
    })
}

/// The albedo at a place.
fn value([cosine, azimuth, across, along]: [f64; 4]) -> f64 {
    let cosine = cosine.powi(4).max(1e-6);
    let azimuth = azimuth.powi(2);
    let along = (across + along * (1.0 - across)).powi(4);
    let sine = (1.0 - cosine * cosine).sqrt();
    let wo = DVec3::new(
        sine * azimuth,
        sine * (1.0 - azimuth * azimuth).sqrt(),
        cosine,
    );
    mean([along, across.powi(4)], wo)
}

/// Mean over the unit square by midpoints.
fn mean(alpha: [f64; 2], wo: DVec3) -> f64 {
    let [columns, rows] = NODES;
    let at = |i: usize, n: usize| (i as f64 + 0.5) / n as f64;
    let row = |j: usize| -> f64 {
        let v = at(j, rows);
        (0..columns)
            .map(|i| stretched_reflection(alpha, wo, [at(i, columns), v]))
            .sum()
    };
    (0..rows).map(row).sum::<f64>() / (columns * rows) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What the shader does between the values.
    fn look_up(table: &[f32], at: [f64; 4]) -> f64 {
        let mut sum = 0.0;
        for corner in 0..16_usize {
            let (mut weight, mut index, mut step) = (1.0, 0, 1);
            for (axis, n) in SIZES.into_iter().enumerate() {
                let x = at[axis] * (n - 1) as f64;
                let low = (x as usize).min(n - 2);
                let up = corner >> axis & 1;
                let f = x - low as f64;
                weight *= if up == 1 { f } else { 1.0 - f };
                index += (low + up) * step;
                step *= n;
            }
            sum += weight * f64::from(table[index]);
        }
        sum
    }

    /// Beyond cosines of 0.002 and roughnesses of 0.04, where lobes change faster than the table can tell, 98 of 100 look-ups
    /// are off by -1 to +3 %.
    #[test]
    fn values_in_between_are_a_little_high() {
        let table = table();
        let mut ratios = Vec::new();
        // The fractional parts of multiples of irrational numbers are spread evenly.
        for i in 0..4000 {
            let at = [0.754_877_666, 0.569_840_291, 0.618_033_988, 0.414_213_562]
                .map(|step: f64| (f64::from(i) * step).fract());
            if at[0] > 0.21 && at[2] > 0.2 {
                ratios.push(look_up(&table, at) / value(at));
            }
        }
        ratios.sort_by(f64::total_cmp);
        let (low, high) = (ratios[ratios.len() / 100], ratios[ratios.len() * 99 / 100]);
        println!(
            "{low} to {high}, all within {} to {}",
            ratios[0],
            ratios[ratios.len() - 1]
        );
        assert!(low > 0.99 && high < 1.03, "{low} {high}");
    }
}
