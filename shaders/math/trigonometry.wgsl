// Vulkan promises sin and cos to 2^-11 absolute, and atan, asin and acos to 4096 ulp only. These
// Taylor polynomials on reduced ranges are good to a few ulp, and alike on every device.

#include "math/constants.wgsl"

// (cos, sin) of 2 pi u for |u| < 2^20, where the reduction to [-pi/4, pi/4] is exact.
fn cos_sin_2pi(u: f32) -> vec2f {
    let quarter = floor(u * 4.0 + 0.5);
    let x = (u - quarter * 0.25) * (2.0 * PI);
    let x2 = x * x;
    let s = x * (1.0 + x2 * (-1.0 / 6.0 + x2 * (1.0 / 120.0 + x2 * (-1.0 / 5040.0 + x2 / 362880.0))));
    let c = 1.0 + x2 * (-0.5 + x2 * (1.0 / 24.0 + x2 * (-1.0 / 720.0 + x2 * (1.0 / 40320.0 - x2 / 3628800.0))));
    // In the last bits of a sum whose unit in the last place is 1.
    let quadrant = bitcast<u32>(quarter + 12582912.0);
    let swapped = select(vec2f(c, s), vec2f(-s, c), (quadrant & 1u) == 1u);
    return select(swapped, -swapped, (quadrant & 2u) == 2u);
}

// Angle of the vector (x, y) in (-pi, pi]; 0 for the null vector.
fn arctan2(y: f32, x: f32) -> f32 {
    let ax = abs(x);
    let ay = abs(y);
    let larger = max(ax, ay);
    if (larger == 0.0) {
        return 0.0;
    }
    let angle = arctan_unit(min(ax, ay) / larger);
    let folded = select(angle, 0.5 * PI - angle, ay > ax);
    let half_plane = select(folded, PI - folded, x < 0.0);
    return select(half_plane, -half_plane, y < 0.0);
}

// Arc tangent for t in [0, 1], reduced to |r| <= tan(pi/8).
fn arctan_unit(t: f32) -> f32 {
    let upper = t > 0.41421356;
    let r = select(t, (t - 1.0) / (t + 1.0), upper);
    let r2 = r * r;
    let series = r * (1.0 + r2 * (-1.0 / 3.0 + r2 * (1.0 / 5.0 + r2 * (-1.0 / 7.0 + r2 * (1.0 / 9.0
        + r2 * (-1.0 / 11.0 + r2 * (1.0 / 13.0 + r2 * (-1.0 / 15.0 + r2 / 17.0))))))));
    return select(series, series + 0.25 * PI, upper);
}
