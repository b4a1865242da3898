use super::{MetricError, mean};

/// Mean squared error: mean((x − r)²), in squared radiance.
///
/// # Errors
/// Pictures of different sizes, or none.
pub fn mse(image: &[f32], reference: &[f32]) -> Result<f64, MetricError> {
    mean(image, reference, |x, r| (x - r) * (x - r))
}
