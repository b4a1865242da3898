use super::{MetricError, mean};

/// Relative mean squared error: mean((x − r)² / (r² + 0.01)), without unit.
///
/// The customary measure of noise (Rousselle, Knaus, Zwicker 2011); the 0.01
/// keeps dark pixels from ruling it.
///
/// # Errors
/// Pictures of different sizes, or none.
pub fn rel_mse(image: &[f32], reference: &[f32]) -> Result<f64, MetricError> {
    mean(image, reference, |x, r| (x - r) * (x - r) / (r * r + 0.01))
}
