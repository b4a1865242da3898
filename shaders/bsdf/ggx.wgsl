// Isotropic GGX microfacets with height-correlated Smith shadowing
// (Walter et al. 2007; Heitz 2014, Understanding the Masking-Shadowing Function, JCGT 3(2)).

#include "math/sampling.wgsl"

// Smoother than this a lobe is a mirror: half of it lies within 0.06 degrees.
const GGX_SMOOTHEST: f32 = 1.0e-3;

// Density of microfacet normals. The sum of squares has no cancellation, even at the peak.
fn ggx_distribution(alpha: f32, h: vec3f) -> f32 {
    let a2 = alpha * alpha;
    let k = a2 * h.z * h.z + h.x * h.x + h.y * h.y;
    return a2 * INV_PI / (k * k);
}

// 1 + 2 Lambda, so that G1 = 2 / (1 + this).
fn ggx_lambda_term(alpha: f32, w: vec3f) -> f32 {
    return sqrt(w.z * w.z + alpha * alpha * (w.x * w.x + w.y * w.y)) / w.z;
}

// The BRDF without its Fresnel term: D G2 / (4 cos cos).
fn ggx_eval(alpha: f32, wo: vec3f, wi: vec3f, h: vec3f) -> f32 {
    let masking = 2.0 / (ggx_lambda_term(alpha, wo) + ggx_lambda_term(alpha, wi));
    return ggx_distribution(alpha, h) * masking / (4.0 * wo.z * wi.z);
}

// Density over the solid angle of wi when h is drawn from the normals visible from wo.
fn ggx_pdf(alpha: f32, wo: vec3f, h: vec3f) -> f32 {
    let g1 = 2.0 / (1.0 + ggx_lambda_term(alpha, wo));
    return g1 * ggx_distribution(alpha, h) / (4.0 * wo.z);
}

// Reflect wo about a normal visible from it (Dupuy and Benyoub 2023, Sampling Visible GGX Normals
// with Spherical Caps). The direction may lie below the surface; its pdf is then of no use.
fn ggx_sample(alpha: f32, wo: vec3f, u: vec2f) -> vec3f {
    let stretched = normalize(vec3f(wo.xy * alpha, wo.z));
    // A point on the cap of the unit sphere above z = -stretched.z.
    let z = (1.0 - u.y) * (1.0 + stretched.z) - stretched.z;
    let r = sqrt(clamp(1.0 - z * z, 0.0, 1.0));
    let cap = vec3f(r * cos_sin_2pi(u.x), z);
    let h = cap + stretched;
    let normal = normalize(vec3f(h.xy * alpha, h.z));
    return 2.0 * dot(wo, normal) * normal - wo;
}
