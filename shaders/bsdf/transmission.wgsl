// Specular transmission through GGX microfacets: refraction into a solid (Walter et al. 2007, Microfacet
// Models for Refraction through Rough Surfaces), or straight through a thin wall, which scatters as the
// reflection does, mirrored to the far side (KHR_materials_transmission). Without the Fresnel term.
//
// eta is the index on the far side over that on wo's; wi lies below the surface.

#include "bsdf/ggx.wgsl"

// Whether the lobe is a single direction: its width falls with the change of index, too.
fn transmission_is_delta(alpha: vec2f, eta: f32, thin: bool) -> bool {
    let bend = select(2.0 * abs(eta - 1.0), 1.0, thin);
    return max(alpha.x, alpha.y) * bend < GGX_SMOOTHEST;
}

// The microfacet normal between wo and its refraction wi, on wo's side.
fn refraction_normal(wo: vec3f, wi: vec3f, eta: f32) -> vec3f {
    let h = wo + eta * wi;
    return normalize(select(h, -h, h.z < 0.0));
}

// Microfacet normal of a pair of directions, thin or not.
fn transmission_normal(wo: vec3f, wi: vec3f, eta: f32, thin: bool) -> vec3f {
    if (thin) {
        return normalize(wo + vec3f(wi.xy, -wi.z));
    }
    return refraction_normal(wo, wi, eta);
}

// The BTDF times |cos| of wi, for importance: radiance changes by 1 / eta^2 on top of it.
fn transmission_eval(alpha: vec2f, eta: f32, thin: bool, wo: vec3f, wi: vec3f, h: vec3f) -> f32 {
    let above = vec3f(wi.xy, -wi.z);
    if (thin) {
        return ggx_eval(alpha, wo, above, h);
    }
    let jacobian = refraction_jacobian(wo, wi, h, eta);
    return ggx_distribution(alpha, h) * ggx_masking(alpha, wo, wi) * max(dot(wo, h), 0.0) * jacobian / wo.z;
}

// Density over the solid angle of wi.
fn transmission_pdf(alpha: vec2f, eta: f32, thin: bool, wo: vec3f, wi: vec3f, h: vec3f) -> f32 {
    if (thin) {
        return ggx_pdf(alpha, wo, h);
    }
    return ggx_visible_normal_pdf(alpha, wo, h) * refraction_jacobian(wo, wi, h, eta);
}

// Solid angle of normals over that of refracted directions (Walter et al. 2007, equation 17); 0 if h does
// not refract wo into wi.
fn refraction_jacobian(wo: vec3f, wi: vec3f, h: vec3f, eta: f32) -> f32 {
    let cos_o = dot(wo, h);
    let cos_i = dot(wi, h);
    if (cos_o <= 0.0 || cos_i >= 0.0) {
        return 0.0;
    }
    return square(eta / (cos_o + eta * cos_i)) * -cos_i;
}

// A direction below the surface; z is 0 where there is none.
fn transmission_sample(alpha: vec2f, eta: f32, thin: bool, wo: vec3f, u: vec2f) -> vec3f {
    if (thin) {
        let wi = ggx_sample(alpha, wo, u);
        return vec3f(wi.xy, min(-wi.z, 0.0));
    }
    let wi = refract_about(wo, ggx_sample_normal(alpha, wo, u), eta);
    return vec3f(wi.xy, min(wi.z, 0.0));
}

// wo refracted about h; the null vector if it is reflected totally.
fn refract_about(wo: vec3f, h: vec3f, eta: f32) -> vec3f {
    let cos_o = dot(wo, h);
    let cos2_i = (eta * eta - 1.0 + cos_o * cos_o) / (eta * eta);
    if (cos2_i <= 0.0) {
        return vec3f(0.0);
    }
    return (cos_o / eta - sqrt(cos2_i)) * h - wo / eta;
}

// Where a smooth surface sends the light that passes.
fn transmission_direction(wo: vec3f, eta: f32, thin: bool) -> vec3f {
    if (thin) {
        return -wo;
    }
    return refract_about(wo, vec3f(0.0, 0.0, 1.0), eta);
}
