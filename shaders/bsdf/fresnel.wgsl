// Fresnel terms: Schlick's, and the exact one of a dielectric.

#include "math/float.wgsl"

// Schlick's weight between the reflectances at normal and at grazing incidence (Schlick 1994).
fn schlick_weight(cos_theta: f32) -> f32 {
    let m = clamp(1.0 - cos_theta, 0.0, 1.0);
    let m2 = m * m;
    return m2 * m2 * m;
}

// Unpolarised reflectance of a smooth dielectric; eta is the index on the far side over that on the side
// of incidence. 1 beyond the critical angle; exactly 0 at eta = 1.
fn fresnel_dielectric(cos_theta: f32, eta: f32) -> f32 {
    let c = clamp(cos_theta, 0.0, 1.0);
    // eta cos of the refracted ray, squared. The factors of 1 - eta keep what cancels near eta = 1.
    let difference = (eta - 1.0) * (eta + 1.0);
    let g2 = difference + c * c;
    if (g2 <= 0.0) {
        return select(0.0, 1.0, eta < 1.0);
    }
    let g = sqrt(g2);
    // (g - c) (g + c) = difference.
    let s = difference / square(g + c);
    // 1 + (c (g + c) - 1) / (c (g - c) + 1), squared and times a half, after its division.
    let p = (c * (g + c) - 1.0) / (c * difference / (g + c) + 1.0);
    return 0.5 * s * s * (1.0 + p * p);
}

// ((eta - 1) / (eta + 1))^2.
fn normal_reflectance(eta: f32) -> f32 {
    return square((eta - 1.0) / (eta + 1.0));
}

// Where the dielectric reflectance at an angle lies between those at normal (0) and at grazing incidence
// (1). An index of 0 stands for Schlick's term.
fn dielectric_weight(cos_theta: f32, eta: f32) -> f32 {
    if (eta == 0.0) {
        return schlick_weight(cos_theta);
    }
    let f0 = normal_reflectance(eta);
    return clamp((fresnel_dielectric(cos_theta, eta) - f0) / (1.0 - f0), 0.0, 1.0);
}

// Whether nothing is refracted at this angle.
fn reflects_totally(cos_theta: f32, eta: f32) -> bool {
    return eta > 0.0 && (eta - 1.0) * (eta + 1.0) + cos_theta * cos_theta <= 0.0;
}
