//! ACES: the reference rendering transform and the sRGB output transform, fitted.
//!
//! Stephen Hill's fit (BakingLab, `ACES.hlsl`, 2016), whose numbers these are. No
//! factor 1/0.6 before it: that is three.js's choice of exposure, not part of the fit.

use super::multiply;

/// Linear Rec. 709 to ACEScg primaries at D60, with the RRT's desaturation.
const INPUT: [[f64; 3]; 3] = [
    [0.59719, 0.35458, 0.04823],
    [0.07600, 0.90834, 0.01566],
    [0.02840, 0.13383, 0.83777],
];

/// Back, with the ODT's desaturation.
const OUTPUT: [[f64; 3]; 3] = [
    [1.60475, -0.53108, -0.07367],
    [-0.10208, 1.10813, -0.00605],
    [-0.00327, -0.07276, 1.07602],
];

/// Non-negative linear Rec. 709 to display light; may leave [0, 1] a little.
pub(super) fn map(colour: [f64; 3]) -> [f64; 3] {
    let curve = |v: f64| {
        (v * (v + 0.024_578_6) - 0.000_090_537) / (v * (0.983_729 * v + 0.432_951_0) + 0.238_081)
    };
    multiply(&OUTPUT, multiply(&INPUT, colour).map(curve))
}
