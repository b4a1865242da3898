//! Student's t distribution with ν > 0 degrees of freedom, not necessarily whole; ν = ∞ is normal.

use super::{beta, normal, roots};

/// Degrees of freedom above which the incomplete beta function loses digits.
const NEARLY_NORMAL: f64 = 1e4;

/// P(T ≤ t).
pub fn cdf(t: f64, nu: f64) -> f64 {
    upper(-t, nu)
}

/// P(T > t), exact to its relative precision far into the tail.
pub fn upper(t: f64, nu: f64) -> f64 {
    if t.is_nan() {
        f64::NAN
    } else if t < 0.0 {
        1.0 - upper(-t, nu)
    } else {
        0.5 * two_sided(t, nu)
    }
}

/// P(|T| > |t|): the p-value of a two-sided test. Abramowitz & Stegun 26.7.1.
pub fn two_sided(t: f64, nu: f64) -> f64 {
    let square = t * t;
    if square.is_infinite() {
        return 0.0;
    }
    if nu > NEARLY_NORMAL {
        return 2.0 * normal::upper(normal_equivalent(square, nu));
    }
    let (x, y) = (nu / (nu + square), square / (nu + square));
    beta::regularised(0.5 * nu, 0.5, x, y)
}

/// z with P(|Z| > z) = P(|T| > |t|): the series of G. W. Hill, "Student's
/// t-Distribution", Algorithm 395, Comm. ACM 13 (1970), which for so many degrees
/// of freedom is exact to rounding.
fn normal_equivalent(square: f64, nu: f64) -> f64 {
    if nu.is_infinite() {
        return square.sqrt();
    }
    let a = nu - 0.5;
    let b = 48.0 * a * a;
    let u = a * (square / nu).ln_1p();
    let third = (((4.0 * u + 33.0) * u + 240.0) * u + 855.0) / (0.8 * u * u + 100.0 + b);
    u.sqrt() * (1.0 + (u + 3.0 - third / 10.0) / b)
}

/// t with P(T > t) = p, for 0 ≤ p ≤ 1; small p keep their precision.
pub fn upper_quantile(p: f64, nu: f64) -> f64 {
    if !(p > 0.0 && p < 1.0) || nu.is_infinite() {
        return normal::upper_quantile(p);
    }
    if p > 0.5 {
        return -upper_quantile(1.0 - p, nu);
    }
    roots::falling(|t| upper(t, nu), p)
}

/// t with P(T ≤ t) = p.
pub fn quantile(p: f64, nu: f64) -> f64 {
    -upper_quantile(p, nu)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn agrees_with_forty_digits_and_inverts() {
        let table = [
            (1.0, 1.0, 0.25),
            (10.0, 1.0, 0.031_725_517_430_553_57),
            (100.0, 1.0, 0.003_182_992_764_908_255),
            (0.01, 2.0, 0.496_464_554_479_100_5),
            (3.0, 2.5, 0.036_288_047_774_515_92),
            (2.0, 5.0, 0.050_969_739_414_929_18),
            (-1.5, 7.3, 0.912_218_453_598_457),
            (5.0, 31.0, 0.000_010_738_917_335_087_816),
            (1.6, 31.0, 0.059_871_038_507_931_134),
            (1.8, 31.0, 0.040_799_987_280_817_29),
            (8.0, 100.0, 1.136_432_403_864_040_3e-12),
            (2.0, 1000.0, 0.022_885_173_246_625_82),
            (4.0, 1000.0, 0.000_034_004_959_604_390_79),
            (6.0, 100_000.0, 9.899_647_278_008_813e-10),
        ];
        for (t, nu, p) in table {
            assert!((upper(t, nu) / p - 1.0).abs() < 1e-10, "{t} {nu}");
            assert!((cdf(t, nu) - (1.0 - p)).abs() < 1e-12);
            assert!((upper_quantile(p, nu) / t - 1.0).abs() < 1e-10, "{t} {nu}");
        }
    }

    #[test]
    fn many_degrees_of_freedom_are_normal() {
        for t in [0.5, 2.0, 6.0] {
            for nu in [1e6, 1e9, 1e12, 1e15, f64::INFINITY] {
                // The leading difference is of relative order (1 + t)⁴/4ν.
                let ratio = two_sided(t, nu) / (2.0 * normal::upper(t));
                assert!(
                    (ratio - 1.0).abs() < 1e-10 + (1.0 + t).powi(4) / nu,
                    "{t} {nu} {ratio}"
                );
            }
        }
        // Where one method takes over from the other they agree.
        for t in [0.1, 1.0, 5.0, 12.0] {
            let ratio = two_sided(t, NEARLY_NORMAL) / two_sided(t, NEARLY_NORMAL + 1e-6);
            assert!((ratio - 1.0).abs() < 1e-10, "{t} {ratio}");
        }
        assert_eq!(two_sided(f64::INFINITY, 3.0), 0.0);
        assert_eq!(upper(0.0, 3.0), 0.5);
        assert!(upper(f64::NAN, 3.0).is_nan());
    }
}
