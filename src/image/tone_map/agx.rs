//! AgX, base look.
//!
//! Troy Sobotka's AgX (github.com/sobotka/AgX) in the working space of Blender's
//! version, Rec. 2020: the inset and outset matrices are those of Eary Chow's
//! `AgXBaseRec2020.py` as Filament and three.js publish them. The curve is
//! Sobotka's generating sigmoid itself, where those two use a polynomial fitted
//! to it: so it is monotone, and black and white are exact; the difference stays
//! below 0.007 in display code values of [0, 1].

use super::multiply;

/// Linear Rec. 709 to linear Rec. 2020, from the primaries of BT.709 and BT.2020 at D65.
const TO_REC2020: [[f64; 3]; 3] = [
    [
        0.627_403_895_934_699,
        0.329_283_038_377_884,
        0.043_313_065_687_417,
    ],
    [
        0.069_097_289_358_232,
        0.919_540_395_075_459,
        0.011_362_315_566_309,
    ],
    [
        0.016_391_438_875_150,
        0.088_013_307_877_226,
        0.895_595_253_247_624,
    ],
];

/// Its inverse.
const FROM_REC2020: [[f64; 3]; 3] = [
    [
        1.660_491_002_108_435,
        -0.587_641_138_788_550,
        -0.072_849_863_319_885,
    ],
    [
        -0.124_550_474_521_591,
        1.132_899_897_125_96,
        -0.008_349_422_604_370,
    ],
    [
        -0.018_150_763_354_905,
        -0.100_578_898_008_007,
        1.118_729_661_362_913,
    ],
];

/// Pulls the primaries inwards, so that saturated light can go towards white.
const INSET: [[f64; 3]; 3] = [
    [
        0.856_627_153_315_983,
        0.095_121_240_538_158_8,
        0.048_251_606_145_858_3,
    ],
    [
        0.137_318_972_929_847,
        0.761_241_990_602_591,
        0.101_439_036_467_562,
    ],
    [
        0.111_898_212_999_950,
        0.076_799_418_603_190_3,
        0.811_302_368_396_859,
    ],
];

/// Pushes them out again after the curve.
const OUTSET: [[f64; 3]; 3] = [
    [
        1.127_100_581_814_436_8,
        -0.110_606_643_096_603_23,
        -0.016_493_938_717_834_573,
    ],
    [
        -0.141_329_763_498_438_3,
        1.157_823_702_216_272,
        -0.016_493_938_717_834_257,
    ],
    [
        -0.141_329_763_498_438_26,
        -0.110_606_643_096_602_94,
        1.251_936_406_595_040_5,
    ],
];

/// Stops below and above middle grey (0.18) that the curve covers.
const STOPS: [f64; 2] = [10.0, 6.5];
/// Where middle grey comes to lie on the curve's axes: in log light, and in display code.
const PIVOT: [f64; 2] = [STOPS[0] / (STOPS[0] + STOPS[1]), 0.5];
/// Contrast at the pivot.
const SLOPE: f64 = 2.0;
/// Sharpness of the curve's toe and shoulder.
const POWER: [f64; 2] = [3.0, 3.25];

/// Non-negative linear Rec. 709 to display light; may leave [0, 1] where Rec. 709 is too small.
pub(super) fn map(colour: [f64; 3]) -> [f64; 3] {
    let inset = multiply(&INSET, multiply(&TO_REC2020, colour));
    let code = multiply(&OUTSET, inset.map(|c| curve(log_position(c))));
    // The curve gives code values for a display with an exponent of 2.2.
    multiply(&FROM_REC2020, code.map(|c| c.max(0.0).powf(2.2)))
}

/// 0 at ten stops under middle grey and below, 1 at six and a half above and beyond.
fn log_position(light: f64) -> f64 {
    let stops = (light / 0.18).log2();
    ((stops + STOPS[0]) / (STOPS[0] + STOPS[1])).clamp(0.0, 1.0)
}

/// A line of the given slope through the pivot, bent by x/(1 + xᵖ)^(1/p) on either
/// side so that it ends in (0, 0) and (1, 1).
fn curve(x: f64) -> f64 {
    let from_pivot = x - PIVOT[0];
    let (run, rise, power) = if from_pivot < 0.0 {
        (PIVOT[0], PIVOT[1], POWER[0])
    } else {
        (1.0 - PIVOT[0], 1.0 - PIVOT[1], POWER[1])
    };
    // Solve for the bend that reaches `rise` at a distance of `run`.
    let bend = ((SLOPE / rise).powf(power) - run.powf(-power)).max(0.0);
    let line = SLOPE * from_pivot;
    PIVOT[1] + line * (1.0 + bend * from_pivot.abs().powf(power)).powf(-1.0 / power)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_curve_ends_exactly_and_rises() {
        assert!(curve(0.0).abs() < 1e-15 && (curve(1.0) - 1.0).abs() < 1e-15);
        assert_eq!(curve(PIVOT[0]), 0.5);
        let values: Vec<f64> = (0..=1000).map(|i| curve(f64::from(i) / 1000.0)).collect();
        assert!(values.windows(2).all(|w| w[0] < w[1]));
    }

    #[test]
    fn the_curve_is_what_the_published_polynomial_fits() {
        // B. Wrensch, "Minimal AgX Implementation" (2023), sixth degree, as in three.js.
        let polynomial = |x: f64| {
            let coefficients = [15.5, -40.14, 31.96, -6.868, 0.4298, 0.1191, -0.00232];
            coefficients.iter().fold(0.0, |sum, c| sum * x + c)
        };
        for i in 0..=1000 {
            let x = f64::from(i) / 1000.0;
            assert!((curve(x) - polynomial(x)).abs() < 0.007, "{x}");
        }
    }

    #[test]
    fn the_matrices_keep_white_and_undo_each_other() {
        for matrix in [&TO_REC2020, &FROM_REC2020, &INSET, &OUTSET] {
            for c in multiply(matrix, [1.0; 3]) {
                assert!((c - 1.0).abs() < 1e-14, "{c}");
            }
        }
        for axis in [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]] {
            let back = multiply(&FROM_REC2020, multiply(&TO_REC2020, axis));
            for (a, b) in back.iter().zip(axis) {
                assert!((a - b).abs() < 1e-13);
            }
        }
    }
}
