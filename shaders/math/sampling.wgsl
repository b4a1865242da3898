// Maps from the unit square, each next to its density.

#include "math/trigonometry.wgsl"
#include "math/float.wgsl"

// Uniform on the unit disc, keeping neighbours together
// (Shirley and Chiu 1997, A Low Distortion Map Between Disk and Square).
fn sample_disc_concentric(u: vec2f) -> vec2f {
    let p = 2.0 * u - 1.0;
    if (p.x == 0.0 && p.y == 0.0) {
        return vec2f(0.0);
    }
    // An eighth of a turn per unit of the ratio of the smaller to the larger coordinate.
    if (abs(p.x) > abs(p.y)) {
        return p.x * cos_sin_2pi(0.125 * (p.y / p.x));
    }
    return p.y * cos_sin_2pi(0.25 - 0.125 * (p.x / p.y));
}

// Density cos(theta) / pi over solid angle, around +z.
fn sample_cosine_hemisphere(u: vec2f) -> vec3f {
    let d = sample_disc_concentric(u);
    return vec3f(d, sqrt(max(0.0, 1.0 - dot(d, d))));
}

fn pdf_cosine_hemisphere(cos_theta: f32) -> f32 {
    return max(cos_theta, 0.0) * INV_PI;
}

// Density 1 / 2 pi over solid angle, around +z.
fn sample_uniform_hemisphere(u: vec2f) -> vec3f {
    let r = sqrt(max(0.0, 1.0 - u.x * u.x));
    return vec3f(r * cos_sin_2pi(u.y), u.x);
}

fn pdf_uniform_hemisphere() -> f32 {
    return INV_2PI;
}

// Density 1 / 4 pi over solid angle.
fn sample_uniform_sphere(u: vec2f) -> vec3f {
    let z = 1.0 - 2.0 * u.x;
    let r = 2.0 * sqrt(max(0.0, u.x * (1.0 - u.x)));
    return vec3f(r * cos_sin_2pi(u.y), z);
}

// Barycentric coordinates of v0, v1, v2, uniform over area
// (Heitz 2019, A Low-Distortion Map Between Triangle and Square).
fn sample_triangle_uniform(u: vec2f) -> vec3f {
    var b0 = 0.5 * u.x;
    var b1 = u.y - b0;
    if (u.y <= u.x) {
        b1 = 0.5 * u.y;
        b0 = u.x - b1;
    }
    return vec3f(b0, b1, max(0.0, 1.0 - b0 - b1));
}

// Density over [0, 1] that goes from `a` to `b`, up to a factor, linearly; neither is negative
// (Pharr, Jakob and Humphreys 2023, section A.4.1; divided by the sum, so that no square overflows).
fn sample_linear(u: f32, a: f32, b: f32) -> f32 {
    let sum = a + b;
    if (sum <= 0.0) {
        return u;
    }
    let from_density = a / sum;
    let to_density = b / sum;
    let root = from_density + sqrt(mix(square(from_density), square(to_density), u));
    return select(0.0, min(u / root, 1.0), root > 0.0);
}

// Weight of a sample of density `pdf` where another technique has density `other`
// (Veach 1997, power heuristic with exponent 2, in a form that does not overflow).
fn power_heuristic(pdf: f32, other: f32) -> f32 {
    if (pdf == 0.0) {
        return 0.0;
    }
    return 1.0 / (1.0 + square(other / pdf));
}

// Where a uniform number lies between two ends, as another one: so that one number makes all decisions
// and well-spread numbers stay so. Bits that the number has used up are taken from `more`.
fn renewed(number: u32, lower: u32, count: u32, more: u32) -> u32 {
    let offset = f32(number - lower) + f32(more >> 16u) * 1.52587890625e-5;
    let share = min(offset / f32(count), ONE_BELOW);
    return (floor_to_u32(share * 16777216.0) << 8u) | ((more >> 8u) & 255u);
}
