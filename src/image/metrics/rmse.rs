use super::{MetricError, mse};

/// Root of the mean squared error: √mean((x − r)²), in radiance.
///
/// # Errors
/// Pictures of different sizes, or none.
pub fn rmse(image: &[f32], reference: &[f32]) -> Result<f64, MetricError> {
    mse(image, reference).map(f64::sqrt)
}
