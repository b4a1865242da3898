//! Maps from the unit square on the device: samples against densities. The rate of false alarms is
//! stated in common/statistics.rs.

use std::f64::consts::{PI, TAU};

use crate::common::grid::{SphereGrid, even_grid};
use crate::common::lights::xyz;
use crate::common::statistics::*;
use crate::common::*;
use glam::Vec3;

fn check_directions(name: &str, samples: &[[f32; 3]], density: &[f64], weights: &[f64]) {
    let grid = even_grid();
    let expected = SphereGrid::integrate(weights, density.iter().copied());
    let total: f64 = expected.iter().sum();
    assert!(
        (total - 1.0).abs() < 1e-6,
        "{name}: the density integrates to {total}"
    );
    let (counts, lost) = grid.histogram(samples);
    assert_fits(name, &counts, &expected, lost);
    // Negative control: the same samples as if their density were a little tilted.
    let tilted: Vec<f64> = expected
        .iter()
        .enumerate()
        .map(|(i, p)| p * (1.0 + 0.2 * ((i % 48) as f64 / 47.0 - 0.5)))
        .collect();
    assert_rejected(name, &counts, &tilted, lost);
    let longest = samples
        .iter()
        .map(|d| (Vec3::from(*d).length() - 1.0).abs())
        .fold(0.0, f32::max);
    assert!(longest < 3e-7, "{name}: a length is off by {longest:e}");
}

#[test]
fn maps_of_the_unit_square_follow_their_densities() {
    let setup = Setup::new();
    let sample = setup.kernel("maps", "sample");
    let drawn: Vec<[[f32; 4]; 4]> = sample.run(SAMPLES, [1, 0, 0], &[0u32], SAMPLES as usize, &[]);

    // The disc in polar coordinates, where its area element is even in the square of the radius.
    let polar = drawn.iter().map(|d| {
        let [x, y] = [d[0][0], d[0][1]].map(f64::from);
        assert!(x * x + y * y <= 1.0 + 1e-6);
        let turn = (y.atan2(x) / TAU).rem_euclid(1.0);
        [(x * x + y * y).min(1.0 - 1e-12), turn.min(1.0 - 1e-12)]
    });
    assert_uniform("disc", 48, polar);

    // The triangle, folded to a square in which it is uniform: 1 - b0 is the root of a uniform number.
    let folded = drawn.iter().map(|d| {
        let b = [d[0][2], d[0][3], d[1][3]].map(f64::from);
        assert!(b.iter().all(|b| *b >= 0.0) && (b.iter().sum::<f64>() - 1.0).abs() < 3e-7);
        let s = 1.0 - b[0];
        [
            (s * s).min(1.0 - 1e-12),
            (b[2] / s.max(1e-12)).min(1.0 - 1e-12),
        ]
    });
    assert_uniform("triangle", 48, folded);

    let (directions, weights) = even_grid().points();
    let n = directions.len();
    let kernel = setup.kernel("maps", "density");
    let density: Vec<[f32; 4]> = kernel.run(n as u32, [0; 3], &directions, n, &[]);
    let cosine: Vec<f64> = density.iter().map(|d| f64::from(d[0])).collect();
    // The uniform density is that of the hemisphere only.
    let upper: Vec<f64> = directions
        .iter()
        .zip(&density)
        .map(|(d, p)| if d[2] > 0.0 { f64::from(p[1]) } else { 0.0 })
        .collect();
    let samples = |i: usize| -> Vec<[f32; 3]> { drawn.iter().map(|d| xyz(&d[i])).collect() };
    check_directions("cosine hemisphere", &samples(1), &cosine, &weights);
    check_directions("uniform hemisphere", &samples(2), &upper, &weights);
    check_directions("uniform sphere", &samples(3), &vec![0.25 / PI; n], &weights);
}
