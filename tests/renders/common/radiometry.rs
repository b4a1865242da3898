//! Irradiance and reflection in closed form or by quadrature, in f64.

use std::f64::consts::PI;

use etendue::scene::EnvironmentImage;
use glam::DVec3;

/// Irradiance at `p` (unit normal `n`) of a convex polygon of radiance 1 that emits to the side
/// from which its corners turn left: Lambert's ½ Σ θᵢ (Γᵢ·n) over the part above the horizon.
pub fn polygon_irradiance(corners: &[DVec3], p: DVec3, n: DVec3) -> f64 {
    let seen: Vec<DVec3> = corners.iter().map(|c| *c - p).collect();
    if !turns_towards(&seen) {
        return 0.0;
    }
    let above = clip_to_horizon(&seen, n);
    let edges = (0..above.len()).map(|i| (above[i], above[(i + 1) % above.len()]));
    let sum: f64 = edges.map(|(a, b)| edge(a, b, n)).sum();
    0.5 * sum.abs()
}

fn turns_towards(corners: &[DVec3]) -> bool {
    let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
    normal.dot(corners[0]) < 0.0
}

/// θ (Γ·n): the angle between two corners and the unit normal of the plane that they span.
fn edge(a: DVec3, b: DVec3, n: DVec3) -> f64 {
    let cross = a.cross(b);
    let angle = cross.length().atan2(a.dot(b));
    cross.normalize_or_zero().dot(n) * angle
}

/// Sutherland and Hodgman's clip by the plane through the receiver.
fn clip_to_horizon(corners: &[DVec3], n: DVec3) -> Vec<DVec3> {
    let mut above = Vec::new();
    for (i, &a) in corners.iter().enumerate() {
        let b = corners[(i + 1) % corners.len()];
        let (height_a, height_b) = (a.dot(n), b.dot(n));
        if height_a >= 0.0 {
            above.push(a);
        }
        if (height_a >= 0.0) != (height_b >= 0.0) {
            above.push(a + (b - a) * (height_a / (height_a - height_b)));
        }
    }
    above
}

/// Schlick's Fresnel term.
pub fn schlick(f0: f64, f90: f64, cos_theta: f64) -> f64 {
    f0 + (f90 - f0) * (1.0 - cos_theta).powi(5)
}

/// Unpolarised reflectance of a smooth dielectric by Fresnel's equations; `eta` is the index on the far side over
/// that on the near one. Exactly 0 between equal ones.
pub fn fresnel(cos_theta: f64, eta: f64) -> f64 {
    if eta == 1.0 {
        return 0.0;
    }
    let sin2 = (1.0 - cos_theta * cos_theta) / (eta * eta);
    if sin2 >= 1.0 {
        return 1.0;
    }
    let cos_t = (1.0 - sin2).sqrt();
    let s = (cos_theta - eta * cos_t) / (cos_theta + eta * cos_t);
    let p = (eta * cos_theta - cos_t) / (eta * cos_theta + cos_t);
    0.5 * (s * s + p * p)
}

/// Directional albedo of a GGX layer with Schlick's Fresnel term between f0 and 1, seen at the
/// cosine `mu`: the integral of D F G₂ (wo·h) / µ over the half vectors h, with the substitution
/// tan²θ = α² t / (1 − t) that makes D cosθ dω uniform in (t, φ). Midpoint rule.
pub fn ggx_albedo(alpha: f64, f0: f64, mu: f64) -> f64 {
    const STEPS: usize = 1500;
    let wo = DVec3::new((1.0 - mu * mu).sqrt(), 0.0, mu);
    let term = |w: DVec3| {
        let tan2 = (1.0 - w.z * w.z).max(0.0) / (w.z * w.z);
        (1.0 + alpha * alpha * tan2).sqrt()
    };
    let mut sum = 0.0;
    for i in 0..STEPS {
        let t = (i as f64 + 0.5) / STEPS as f64;
        let cos = ((1.0 - t) / (1.0 - t + alpha * alpha * t)).sqrt();
        let sin = (1.0 - cos * cos).sqrt();
        for j in 0..STEPS {
            let phi = PI * (j as f64 + 0.5) / STEPS as f64;
            let h = DVec3::new(sin * phi.cos(), sin * phi.sin(), cos);
            let cos_h = wo.dot(h);
            let wi = 2.0 * cos_h * h - wo;
            if cos_h > 0.0 && wi.z > 0.0 {
                let g2 = 2.0 / (term(wo) + term(wi));
                sum += schlick(f0, 1.0, cos_h) * g2 * cos_h / (mu * cos);
            }
        }
    }
    sum / (STEPS * STEPS) as f64
}

/// Radiance of an equirectangular picture, bilinear between texel centres, round about along u,
/// clamped along v: u = 0.5 + atan2(d.z, d.x)/2π, v = acos(d.y)/π. One channel.
pub fn sky_radiance(image: &EnvironmentImage, d: DVec3, channel: usize) -> f64 {
    let (width, height) = (image.width as i64, image.height as i64);
    let u = 0.5 + d.z.atan2(d.x) / (2.0 * PI);
    let v = d.y.clamp(-1.0, 1.0).acos() / PI;
    let (x, y) = (u * width as f64 - 0.5, v * height as f64 - 0.5);
    let (fx, fy) = (x - x.floor(), y - y.floor());
    let texel = |dx: i64, dy: i64| {
        let column = (x.floor() as i64 + dx).rem_euclid(width);
        let row = (y.floor() as i64 + dy).clamp(0, height - 1);
        f64::from(image.texels[(row * width + column) as usize][channel])
    };
    let mix = |a: f64, b: f64, t: f64| a + (b - a) * t;
    mix(
        mix(texel(0, 0), texel(1, 0), fx),
        mix(texel(0, 1), texel(1, 1), fx),
        fy,
    )
}

/// Irradiance on a surface of normal `n` under a radiance given by direction: midpoint rule over
/// the sphere.
pub fn sky_irradiance(radiance: impl Fn(DVec3) -> f64, n: DVec3) -> f64 {
    const ROWS: usize = 1024;
    const COLUMNS: usize = 2 * ROWS;
    let mut sum = 0.0;
    for row in 0..ROWS {
        let (sin, cos) = (PI * (row as f64 + 0.5) / ROWS as f64).sin_cos();
        for column in 0..COLUMNS {
            let (s, c) = (2.0 * PI * (column as f64 + 0.5) / COLUMNS as f64).sin_cos();
            let d = DVec3::new(sin * c, cos, sin * s);
            let cos_n = d.dot(n);
            if cos_n > 0.0 {
                sum += radiance(d) * cos_n * sin;
            }
        }
    }
    sum * (PI / ROWS as f64) * (2.0 * PI / COLUMNS as f64)
}
