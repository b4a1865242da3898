//! By hand.
#![allow(clippy::unwrap_used)] // A test that cannot set itself up has failed.

use super::*;

const X: [f32; 6] = [1.0, 2.0, 3.0, 0.0, 0.5, 1.0];
const R: [f32; 6] = [1.0, 1.0, 1.0, 1.0, 1.0, 1.0];

fn assert_close(got: f64, expected: f64) {
    assert!((got - expected).abs() < 1e-12, "{got} is not {expected}");
}

#[test]
fn values_by_hand() {
    assert_close(mse(&X, &R).unwrap(), 6.25 / 6.0);
    assert_close(rmse(&X, &R).unwrap(), (6.25_f64 / 6.0).sqrt());
    assert_close(relative_bias(&X, &R).unwrap(), 1.5 / 6.0);
    assert_close(rel_mse(&X, &R).unwrap(), 6.25 / 1.01 / 6.0);
    let smape_sum = 2.0 / 3.01 + 4.0 / 4.01 + 2.0 / 1.01 + 1.0 / 1.51;
    assert_close(smape(&X, &R).unwrap(), smape_sum / 6.0);
}

#[test]
fn a_picture_is_equal_to_itself() {
    for metric in [mse, rmse, relative_bias, rel_mse, smape] {
        assert_eq!(metric(&X, &X).unwrap(), 0.0);
    }
    assert_eq!(psnr(&X, &X).unwrap(), f64::INFINITY);
    assert_eq!(relative_bias(&[0.0; 3], &[0.0; 3]).unwrap(), 0.0);
    assert_eq!(relative_bias(&[1.0; 3], &[0.0; 3]).unwrap(), f64::INFINITY);
}

#[test]
fn psnr_looks_at_the_display() {
    // Black against Neutral's 0.76 = 0.8 − 0.04, sRGB-encoded.
    let code = 1.055 * 0.76_f64.powf(1.0 / 2.4) - 0.055;
    let got = psnr(&[0.8_f32; 3], &[0.0; 3]).unwrap();
    assert!((got + 20.0 * code.log10()).abs() < 1e-6, "{got}");
    // What no display tells apart, the metric hardly does.
    assert!(psnr(&[1e30; 3], &[1e31; 3]).unwrap() > 100.0);
    assert_close(psnr(&[f32::NAN; 3], &[0.0; 3]).unwrap(), 0.0);
}

#[test]
fn sizes_must_agree() {
    for metric in [mse, rmse, relative_bias, rel_mse, smape, psnr] {
        let mismatch = MetricError::SizeMismatch {
            image: 6,
            reference: 3,
        };
        assert_eq!(metric(&X, &R[..3]), Err(mismatch));
        assert_eq!(metric(&[], &[]), Err(MetricError::NotRgb { samples: 0 }));
        assert_eq!(
            metric(&X[..4], &R[..4]),
            Err(MetricError::NotRgb { samples: 4 })
        );
    }
}

#[test]
fn a_nan_is_not_averaged_away() {
    for metric in [mse, rmse, relative_bias, rel_mse, smape] {
        assert!(metric(&[f32::NAN, 0.0, 0.0], &[1.0; 3]).unwrap().is_nan());
    }
}
