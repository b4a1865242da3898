//! Cumulative distributions in fixed point, so that what the device draws by inverting them is
//! exactly what the densities say.

/// All of the probability.
pub const CDF_ONE: u32 = 1 << 31;

/// Writes into `cdf` the lower end, in 2⁻³¹, of each weight's interval and returns the total weight.
/// An interval ends where the next begins, the last at [`CDF_ONE`]. It is empty just for a weight of
/// 0, and within 2⁻³¹ · (number of weights) of its share; without any weight all ends are 0.
///
/// The weights, at most 2³⁰ of them, are finite, not negative, and so is their sum.
pub fn fixed_point_cdf(weights: &[f64], cdf: &mut [u32]) -> f64 {
    let total: f64 = weights.iter().sum();
    let positive = weights.iter().filter(|w| **w > 0.0).count() as u32;
    // One unit for each positive weight, and the rest in proportion.
    let rest = f64::from(CDF_ONE - positive);
    let (mut below, mut units) = (0.0, 0);
    for (end, weight) in cdf.iter_mut().zip(weights) {
        *end = units;
        if total > 0.0 {
            *end += (below / total * rest) as u32;
        }
        below += weight;
        units += u32::from(*weight > 0.0);
    }
    total
}

/// Probabilities of the intervals of [`fixed_point_cdf`], exactly; meaningless without any weight.
pub fn probabilities(cdf: &[u32]) -> impl Iterator<Item = f64> {
    let ends = cdf.iter().skip(1).copied().chain([CDF_ONE]);
    cdf.iter()
        .zip(ends)
        .map(|(lower, upper)| f64::from(upper - lower) / f64::from(CDF_ONE))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cdf_of(weights: &[f64]) -> Vec<u32> {
        let mut cdf = vec![7; weights.len()];
        fixed_point_cdf(weights, &mut cdf);
        cdf
    }

    fn check(weights: &[f64]) {
        let total: f64 = weights.iter().sum();
        let cdf = cdf_of(weights);
        let realised: Vec<f64> = probabilities(&cdf).collect();
        assert_eq!(realised.iter().sum::<f64>(), 1.0);
        for (i, (p, w)) in realised.iter().zip(weights).enumerate() {
            assert_eq!(*p == 0.0, *w == 0.0, "weight {i}: {w} got {p}");
            let error = (p - w / total).abs() * f64::from(CDF_ONE);
            assert!(error <= weights.len() as f64 + 1.0, "weight {i}: {error}");
        }
    }

    #[test]
    fn realises_its_weights() {
        check(&[3.0]);
        check(&[0.0, 0.0, 1e-300, 0.0]);
        let mixed: Vec<f64> = (0..1000)
            .map(|i| f64::from(i % 17) * f64::from(i % 5))
            .collect();
        check(&mixed);
        // What is lost in the sum, at both ends, next to what is not.
        let mut extreme = vec![1e-30; 4097];
        extreme[0] = 0.0;
        extreme[100] = 1e30;
        extreme[101] = 0.0;
        extreme[4096] = 0.0;
        check(&extreme);
    }

    #[test]
    fn without_weight_all_ends_are_zero() {
        assert_eq!(cdf_of(&[0.0, 0.0]), [0, 0]);
        assert_eq!(fixed_point_cdf(&[0.0], &mut [7]), 0.0);
    }
}
