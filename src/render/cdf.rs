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

/// Values of the [`guide`] of a distribution of `count` intervals: one for four to eight of them, and one more.
pub fn guide_length(count: usize) -> usize {
    (1 << guide_bits(count)) + 1
}

fn guide_bits(count: usize) -> u32 {
    count.max(4).ilog2() - 2
}

/// Which interval of a distribution holds each of the numbers i · 2³¹ / (n - 1), i from 0 to n - 1, the last one less:
/// where to look for a number between two of them (Chen and Asau 1974, the method of guide tables). n is a
/// [`guide_length`].
pub fn guide(cdf: &[u32], guide: &mut [u32]) {
    let shift = CDF_ONE.ilog2() - (guide.len() - 1).ilog2();
    for (i, interval) in guide.iter_mut().enumerate() {
        let number = (i << shift).min(CDF_ONE as usize - 1) as u32;
        let after = cdf.partition_point(|lower| *lower <= number);
        *interval = after.saturating_sub(1) as u32;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_guide_leads_to_every_number() {
        for count in [1, 2, 3, 4, 7, 8, 9, 100] {
            let weights: Vec<f64> = (0..count).map(|i| f64::from(i * i % 7 + i % 2)).collect();
            let weights = if count == 1 { vec![1.0] } else { weights };
            let cdf = cdf_of(&weights);
            let mut table = vec![0; guide_length(cdf.len())];
            guide(&cdf, &mut table);
            let buckets = table.len() - 1;
            assert!(buckets == 1 || (4..8).contains(&(cdf.len() / buckets)));
            let ends = cdf.iter().flat_map(|end| [*end, end.saturating_sub(1)]);
            for number in ends.chain([CDF_ONE - 1]) {
                let interval = cdf.partition_point(|lower| *lower <= number) as u32 - 1;
                let bucket = number as usize / (CDF_ONE as usize / buckets);
                assert!((table[bucket]..=table[bucket + 1]).contains(&interval));
            }
        }
    }

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
