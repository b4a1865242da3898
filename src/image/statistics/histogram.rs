//! Pearson's chi-square test of samples against their density.

use super::{StatisticsError, chi_square};

/// The outcome of a chi-square test.
#[derive(Debug, Clone, PartialEq)]
pub struct ChiSquareTest {
    /// Σ (observed − expected)² / expected.
    pub statistic: f64,
    /// Cells after pooling, minus 1.
    pub degrees_of_freedom: f64,
    /// Probability of so large a statistic if the samples follow the density.
    pub p_value: f64,
    /// Cells that were pooled.
    pub pooled: usize,
    /// Observations in cells where none was expected.
    pub impossible: f64,
}

/// Share of the samples that may lie where none was expected.
const IMPOSSIBLE: f64 = 1e-5;

/// Tests a histogram of samples against the counts expected in its cells.
///
/// Cells that expect fewer than `least_expected` (5 by custom) are pooled, the
/// smallest first, as in Subr & Arvo 2007 ("Statistical Hypothesis Testing for
/// Assessing Monte Carlo Estimators") and Mitsuba's `ChiSquareTest`; cells that
/// expect nothing go into the same pool, but if they hold more than one in 100,000
/// of the samples (Mitsuba's allowance for rounding at a cell's edge), p is 0.
/// `expected` must sum to about the number of samples: a density that does not
/// integrate to 1 fails. For several tests,
/// correct the p-values with [`super::sidak`].
///
/// # Errors
/// Arrays of different lengths or none, a count that is negative or not finite,
/// or nothing expected at all.
pub fn chi_square_test(
    observed: &[f64],
    expected: &[f64],
    least_expected: f64,
) -> Result<ChiSquareTest, StatisticsError> {
    check(observed, expected)?;
    let mut cells: Vec<(f64, f64)> = expected
        .iter()
        .copied()
        .zip(observed.iter().copied())
        .collect();
    cells.sort_by(|a, b| a.0.total_cmp(&b.0));
    let impossible: f64 = cells.iter().filter(|c| c.0 == 0.0).map(|c| c.1).sum();
    let (pool, pooled) = pool(&cells, least_expected);
    // What cannot reach the threshold even together is one cell.
    let pool = (pooled > 0).then_some(pool);
    let kept = cells[pooled..].iter().copied().chain(pool);
    let (mut statistic, mut count) = (0.0, 0_usize);
    for (expected, observed) in kept {
        statistic += (observed - expected) * (observed - expected) / expected;
        count += 1;
    }
    let degrees_of_freedom = count.saturating_sub(1) as f64;
    let is_possible = impossible <= IMPOSSIBLE * observed.iter().sum::<f64>();
    Ok(ChiSquareTest {
        statistic,
        degrees_of_freedom,
        p_value: if is_possible {
            p_value(statistic, degrees_of_freedom)
        } else {
            0.0
        },
        pooled,
        impossible,
    })
}

/// The pool's expected and observed counts, and how many of the sorted cells it took.
fn pool(cells: &[(f64, f64)], least_expected: f64) -> ((f64, f64), usize) {
    let mut pool = (0.0, 0.0);
    for (index, cell) in cells.iter().enumerate() {
        let is_full = pool.0 >= least_expected || index == 0;
        if cell.0 >= least_expected && is_full {
            return (pool, index);
        }
        pool = (pool.0 + cell.0, pool.1 + cell.1);
    }
    (pool, cells.len())
}

/// A single cell can only be right or wrong about the number of samples.
fn p_value(statistic: f64, degrees_of_freedom: f64) -> f64 {
    if degrees_of_freedom > 0.0 {
        chi_square::upper(statistic, degrees_of_freedom)
    } else {
        chi_square::upper(statistic, 1.0)
    }
}

fn check(observed: &[f64], expected: &[f64]) -> Result<(), StatisticsError> {
    if observed.len() != expected.len() || expected.is_empty() {
        return Err(StatisticsError::SizeMismatch {
            name: "the histogram",
            found: observed.len(),
            expected: expected.len().max(1),
        });
    }
    let out_of_range = |name, value, expected| {
        Err(StatisticsError::OutOfRange {
            name,
            value,
            expected,
        })
    };
    let is_count = |c: &&f64| c.is_finite() && **c >= 0.0;
    if let Some(&value) = observed.iter().chain(expected).find(|c| !is_count(c)) {
        return out_of_range("a count", value, "finite and at least 0");
    }
    let sum: f64 = expected.iter().sum();
    if sum <= 0.0 {
        return out_of_range("the sum of the expected counts", sum, "above 0");
    }
    Ok(())
}

#[cfg(test)]
#[allow(clippy::unwrap_used)] // A test that cannot set itself up has failed.
mod tests {
    use super::*;

    #[test]
    fn a_die_by_hand() {
        let observed = [5.0, 8.0, 9.0, 8.0, 10.0, 20.0];
        let test = chi_square_test(&observed, &[10.0; 6], 5.0).unwrap();
        assert!((test.statistic - 13.4).abs() < 1e-12);
        assert_eq!((test.degrees_of_freedom, test.pooled), (5.0, 0));
        assert!((test.p_value - 0.019_905_220_334_774_4).abs() < 1e-10);
    }

    #[test]
    fn small_cells_are_pooled_until_they_are_large() {
        let expected = [100.0, 2.0, 1.0, 0.0, 1.5, 50.0];
        let observed = [100.0, 3.0, 1.0, 0.0, 0.5, 50.0];
        // 0 + 1 + 1.5 + 2 = 4.5 is not enough: 50 joins them.
        let test = chi_square_test(&observed, &expected, 5.0).unwrap();
        assert_eq!((test.pooled, test.degrees_of_freedom), (5, 1.0));
        assert_eq!(test.statistic, 0.0);
        let test = chi_square_test(&observed, &expected, 4.0).unwrap();
        assert_eq!((test.pooled, test.degrees_of_freedom), (4, 2.0));
        let test = chi_square_test(&[1.0, 1.0], &[1.0, 1.0], 5.0).unwrap();
        assert_eq!((test.pooled, test.degrees_of_freedom), (2, 0.0));
        assert_eq!(test.p_value, 1.0);
    }

    #[test]
    fn samples_where_none_can_be_fail() {
        let expected = [1e6, 1e6, 0.0];
        let test = chi_square_test(&[1e6, 999_990.0, 10.0], &expected, 5.0).unwrap();
        assert!(test.p_value > 0.9 && test.impossible == 10.0);
        let test = chi_square_test(&[1e6, 999_970.0, 30.0], &expected, 5.0).unwrap();
        assert!(test.p_value == 0.0 && test.impossible == 30.0);
        // A density that integrates to too much.
        let test = chi_square_test(&[900.0; 2], &[1000.0; 2], 5.0).unwrap();
        assert!(test.p_value < 1e-4);
    }

    #[test]
    fn nonsense_is_an_error() {
        assert!(chi_square_test(&[], &[], 5.0).is_err());
        assert!(chi_square_test(&[1.0], &[1.0, 1.0], 5.0).is_err());
        assert!(chi_square_test(&[1.0], &[f64::NAN], 5.0).is_err());
        assert!(chi_square_test(&[-1.0], &[1.0], 5.0).is_err());
        assert!(chi_square_test(&[1.0], &[0.0], 5.0).is_err());
    }
}
