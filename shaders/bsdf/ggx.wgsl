// GGX microfacets with height-correlated Smith shadowing, possibly anisotropic
// (Walter et al. 2007; Heitz 2014, Understanding the Masking-Shadowing Function, JCGT 3(2)).
// alpha.x is the roughness along the local x axis, alpha.y along y.

#include "math/sampling.wgsl"

// Smoother than this a lobe is a mirror: half of it lies within 0.06 degrees.
const GGX_SMOOTHEST: f32 = 1.0e-3;
// The least roughness across a stretched lobe.
const ANISOTROPIC_SMOOTHEST: f32 = 1.0e-4;

// Whether masking and shadowing go with the height of the microfacet (glTF 2.0, appendix B). Without it they are
// independent, as in Mitsuba's rough conductor and rough dielectric, and rough surfaces are darker.
override HEIGHT_CORRELATED: bool = true;

// Density of microfacet normals. The sum of squares has no cancellation, even at the peak.
fn ggx_distribution(alpha: vec2f, h: vec3f) -> f32 {
    let a = alpha.x * alpha.y;
    let v = vec3f(h.x * alpha.y, h.y * alpha.x, h.z * a);
    let k = dot(v, v) / a;
    return a * INV_PI / (k * k);
}

// 1 + 2 Lambda, so that G1 = 2 / (1 + this); w may be on either side.
fn ggx_lambda_term(alpha: vec2f, w: vec3f) -> f32 {
    let across = alpha * w.xy;
    return sqrt(w.z * w.z + dot(across, across)) / abs(w.z);
}

// The share of microfacets that are seen from both wo and wi, on either side: G2.
fn ggx_masking(alpha: vec2f, wo: vec3f, wi: vec3f) -> f32 {
    let o = ggx_lambda_term(alpha, wo);
    let i = ggx_lambda_term(alpha, wi);
    if (HEIGHT_CORRELATED) {
        return 2.0 / (o + i);
    }
    return 4.0 / ((1.0 + o) * (1.0 + i));
}

fn ggx_is_delta(alpha: vec2f) -> bool {
    return max(alpha.x, alpha.y) < GGX_SMOOTHEST;
}

// The BRDF without its Fresnel term, times the cosine of wi: D G2 / (4 cos_o).
fn ggx_eval(alpha: vec2f, wo: vec3f, wi: vec3f, h: vec3f) -> f32 {
    return ggx_distribution(alpha, h) * ggx_masking(alpha, wo, wi) / (4.0 * wo.z);
}

// Density over solid angle of the normals visible from wo.
fn ggx_visible_normal_pdf(alpha: vec2f, wo: vec3f, h: vec3f) -> f32 {
    let g1 = 2.0 / (1.0 + ggx_lambda_term(alpha, wo));
    return g1 * ggx_distribution(alpha, h) * max(dot(wo, h), 0.0) / wo.z;
}

// Density over the solid angle of wi when h is drawn from the normals visible from wo.
fn ggx_pdf(alpha: vec2f, wo: vec3f, h: vec3f) -> f32 {
    let g1 = 2.0 / (1.0 + ggx_lambda_term(alpha, wo));
    return g1 * ggx_distribution(alpha, h) / (4.0 * wo.z);
}

// A normal visible from wo (Dupuy and Benyoub 2023, Sampling Visible GGX Normals with Spherical Caps).
fn ggx_sample_normal(alpha: vec2f, wo: vec3f, u: vec2f) -> vec3f {
    let stretched = normalize(vec3f(wo.xy * alpha, wo.z));
    // A point on the cap of the unit sphere above z = -stretched.z.
    let z = (1.0 - u.y) * (1.0 + stretched.z) - stretched.z;
    let r = sqrt(clamp(1.0 - z * z, 0.0, 1.0));
    let cap = vec3f(r * cos_sin_2pi(u.x), z);
    let h = cap + stretched;
    return normalize(vec3f(h.xy * alpha, h.z));
}

// Reflect wo about a normal visible from it. The direction may lie below the surface; its pdf is then of
// no use.
fn ggx_sample(alpha: vec2f, wo: vec3f, u: vec2f) -> vec3f {
    let normal = ggx_sample_normal(alpha, wo, u);
    return 2.0 * dot(wo, normal) * normal - wo;
}
