use super::{MetricError, mean};

/// Signed relative bias: (mean(x) − mean(r)) / mean(r). Positive: too bright.
///
/// Two black pictures have a bias of 0; anything against black is infinite.
///
/// # Errors
/// Pictures of different sizes, or none.
pub fn relative_bias(image: &[f32], reference: &[f32]) -> Result<f64, MetricError> {
    // Sum the differences, not the pictures: no cancellation of large sums.
    let difference = mean(image, reference, |x, r| x - r)?;
    if difference == 0.0 {
        return Ok(0.0);
    }
    Ok(difference / mean(image, reference, |_, r| r)?)
}
