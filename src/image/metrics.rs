//! How far a picture is from its reference, as one number.
//!
//! All take interleaved R, G, B samples, linear Rec. 709, of equal number, and
//! average over pixels and channels alike, in f64. A NaN in either picture makes
//! the result NaN.

mod mse;
mod psnr;
mod rel_mse;
mod relative_bias;
mod rmse;
mod smape;

pub use mse::mse;
pub use psnr::psnr;
pub use rel_mse::rel_mse;
pub use relative_bias::relative_bias;
pub use rmse::rmse;
pub use smape::smape;

/// The two pictures cannot be compared.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum MetricError {
    /// They are of different sizes.
    #[error("the image has {image} samples, the reference {reference}")]
    SizeMismatch {
        /// Samples of the image.
        image: usize,
        /// Samples of the reference.
        reference: usize,
    },
    /// There are no samples, or not three to a pixel.
    #[error("{samples} samples are not pixels of three")]
    NotRgb {
        /// Samples of both.
        samples: usize,
    },
}

/// Refuses what is not two pictures of one size.
fn check(image: &[f32], reference: &[f32]) -> Result<(), MetricError> {
    if image.len() != reference.len() {
        return Err(MetricError::SizeMismatch {
            image: image.len(),
            reference: reference.len(),
        });
    }
    if image.is_empty() || !image.len().is_multiple_of(3) {
        return Err(MetricError::NotRgb {
            samples: image.len(),
        });
    }
    Ok(())
}

/// Mean of `term(x, r)` over all samples.
fn mean(
    image: &[f32],
    reference: &[f32],
    term: impl Fn(f64, f64) -> f64,
) -> Result<f64, MetricError> {
    check(image, reference)?;
    let terms = image.iter().zip(reference);
    let sum: f64 = terms.map(|(&x, &r)| term(x.into(), r.into())).sum();
    Ok(sum / image.len() as f64)
}

#[cfg(test)]
#[path = "metrics/tests.rs"]
mod tests;
