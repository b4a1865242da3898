//! What a family of tests says in the end.

use std::fmt;

use super::compare::{ROUNDING, detectable};
use super::sidak;
use super::tiles::Tile;
use super::welch::Welch;

/// One tile's test.
pub(super) struct Outcome {
    pub tile: Tile,
    pub welch: Welch,
}

/// Probability with which a bias of [`Verdict::detectable_bias`] is found.
pub const POWER: f64 = 0.9;

/// The outcome of a comparison; its `Display` is one line for a report.
#[derive(Debug, Clone, PartialEq)]
pub struct Verdict {
    /// No test of the family gave an alarm.
    pub pass: bool,
    /// The tile with the smallest p-value.
    pub worst: WorstTile,
    /// Family-wise p-value: probability of so extreme a worst tile if there is no difference.
    pub p_value: f64,
    /// Number of tests: tiles × 3.
    pub tests: usize,
    /// Family-wise rate of false alarms that was asked for.
    pub alpha: f64,
    /// Smallest relative bias that, if it scaled all light of the picture, its most
    /// sensitive tile would have shown with probability [`POWER`]. Tiles without noise
    /// do not count; infinite if b is black.
    pub detectable_bias: f64,
    /// The same for the median tile: what a bias in one place must be to be seen there.
    pub detectable_local_bias: f64,
    /// (mean of a − mean of b) / mean of b over the whole picture.
    pub relative_bias: f64,
    /// Standard error of `relative_bias`, channels taken as fully correlated.
    pub relative_bias_error: f64,
}

/// Where two pictures differ most, in terms of their noise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WorstTile {
    /// Left column.
    pub x: usize,
    /// Top row.
    pub y: usize,
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// 0, 1, 2: red, green, blue.
    pub channel: usize,
    /// Mean of the first picture.
    pub mean_a: f64,
    /// Mean of the second.
    pub mean_b: f64,
    /// Welch's t, of the difference beyond rounding.
    pub t: f64,
    /// Its degrees of freedom.
    pub degrees_of_freedom: f64,
    /// p-value of this tile alone.
    pub p_value: f64,
}

impl Verdict {
    /// Sums up; there is at least one outcome.
    pub(super) fn new(outcomes: &[Outcome], alpha: f64) -> Self {
        let tests = outcomes.len();
        let level = sidak::per_test(alpha, tests);
        let worst = outcomes
            .iter()
            .min_by(|a, b| severity(a).total_cmp(&severity(b)))
            .map_or(WorstTile::NONE, WorstTile::new);
        let (relative_bias, relative_bias_error) = whole(outcomes);
        let [detectable_bias, detectable_local_bias] = detectable_biases(outcomes, level);
        Verdict {
            pass: worst.p_value >= level,
            p_value: sidak::family(worst.p_value, tests),
            worst,
            tests,
            alpha,
            detectable_bias,
            detectable_local_bias,
            relative_bias,
            relative_bias_error,
        }
    }
}

/// The p-value, and where it has underflowed to 0 the t value, negative to come first.
fn severity(outcome: &Outcome) -> f64 {
    match outcome.welch.p_value {
        0.0 if outcome.welch.t.is_nan() => f64::NEG_INFINITY,
        0.0 => -outcome.welch.t.abs(),
        p => p,
    }
}

/// The relative bias that the most sensitive and the median tile would have shown.
/// Tiles without noise, where nothing was estimated, do not count.
fn detectable_biases(outcomes: &[Outcome], level: f64) -> [f64; 2] {
    let error = |outcome: &Outcome| {
        let [a, b] = outcome.tile.estimates;
        let error = (a.variance + b.variance).sqrt();
        let relative = error / b.mean.abs();
        (error > 0.0).then_some((relative, outcome.welch.degrees_of_freedom))
    };
    let mut errors: Vec<(f64, f64)> = outcomes.iter().filter_map(error).collect();
    if errors.is_empty() {
        return [ROUNDING; 2];
    }
    errors.sort_by(|a, b| a.0.total_cmp(&b.0));
    [errors[0], errors[errors.len() / 2]].map(|(error, nu)| match error {
        error if error.is_finite() => ROUNDING + error * detectable(level, POWER, nu),
        _ => f64::INFINITY,
    })
}

/// Relative bias of the whole picture and its standard error, over all channels. Channels share
/// their paths, so that their errors add as they are, not squared: right where light is grey, an
/// upper bound elsewhere.
fn whole(outcomes: &[Outcome]) -> (f64, f64) {
    let (mut difference, mut reference, mut variances) = (0.0, 0.0, [0.0; 3]);
    for Outcome { tile, .. } in outcomes {
        let n = (tile.width * tile.height) as f64;
        let [a, b] = tile.estimates;
        difference += n * (a.mean - b.mean);
        reference += n * b.mean;
        variances[tile.channel] += n * n * (a.variance + b.variance);
    }
    match difference {
        0.0 if reference == 0.0 => (0.0, 0.0),
        _ => {
            let error: f64 = variances.map(f64::sqrt).iter().sum();
            (difference / reference, error / reference.abs())
        }
    }
}

impl WorstTile {
    const NONE: WorstTile = WorstTile {
        x: 0,
        y: 0,
        width: 0,
        height: 0,
        channel: 0,
        mean_a: 0.0,
        mean_b: 0.0,
        t: 0.0,
        degrees_of_freedom: f64::INFINITY,
        p_value: 1.0,
    };

    fn new(outcome: &Outcome) -> Self {
        let Outcome { tile, welch } = outcome;
        WorstTile {
            x: tile.x,
            y: tile.y,
            width: tile.width,
            height: tile.height,
            channel: tile.channel,
            mean_a: tile.estimates[0].mean,
            mean_b: tile.estimates[1].mean,
            t: welch.t,
            degrees_of_freedom: welch.degrees_of_freedom,
            p_value: welch.p_value,
        }
    }
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Verdict { worst, tests, .. } = self;
        write!(
            f,
            "{}: p = {:.3e} over {tests} tests (false alarms {:.1e}); worst {}x{} pixels at \
             ({}, {}) {}: {:.6e} against {:.6e}, t = {:.2}; bias {:+.4} % ± {:.4} %; a bias of \
             {:.3} % everywhere, or {:.3} % in a typical tile, would have been seen",
            if self.pass { "pass" } else { "FAIL" },
            self.p_value,
            self.alpha,
            worst.width,
            worst.height,
            worst.x,
            worst.y,
            ["red", "green", "blue"].get(worst.channel).unwrap_or(&""),
            worst.mean_a,
            worst.mean_b,
            worst.t,
            100.0 * self.relative_bias,
            100.0 * self.relative_bias_error,
            100.0 * self.detectable_bias,
            100.0 * self.detectable_local_bias,
        )
    }
}
