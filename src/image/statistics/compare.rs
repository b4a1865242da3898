//! The test of one render against another.

use super::tiles::{self, Tile};
use super::verdict::{Outcome, Verdict};
use super::welch::{self, Estimate};
use super::{StatisticsError, student};

/// Relative difference below which two means count as equal: what f32 rounding
/// does to a mean, in storage and in other programs' sums. Differences are tested
/// against this interval, not against 0, so that a pixel without noise (a lamp
/// seen directly) does not fail over its last bits.
pub(super) const ROUNDING: f64 = 1e-5;

/// A picture of means with the variance of each, interleaved R, G, B.
#[derive(Debug, Clone, Copy)]
pub struct MeanImage<'a> {
    /// Mean of each pixel and channel.
    pub mean: &'a [f32],
    /// Variance of that mean (not of a sample).
    pub variance_of_mean: &'a [f32],
    /// Degrees of freedom of each variance: number of samples (or batches) minus 1.
    pub degrees_of_freedom: f64,
}

/// Whether two renders have the same expectation, from means and variances of the means.
///
/// The variances are taken as known (a normal test). Where they were estimated
/// from few samples or batches, [`compare`] takes that into account; for tiles of
/// 64 pixels and more the two hardly differ.
///
/// # Errors
/// Arrays that are not width × height × 3, negative variances, or a tile of 0.
#[allow(clippy::too_many_arguments)] // One call with all that a test has at hand.
pub fn compare_means(
    mean_a: &[f32],
    var_of_mean_a: &[f32],
    mean_b: &[f32],
    var_of_mean_b: &[f32],
    width: usize,
    height: usize,
    tile: usize,
    alpha: f64,
) -> Result<Verdict, StatisticsError> {
    let known = |mean, variance_of_mean| MeanImage {
        mean,
        variance_of_mean,
        degrees_of_freedom: f64::INFINITY,
    };
    let (a, b) = (known(mean_a, var_of_mean_a), known(mean_b, var_of_mean_b));
    compare(&a, &b, (width, height), tile, alpha)
}

/// Whether two renders have the same expectation.
///
/// Welch's t test on the mean of each tile (`tile` × `tile` pixels, 1 for single
/// pixels) and channel; the family fails if any test does, with a false-alarm
/// rate of at most `alpha` in all (Šidák). Pixels must be independent: no filter
/// wider than a pixel, no shared samples. Their means must be nearly normal: with few
/// samples and rare bright paths a pixel's mean and its variance err together, and
/// single pixels give false alarms; tiles cure that. What is not finite fails.
///
/// # Errors
/// As [`compare_means`], or an alpha outside (0, 1).
pub fn compare(
    a: &MeanImage,
    b: &MeanImage,
    (width, height): (usize, usize),
    tile: usize,
    alpha: f64,
) -> Result<Verdict, StatisticsError> {
    check(a, width.saturating_mul(height).saturating_mul(3))?;
    check(b, width.saturating_mul(height).saturating_mul(3))?;
    let in_range = |name, value, is_right: bool, expected| match is_right {
        true => Ok(()),
        false => Err(StatisticsError::OutOfRange {
            name,
            value,
            expected,
        }),
    };
    in_range("tile", tile as f64, tile > 0, "at least 1")?;
    in_range(
        "alpha",
        alpha,
        alpha > 0.0 && alpha < 1.0,
        "between 0 and 1",
    )?;
    let tiles = tiles::all([a, b], (width, height), tile);
    let outcomes: Vec<Outcome> = tiles.map(outcome).collect();
    Ok(Verdict::new(&outcomes, alpha))
}

fn check(image: &MeanImage, samples: usize) -> Result<(), StatisticsError> {
    let arrays = [
        ("the mean", image.mean),
        ("the variance", image.variance_of_mean),
    ];
    for (name, array) in arrays {
        if array.len() != samples || samples == 0 {
            return Err(StatisticsError::SizeMismatch {
                name,
                found: array.len(),
                expected: samples.max(3),
            });
        }
    }
    match image.variance_of_mean.iter().find(|v| **v < 0.0) {
        Some(&v) => Err(StatisticsError::OutOfRange {
            name: "a variance",
            value: v.into(),
            expected: "at least 0",
        }),
        None => Ok(()),
    }
}

fn outcome(tile: Tile) -> Outcome {
    let [a, b] = tile.estimates;
    let slack = ROUNDING * a.mean.abs().max(b.mean.abs());
    let difference = a.mean - b.mean;
    // Test the part of the difference that rounding does not explain.
    let excess = difference.signum() * (difference.abs() - slack).max(0.0);
    let shifted = Estimate {
        mean: if difference.abs() <= slack {
            0.0
        } else {
            excess
        },
        ..a
    };
    let zero = Estimate { mean: 0.0, ..b };
    Outcome {
        welch: welch::test(&shifted, &zero),
        tile,
    }
}

/// Standard errors that a difference must have, to be found with probability
/// `power` by a two-sided test of level `alpha`.
pub(super) fn detectable(alpha: f64, power: f64, degrees_of_freedom: f64) -> f64 {
    student::upper_quantile(0.5 * alpha, degrees_of_freedom)
        + student::upper_quantile(1.0 - power, degrees_of_freedom)
}

#[cfg(test)]
#[path = "compare_tests.rs"]
mod tests;
