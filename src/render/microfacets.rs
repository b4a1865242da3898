//! What the shaders' lobes do, in f64: the integrands of their albedo tables.
//!
//! The formulas and their sources are those of `shaders/bsdf/`.

use glam::DVec3;

/// Λ of the Smith model times 2, plus 1; `w` may be on either side.
fn lambda_term([x, y]: [f64; 2], w: DVec3) -> f64 {
    (w.z * w.z + (x * w.x).powi(2) + (y * w.y).powi(2)).sqrt() / w.z.abs()
}

/// A normal visible from `wo` (Dupuy and Benyoub 2023).
fn visible_normal([x, y]: [f64; 2], wo: DVec3, [u, v]: [f64; 2]) -> DVec3 {
    let stretched = DVec3::new(wo.x * x, wo.y * y, wo.z).normalize();
    let z = (1.0 - v) * (1.0 + stretched.z) - stretched.z;
    let r = (1.0 - z * z).max(0.0).sqrt();
    let (sin, cos) = (std::f64::consts::TAU * u).sin_cos();
    let h = DVec3::new(r * cos, r * sin, z) + stretched;
    DVec3::new(h.x * x, h.y * y, h.z).normalize()
}

/// A direction at a cosine.
fn direction(cos_theta: f64) -> DVec3 {
    DVec3::new(
        (1.0 - cos_theta * cos_theta).max(0.0).sqrt(),
        0.0,
        cos_theta,
    )
}

/// Schlick's weight.
pub fn schlick_weight(cos_theta: f64) -> f64 {
    (1.0 - cos_theta).clamp(0.0, 1.0).powi(5)
}

/// Unpolarised reflectance of a dielectric, `eta` being the index on the far side over that on the near one.
pub fn fresnel_dielectric(cos_theta: f64, eta: f64) -> f64 {
    let c = cos_theta.clamp(0.0, 1.0);
    let g2 = eta * eta - 1.0 + c * c;
    if g2 <= 0.0 {
        return if eta < 1.0 { 1.0 } else { 0.0 };
    }
    let g = g2.sqrt();
    let s = (g - c) / (g + c);
    let p = (c * (g + c) - 1.0) / (c * (g - c) + 1.0);
    0.5 * s * s * (1.0 + p * p)
}

/// Where the reflectance lies between those at normal (0) and at grazing incidence (1).
pub fn dielectric_weight(cos_theta: f64, eta: f64) -> f64 {
    let f0 = ((eta - 1.0) / (eta + 1.0)).powi(2);
    ((fresnel_dielectric(cos_theta, eta) - f0) / (1.0 - f0)).clamp(0.0, 1.0)
}

/// What a visible normal brings: the weight of the direction in which it reflects, and the cosine of `wo` to it.
/// `u` is uniform on the unit square; the mean over it is the albedo.
pub fn reflection(alpha: f64, cos_o: f64, u: [f64; 2]) -> (f64, f64) {
    let wo = direction(cos_o);
    let h = visible_normal([alpha; 2], wo, u);
    (reflected(wo, h, [alpha; 2]), wo.dot(h))
}

/// The same for a lobe of roughness `alpha` along x and y.
pub fn stretched_reflection(alpha: [f64; 2], wo: DVec3, u: [f64; 2]) -> f64 {
    reflected(wo, visible_normal(alpha, wo, u), alpha)
}

/// The weight of the mirror direction about a visible normal.
fn reflected(wo: DVec3, h: DVec3, alpha: [f64; 2]) -> f64 {
    let wi = 2.0 * wo.dot(h) * h - wo;
    if wi.z > 0.0 {
        masking(alpha, wo, wi)
    } else {
        0.0
    }
}

/// What a visible normal reflects and refracts of a white dielectric.
pub fn glass(alpha: f64, eta: f64, cos_o: f64, u: [f64; 2]) -> f64 {
    let (wo, alpha) = (direction(cos_o), [alpha; 2]);
    let h = visible_normal(alpha, wo, u);
    let cos_h = wo.dot(h);
    let f = fresnel_dielectric(cos_h, eta);
    let reflected = f * reflected(wo, h, alpha);
    let cos2_i = (eta * eta - 1.0 + cos_h * cos_h) / (eta * eta);
    if cos2_i <= 0.0 {
        return reflected;
    }
    let down = (cos_h / eta - cos2_i.sqrt()) * h - wo / eta;
    let passes = down.z < 0.0;
    reflected
        + if passes {
            (1.0 - f) * masking(alpha, wo, down)
        } else {
            0.0
        }
}

/// G2 / G1.
fn masking(alpha: [f64; 2], wo: DVec3, wi: DVec3) -> f64 {
    let (o, i) = (lambda_term(alpha, wo), lambda_term(alpha, wi));
    (1.0 + o) / (o + i)
}

/// The sheen's BRDF times the cosine of the direction at `u`, over its density, uniform over the hemisphere.
pub fn sheen(alpha: f64, cos_o: f64, [u, v]: [f64; 2]) -> f64 {
    let alpha = alpha.max(1e-3);
    let wo = direction(cos_o);
    let (sin, cos) = (std::f64::consts::TAU * u).sin_cos();
    let r = (1.0 - v * v).max(0.0).sqrt();
    let wi = DVec3::new(r * cos, r * sin, v);
    let h = (wo + wi).normalize();
    let inverse = 1.0 / alpha;
    let sin2 = h.x * h.x + h.y * h.y;
    let distribution = (2.0 + inverse) * sin2.powf(0.5 * inverse) / std::f64::consts::TAU;
    let masking = 1.0 / (1.0 + sheen_lambda(wo.z, alpha) + sheen_lambda(wi.z, alpha));
    distribution * masking / (4.0 * wo.z) * std::f64::consts::TAU
}

fn sheen_lambda(cos_theta: f64, alpha: f64) -> f64 {
    let t = (1.0 - alpha).powi(2);
    let mix = |rough: f64, smooth: f64| rough + (smooth - rough) * t;
    let (a, b, c) = (
        mix(21.5473, 25.3245),
        mix(3.82987, 3.32435),
        mix(0.19823, 0.16801),
    );
    let (d, e) = (mix(-1.97760, -1.27393), mix(-4.32054, -4.85967));
    let curve = |x: f64| a / (1.0 + b * x.powf(c)) + d * x + e;
    if cos_theta < 0.5 {
        curve(cos_theta).exp()
    } else {
        (2.0 * curve(0.5) - curve(1.0 - cos_theta)).exp()
    }
}
