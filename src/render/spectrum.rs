//! Wavelengths for dispersion: bins of equal probability, each with what its light weighs in linear Rec. 709.

/// Bins; `SPECTRUM_BINS` of `shaders/medium.wgsl`.
const BINS: usize = 64;
/// Micrometres within which the eye responds.
const RANGE: (f64, f64) = (0.38, 0.73);
/// Steps of the integration.
const STEPS: usize = 7000;

/// For each bin the lower end of its wavelengths in micrometres and its weights for red, green and blue, the
/// mean of which over all bins is 1; then the upper end of the last.
///
/// The weights are the colour-matching functions in Rec. 709 with what lies outside of its gamut cut off, so
/// that no light is negative, and scaled so that white stays white. Bins have equal shares of their sum.
pub fn table() -> Vec<f32> {
    let width = (RANGE.1 - RANGE.0) / STEPS as f64;
    let at = |i: usize| RANGE.0 + width * (i as f64 + 0.5);
    let responses: Vec<[f64; 3]> = (0..STEPS).map(|i| response(at(i))).collect();
    let sum = |c: usize| responses.iter().map(|r| r[c]).sum::<f64>();
    let sums = [sum(0), sum(1), sum(2)];
    let mut table = Vec::with_capacity(4 * BINS + 1);
    let mut weights = [0.0; 3];
    let mut filled = 0.0;
    table.push(RANGE.0 as f32);
    for (i, r) in responses.iter().enumerate() {
        let share = [r[0] / sums[0], r[1] / sums[1], r[2] / sums[2]];
        weights = [0, 1, 2].map(|c| weights[c] + share[c]);
        filled += share.iter().sum::<f64>() / 3.0;
        let bins = table.len() / 4 + 1;
        if filled * BINS as f64 >= bins as f64 - 1e-9 || i + 1 == STEPS {
            table.extend(weights.map(|w| (w * BINS as f64) as f32));
            table.push((RANGE.0 + width * (i as f64 + 1.0)) as f32);
            weights = [0.0; 3];
        }
    }
    table
}

/// Response of the channels to light of a wavelength in micrometres, at least 0 (colour matching: Wyman, Sloan and
/// Shirley 2013, Simple Analytic Approximations to the CIE XYZ Color Matching Functions, JCGT 2(2)).
fn response(wavelength: f64) -> [f64; 3] {
    let nm = 1000.0 * wavelength;
    let lobe = |scale: f64, mean: f64, below: f64, above: f64| {
        let t = (nm - mean) / if nm < mean { below } else { above };
        scale * (-0.5 * t * t).exp()
    };
    let x = lobe(1.056, 599.8, 37.9, 31.0) + lobe(0.362, 442.0, 16.0, 26.7)
        - lobe(0.065, 501.1, 20.4, 26.2);
    let y = lobe(0.821, 568.8, 46.9, 40.5) + lobe(0.286, 530.9, 16.3, 31.1);
    let z = lobe(1.217, 437.0, 11.8, 36.0) + lobe(0.681, 459.0, 26.0, 13.8);
    [
        3.240_454_2 * x - 1.537_138_5 * y - 0.498_531_4 * z,
        -0.969_266 * x + 1.876_010_8 * y + 0.041_556 * z,
        0.055_643_4 * x - 0.204_025_9 * y + 1.057_225_2 * z,
    ]
    .map(|c| c.max(0.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn white_stays_white_and_bins_are_evenly_likely() {
        let table = table();
        assert_eq!(table.len(), 4 * BINS + 1);
        let bins: Vec<&[f32]> = table.chunks_exact(4).collect();
        for c in 1..4 {
            let mean = bins.iter().map(|b| f64::from(b[c])).sum::<f64>() / BINS as f64;
            assert!((mean - 1.0).abs() < 1e-6, "{mean}");
        }
        for bin in &bins {
            let share = (bin[1] + bin[2] + bin[3]) / 3.0;
            assert!((share - 1.0).abs() < 0.03, "{share}");
        }
        let ends: Vec<f32> = table.iter().step_by(4).copied().collect();
        assert!(ends.is_sorted_by(|a, b| a < b));
        assert!(bins[0][3] > bins[0][1] && bins[BINS - 1][1] > bins[BINS - 1][3]);
    }
}
