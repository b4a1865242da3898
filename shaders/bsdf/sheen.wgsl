// Sheen of fibres that stand on the surface (Estevez and Kulla 2017, Production Friendly Microfacet Sheen
// BRDF; KHR_materials_sheen). alpha is the square of the perceptual roughness.

#include "math/sampling.wgsl"

// Smaller ones leave nothing but the last degree before grazing, and their powers underflow.
const SHEEN_SMOOTHEST: f32 = 1.0e-3;

// Density of fibre normals: (2 + 1/alpha) sin^(1/alpha) / 2 pi.
fn sheen_distribution(alpha: f32, h: vec3f) -> f32 {
    let inverse = 1.0 / alpha;
    let sin2 = h.x * h.x + h.y * h.y;
    return (2.0 + inverse) * pow(sin2, 0.5 * inverse) * INV_2PI;
}

// Equation 3 with table 1 of the paper.
fn sheen_lambda_curve(x: f32, alpha: f32) -> f32 {
    let t = square(1.0 - alpha);
    let a = mix(21.5473, 25.3245, t);
    let b = mix(3.82987, 3.32435, t);
    let c = mix(0.19823, 0.16801, t);
    let d = mix(-1.97760, -1.27393, t);
    let e = mix(-4.32054, -4.85967, t);
    return a / (1.0 + b * pow(x, c)) + d * x + e;
}

fn sheen_lambda(cos_theta: f32, alpha: f32) -> f32 {
    if (cos_theta < 0.5) {
        return exp(sheen_lambda_curve(cos_theta, alpha));
    }
    return exp(2.0 * sheen_lambda_curve(0.5, alpha) - sheen_lambda_curve(1.0 - cos_theta, alpha));
}

// The BRDF for a colour of 1, times the cosine of wi.
fn sheen_eval(alpha: f32, wo: vec3f, wi: vec3f) -> f32 {
    let a = max(alpha, SHEEN_SMOOTHEST);
    let h = normalize(wo + wi);
    let masking = 1.0 / (1.0 + sheen_lambda(wo.z, a) + sheen_lambda(wi.z, a));
    return sheen_distribution(a, h) * masking / (4.0 * wo.z);
}

// Fibres scatter widely, most towards grazing: directions are uniform. Density over solid angle.
fn sheen_pdf(wi: vec3f) -> f32 {
    return select(0.0, pdf_uniform_hemisphere(), wi.z > 0.0);
}

fn sheen_sample(u: vec2f) -> vec3f {
    return sample_uniform_hemisphere(u);
}
