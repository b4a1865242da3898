//! Chi-square tests with one stated rate of false alarms for all of them together.

use etendue::image::statistics::{ChiSquareTest, chi_square_test, sidak};

/// The probability that any of the tests in all of the device_*.rs files fails although every
/// sampling routine is right, had the seeds been drawn at random. They are fixed.
const FAMILY_FALSE_ALARM: f64 = 1e-3;
/// No more tests than this are in the family.
const FAMILY_TESTS: usize = 1000;
/// Cells that expect fewer samples are pooled.
const LEAST_EXPECTED: f64 = 5.0;

/// The level of a single test, about 1e-6 (Šidák).
pub fn level() -> f64 {
    sidak::per_test(FAMILY_FALSE_ALARM, FAMILY_TESTS)
}

/// Tests counts against probabilities of the cells; what the probabilities lack of 1 is one more
/// cell, for `lost` samples that lie nowhere.
pub fn chi_square(observed: &[u32], probabilities: &[f64], lost: u32) -> ChiSquareTest {
    let samples = f64::from(observed.iter().sum::<u32>() + lost);
    let rest = (1.0 - probabilities.iter().sum::<f64>()).max(0.0);
    let mut observed: Vec<f64> = observed.iter().map(|&n| f64::from(n)).collect();
    let mut expected: Vec<f64> = probabilities.iter().map(|p| p * samples).collect();
    // A rest within the error of the integration is no cell.
    if rest > 1e-5 || lost > 0 {
        observed.push(f64::from(lost));
        expected.push(rest * samples);
    }
    chi_square_test(&observed, &expected, LEAST_EXPECTED).expect("counts")
}

/// Fails unless the counts fit the probabilities.
pub fn assert_fits(name: &str, observed: &[u32], probabilities: &[f64], lost: u32) {
    let test = chi_square(observed, probabilities, lost);
    println!(
        "{name}: chi-square {:.1}, {} degrees of freedom, p = {:.4}",
        test.statistic, test.degrees_of_freedom, test.p_value
    );
    assert!(test.p_value > level(), "{name}: {test:?}");
}

/// Fails if the counts fit: for negative controls.
pub fn assert_rejected(name: &str, observed: &[u32], probabilities: &[f64], lost: u32) {
    let test = chi_square(observed, probabilities, lost);
    assert!(test.p_value <= level(), "{name} passes: {test:?}");
}

/// Counts of samples in the cells of the unit square.
pub fn histogram_2d(n: usize, points: impl Iterator<Item = [f64; 2]>) -> Vec<u32> {
    let mut counts = vec![0; n * n];
    for [x, y] in points {
        counts[(y * n as f64) as usize * n + (x * n as f64) as usize] += 1;
    }
    counts
}

/// Fails unless points of the unit square are uniform.
pub fn assert_uniform(name: &str, n: usize, points: impl Iterator<Item = [f64; 2]>) {
    let counts = histogram_2d(n, points);
    assert_fits(name, &counts, &uniform(n * n), 0);
}

/// Equal probabilities.
pub fn uniform(cells: usize) -> Vec<f64> {
    vec![1.0 / cells as f64; cells]
}

/// Mean and its standard error.
pub fn mean_and_error(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let (mut n, mut mean, mut m2) = (0.0, 0.0, 0.0);
    for x in values {
        n += 1.0;
        let delta = x - mean;
        mean += delta / n;
        m2 += delta * (x - mean);
    }
    (mean, (m2 / (n * (n - 1.0))).sqrt())
}
