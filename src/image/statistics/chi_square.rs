//! The chi-square distribution with k > 0 degrees of freedom.

use super::{gamma, roots};

/// P(X ≤ x). Abramowitz & Stegun 26.4.19.
pub fn cdf(x: f64, k: f64) -> f64 {
    gamma::lower(0.5 * k, 0.5 * x)
}

/// P(X > x): the p-value of a statistic.
pub fn upper(x: f64, k: f64) -> f64 {
    gamma::upper(0.5 * k, 0.5 * x)
}

/// x with P(X > x) = p, for 0 ≤ p ≤ 1.
pub fn upper_quantile(p: f64, k: f64) -> f64 {
    match p {
        0.0 => f64::INFINITY,
        1.0 => 0.0,
        _ if p > 0.0 && p < 1.0 => roots::falling(|x| upper(x, k), p),
        _ => f64::NAN,
    }
}

/// x with P(X ≤ x) = p.
pub fn quantile(p: f64, k: f64) -> f64 {
    upper_quantile(1.0 - p, k)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn agrees_with_forty_digits_and_inverts() {
        let table = [
            (0.001, 1.0, 0.974_772_879_369_960_4),
            (1.0, 1.0, 0.317_310_507_862_914_1),
            (3.84, 1.0, 0.050_043_521_248_705_1),
            (100.0, 1.0, 1.523_970_604_832_105_3e-23),
            (5.0, 2.0, 0.082_084_998_623_898_8),
            (0.1, 3.0, 0.991_837_423_731_876_5),
            (20.0, 4.5, 0.000_803_717_912_503_183_4),
            (3.0, 10.0, 0.981_424_063_777_859_3),
            (10.0, 10.0, 0.440_493_285_065_212_4),
            (60.0, 10.0, 3.624_300_952_061_488e-9),
            (80.0, 100.0, 0.929_664_933_340_605),
            (124.3, 100.0, 0.050_266_398_300_158_38),
            (1100.0, 1000.0, 0.014_614_408_126_295_194),
            (100_500.0, 100_000.0, 0.131_854_811_603_383_78),
            (1_003_000.0, 1_000_000.0, 0.017_016_772_933_266_315),
        ];
        for (x, k, p) in table {
            assert!((upper(x, k) / p - 1.0).abs() < 1e-10, "{x} {k}");
            assert!((cdf(x, k) - (1.0 - p)).abs() < 1e-11, "{x} {k}");
            assert!((upper_quantile(p, k) / x - 1.0).abs() < 1e-9, "{x} {k}");
        }
        assert_eq!(quantile(0.0, 3.0), 0.0);
        assert!(upper_quantile(-1.0, 3.0).is_nan());
    }
}
