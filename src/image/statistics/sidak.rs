//! Šidák's correction: one rate of false alarms for a family of tests.
//!
//! Exact for independent tests; for two-sided tests of jointly normal values of
//! any correlation it holds as a bound (Šidák 1967).

/// Significance level of each of `tests` tests, so that any of them gives a false
/// alarm with probability `alpha` at most: 1 − (1 − α)^(1/m).
pub fn per_test(alpha: f64, tests: usize) -> f64 {
    -((-alpha).ln_1p() / tests.max(1) as f64).exp_m1()
}

/// The family's p-value when the smallest of `tests` p-values is `p`: 1 − (1 − p)^m.
pub fn family(p: f64, tests: usize) -> f64 {
    -((-p).ln_1p() * tests.max(1) as f64).exp_m1()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_numbers_keep_their_digits() {
        assert!((per_test(0.05, 1) - 0.05).abs() < 1e-16);
        assert!((per_test(0.01, 2) - (1.0 - 0.99_f64.sqrt())).abs() < 1e-15);
        let level = per_test(1e-6, 1_000_000);
        assert!((level / 1.000_000_5e-12 - 1.0).abs() < 1e-9);
        assert!((family(level, 1_000_000) / 1e-6 - 1.0).abs() < 1e-12);
        assert_eq!((family(0.0, 9), family(1.0, 9)), (0.0, 1.0));
    }
}
