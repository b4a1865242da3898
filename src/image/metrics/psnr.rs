use super::{MetricError, check};
use crate::image::DisplaySettings;

/// Peak signal-to-noise ratio, decibel: −10 lg mean((d(x) − d(r))²), infinite if they look alike.
///
/// d is the default display ([`DisplaySettings::default`]: exposure 0, PBR Neutral,
/// sRGB-encoded, not rounded to 8 bits), whose peak is 1. A pixel that is not
/// finite counts as white against black.
///
/// # Errors
/// Pictures of different sizes, or none.
pub fn psnr(image: &[f32], reference: &[f32]) -> Result<f64, MetricError> {
    check(image, reference)?;
    let pixels = image.as_chunks().0.iter().zip(reference.as_chunks().0);
    let sum: f64 = pixels.map(|(&x, &r)| squared_error(x, r)).sum();
    Ok(-10.0 * (sum / image.len() as f64).log10())
}

/// Summed over a pixel's channels.
fn squared_error(x: [f32; 3], r: [f32; 3]) -> f64 {
    let display = DisplaySettings::default();
    match (display.show(x), display.show(r)) {
        (Some(x), Some(r)) => x.iter().zip(r).map(|(x, r)| (x - r) * (x - r)).sum(),
        _ => 3.0,
    }
}
