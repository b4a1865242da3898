use super::{MetricError, mean};

/// Symmetric mean absolute percentage error: mean(2|x − r| / (|x| + |r| + 0.01)), from 0 to 2.
///
/// Bounded, so that a single firefly does not rule it (Vogels et al. 2018, section 5).
///
/// # Errors
/// Pictures of different sizes, or none.
pub fn smape(image: &[f32], reference: &[f32]) -> Result<f64, MetricError> {
    mean(image, reference, |x, r| {
        2.0 * (x - r).abs() / (x.abs() + r.abs() + 0.01)
    })
}
