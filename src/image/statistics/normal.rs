//! The standard normal distribution.

use std::f64::consts::PI;

use super::gamma;

/// Density at z.
pub fn density(z: f64) -> f64 {
    (-0.5 * z * z).exp() / (2.0 * PI).sqrt()
}

/// P(Z ≤ z).
pub fn cdf(z: f64) -> f64 {
    upper(-z)
}

/// P(Z > z), exact to its relative precision far into the tail.
pub fn upper(z: f64) -> f64 {
    // erfc(x) = Q(½, x²), Abramowitz & Stegun 6.5.17.
    if z >= 0.0 {
        0.5 * gamma::upper(0.5, 0.5 * z * z)
    } else {
        0.5 + 0.5 * gamma::lower(0.5, 0.5 * z * z)
    }
}

/// z with P(Z ≤ z) = p, for 0 ≤ p ≤ 1.
pub fn quantile(p: f64) -> f64 {
    -upper_quantile(p)
}

/// z with P(Z > z) = p, for 0 ≤ p ≤ 1; small p keep their precision.
pub fn upper_quantile(p: f64) -> f64 {
    if !(p > 0.0 && p < 1.0) {
        return match p {
            0.0 => f64::INFINITY,
            1.0 => f64::NEG_INFINITY,
            _ => f64::NAN,
        };
    }
    if p > 0.5 {
        return -upper_quantile(1.0 - p);
    }
    // Start within 4.5e-4 (Abramowitz & Stegun 26.2.23), then Halley's method.
    let t = (-2.0 * p.ln()).sqrt();
    let top = 2.515517 + t * (0.802853 + t * 0.010328);
    let bottom = 1.0 + t * (1.432788 + t * (0.189269 + t * 0.001308));
    let mut z = t - top / bottom;
    for _ in 0..3 {
        let newton = (upper(z) - p) / density(z);
        z += newton / (1.0 - 0.5 * z * newton);
    }
    z
}

#[cfg(test)]
mod tests {
    use super::*;

    /// (z, P(Z > z)) to 18 digits, by mpmath.
    const TABLE: [(f64, f64); 9] = [
        (0.0, 0.5),
        (0.5, 0.308_537_538_725_986_9),
        (1.0, 0.158_655_253_931_457_05),
        (1.96, 0.024_997_895_148_220_434),
        (3.0, 0.001_349_898_031_630_094_5),
        (6.0, 9.865_876_450_376_98e-10),
        (10.0, 7.619_853_024_160_526e-24),
        (20.0, 2.753_624_118_606_233_7e-89),
        (37.0, 5.725_571_222_524_577e-300),
    ];

    #[test]
    fn agrees_with_forty_digits_and_inverts() {
        for (z, p) in TABLE {
            assert!((upper(z) / p - 1.0).abs() < 1e-12, "{z}");
            assert!((cdf(z) - (1.0 - p)).abs() < 1e-15);
            assert!((cdf(-z) / p - 1.0).abs() < 1e-12);
            assert!((upper_quantile(p) - z).abs() < 1e-12 * z.max(1.0), "{z}");
            assert!((quantile(p) + z).abs() < 1e-12 * z.max(1.0), "{z}");
        }
        assert!((quantile(0.975) - 1.959_963_984_540_054).abs() < 1e-13);
    }

    #[test]
    fn ends_and_nonsense() {
        assert_eq!(quantile(0.0), f64::NEG_INFINITY);
        assert_eq!(quantile(1.0), f64::INFINITY);
        assert!(quantile(-0.1).is_nan() && quantile(f64::NAN).is_nan());
    }
}
