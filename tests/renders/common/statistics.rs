//! What a picture says about its expectation, and how sure it is.

use std::ops::Range;

use etendue::image::statistics::{MeanImage, StatisticsError, Verdict, compare};
use etendue::render::Film;

/// Standard errors at which a closed-form test fails. A right program exceeds it with a chance of
/// 6.8e-6 a number (two-sided, normal); with some 500 numbers a false alarm meets one new device
/// or seed in 300. On one device nothing varies: seeds are fixed.
pub const MAX_Z: f64 = 4.5;
/// Relative rounding of f32 radiometry that counts as equal.
pub const ROUNDING: f64 = 1e-5;

/// A mean with its standard error, a channel.
#[derive(Debug, Clone, Copy)]
pub struct Estimate {
    pub mean: [f64; 3],
    pub error: [f64; 3],
}

/// The mean of a picture.
pub fn estimate(film: &Film) -> Estimate {
    estimate_region(film, 0..film.width, 0..film.height)
}

/// The mean of a rectangle of pixels.
pub fn estimate_region(film: &Film, columns: Range<u32>, rows: Range<u32>) -> Estimate {
    let count = f64::from(columns.end - columns.start) * f64::from(rows.end - rows.start);
    let (mut mean, mut variance) = ([0.0; 3], [0.0; 3]);
    for y in rows {
        for x in columns.clone() {
            let pixel = (y * film.width + x) as usize;
            let (m, v) = (film.mean(pixel), film.variance_of_mean(pixel));
            for c in 0..3 {
                mean[c] += m[c] / count;
                variance[c] += v[c] / (count * count);
            }
        }
    }
    Estimate {
        mean,
        error: variance.map(f64::sqrt),
    }
}

/// Fails unless the picture's mean is `expected` in every channel, and its standard error below
/// `precision` · `expected`, so that the test means something.
pub fn assert_radiance(name: &str, film: &Film, expected: f64, precision: f64) {
    assert_estimate(name, &estimate(film), [expected; 3], precision);
}

/// Fails unless every pixel is `expected` but for rounding: for pictures without noise, whose
/// film's variance is rounding too.
pub fn assert_exact(name: &str, film: &Film, expected: [f64; 3]) {
    for i in 0..film.pixels.len() {
        let mean = film.mean(i);
        let close = |c: usize| (mean[c] - expected[c]).abs() <= ROUNDING * expected[c];
        assert!(
            (0..3).all(close),
            "{name}, pixel {i}: {mean:?}, expected {expected:?}"
        );
    }
}

/// As [`assert_radiance`], for an estimate and an expectation in each channel.
pub fn assert_estimate(name: &str, estimate: &Estimate, expected: [f64; 3], precision: f64) {
    for c in 0..3 {
        let (mean, error, expected) = (estimate.mean[c], estimate.error[c], expected[c]);
        let line = format!(
            "{name}, channel {c}: {mean:.7} ± {error:.7}, expected {expected:.7} ({:+.2} standard errors)",
            (mean - expected) / error.max(f64::MIN_POSITIVE)
        );
        println!("{line}");
        assert!(error <= precision * expected, "too noisy to tell: {line}");
        let tolerance = MAX_Z * error + ROUNDING * expected;
        assert!((mean - expected).abs() <= tolerance, "{line}");
    }
}

/// Fails unless the picture's mean lies in an interval, up to noise, and its standard error is
/// below `precision` times the upper end.
pub fn assert_between(name: &str, film: &Film, low: f64, high: f64, precision: f64) {
    let e = estimate(film);
    for c in 0..3 {
        let (mean, error) = (e.mean[c], e.error[c]);
        let line = format!("{name}: {mean:.7} ± {error:.7}, expected {low:.7} to {high:.7}");
        println!("{line}");
        assert!(error <= precision * high, "too noisy to tell: {line}");
        let slack = MAX_Z * error + ROUNDING * high;
        assert!((low - slack..=high + slack).contains(&mean), "{line}");
    }
}

/// Means and variances of the means, interleaved.
pub struct Planes {
    pub mean: Vec<f32>,
    pub variance: Vec<f32>,
    pub samples: f64,
}

impl Planes {
    /// Of a film.
    pub fn new(film: &Film) -> Self {
        let values = |value: &dyn Fn(usize) -> [f64; 3]| {
            let all = (0..film.pixels.len()).flat_map(|i| value(i).map(|x| x as f32));
            all.collect()
        };
        Self {
            mean: values(&|i| film.mean(i)),
            variance: values(&|i| film.variance_of_mean(i)),
            samples: f64::from(film.spp_range().0),
        }
    }

    /// As the comparison takes them.
    pub fn image(&self) -> MeanImage<'_> {
        MeanImage {
            mean: &self.mean,
            variance_of_mean: &self.variance,
            degrees_of_freedom: self.samples - 1.0,
        }
    }
}

/// Compares two films of one size by tile; false alarms at most `alpha` in all.
pub fn compare_films(a: &Film, b: &Film, tile: usize, alpha: f64) -> Verdict {
    let size = (a.width as usize, a.height as usize);
    let (a, b) = (Planes::new(a), Planes::new(b));
    let verdict: Result<Verdict, StatisticsError> =
        compare(&a.image(), &b.image(), size, tile, alpha);
    verdict.expect("films of one size")
}
