//! What well-spread points and the surface's normal gain.

use glam::Vec3;

use super::{ENVIRONMENT, sunny};
use crate::common::Setup;
use crate::common::lights::Bench;
use crate::common::statistics::mean_and_error;

/// By how much the variance at 64 Sobol samples is at least below that of independent ones.
const SOBOL_GAIN: f64 = 10.0;
/// By how much the variance of independent samples is at least below that of samples that know no normal.
const NORMAL_GAIN: f64 = 10.0;

/// Mean and variance, over pixels, of the light that 64 samples estimate; half of it is the sun's.
fn estimate(both_sides: bool, setup: impl Fn(Setup) -> Setup) -> (f64, f64) {
    const PIXELS: usize = 4096;
    let mut bench = Bench::new(&sunny(1e4), Vec3::ZERO, Vec3::new(0.2, 1.0, 0.1));
    if both_sides {
        bench = bench.both_sides();
    }
    bench.setup = setup(bench.setup);
    let estimates = bench.estimate("estimate_environment", PIXELS, 64);
    let (mean, error) = mean_and_error(estimates.iter().map(|e| f64::from(e[0])));
    (mean, error * error * PIXELS as f64)
}

fn assert_same_mean((mean, variance): (f64, f64), (other, other_variance): (f64, f64)) {
    let error = ((variance + other_variance) / 4096.0).sqrt();
    assert!((mean - other).abs() < 6.0 * error, "{mean} {other}");
}

/// Sobol points keep their order, so that the variance at 64 samples is a small part of that of
/// independent samples; if the numbers are shuffled first, it is not.
#[test]
fn sobol_samples_stay_well_spread() {
    let independent = estimate(true, |setup| setup);
    let sobol = estimate(true, |setup| setup.sampler("sobol"));
    let (_, shuffled) = estimate(true, |setup| {
        let (from, to) = (
            "= environment_choose(bits, normal);",
            "= environment_choose(vec2u(mix32(bits.x), mix32(bits.y)), normal);",
        );
        setup.sampler("sobol").patched(ENVIRONMENT, from, to)
    });
    println!("independent {independent:?}, Sobol {sobol:?}, shuffled {shuffled:e}");
    assert_same_mean(independent, sobol);
    assert!(sobol.1 * SOBOL_GAIN < independent.1);
    assert!(shuffled * SOBOL_GAIN > independent.1);
}

/// The cosine at the surface varies within a block of cells alone, and so does the variance of a table for the normal.
#[test]
fn a_normal_leaves_little_variance() {
    let both_sides = estimate(true, |setup| setup);
    let normal = estimate(false, |setup| setup);
    println!("from both sides {both_sides:?}, for a normal {normal:?}");
    assert_same_mean(both_sides, normal);
    assert!(normal.1 * NORMAL_GAIN < both_sides.1);
}
