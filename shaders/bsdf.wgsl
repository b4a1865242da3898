// The layered BSDF of glTF 2.0 (appendix B): a GGX specular layer over a Lambertian base; both
// lobes share the half vector's Fresnel term, so that what the layer reflects the base does not
// receive. All directions are local: z is the shading normal, and both are above the surface.

#include "material.wgsl"
#include "bsdf/diffuse.wgsl"
#include "bsdf/ggx.wgsl"

struct BsdfSample {
    // Local direction; its z is 0 if there is none.
    wi: vec3f,
    // f * |cos| / pdf.
    weight: vec3f,
    // Density over solid angle; of no meaning if delta.
    pdf: f32,
    // Whether wi is the only direction of its lobe.
    delta: bool,
}

// Schlick's Fresnel term between the reflectances at normal and at grazing incidence.
fn schlick(f0: vec3f, f90: f32, cos_theta: f32) -> vec3f {
    return f0 + (vec3f(f90) - f0) * schlick_weight(cos_theta);
}

fn schlick_weight(cos_theta: f32) -> f32 {
    let m = clamp(1.0 - cos_theta, 0.0, 1.0);
    let m2 = m * m;
    return m2 * m2 * m;
}

// The fraction that passes the specular layer to the diffuse base.
fn diffuse_transmission(bsdf: Bsdf, cos_theta: f32) -> f32 {
    return 1.0 - mix(bsdf.dielectric_f0, bsdf.dielectric_f90, schlick_weight(cos_theta));
}

fn has_specular(bsdf: Bsdf) -> bool {
    return HAS_SPECULAR && max(max_component(bsdf.f0), bsdf.f90) > 0.0;
}

fn specular_is_delta(bsdf: Bsdf) -> bool {
    return bsdf.alpha < GGX_SMOOTHEST;
}

// Probability that the specular lobe is sampled: its share of an estimate of the albedo.
fn specular_probability(bsdf: Bsdf, wo: vec3f) -> f32 {
    if (!has_specular(bsdf)) {
        return 0.0;
    }
    let specular = luminance(schlick(bsdf.f0, bsdf.f90, wo.z));
    let diffuse = luminance(bsdf.diffuse) * diffuse_transmission(bsdf, wo.z);
    if (specular + diffuse <= 0.0) {
        return 1.0;
    }
    // No lobe that is there is starved.
    return select(clamp(specular / (specular + diffuse), 0.1, 0.9), 1.0, max_component(bsdf.diffuse) <= 0.0);
}

// BSDF without delta lobes, times the cosine of wi.
fn bsdf_eval(bsdf: Bsdf, wo: vec3f, wi: vec3f) -> vec3f {
    if (wi.z <= 0.0 || wo.z <= 0.0) {
        return vec3f(0.0);
    }
    let h = normalize(wo + wi);
    let cos_h = dot(wi, h);
    var f = diffuse_eval(bsdf.diffuse) * diffuse_transmission(bsdf, cos_h);
    if (has_specular(bsdf) && !specular_is_delta(bsdf)) {
        f += schlick(bsdf.f0, bsdf.f90, cos_h) * ggx_eval(bsdf.alpha, wo, wi, h);
    }
    return f * wi.z;
}

// Density over solid angle with which bsdf_sample returns wi (delta lobes apart).
fn bsdf_pdf(bsdf: Bsdf, wo: vec3f, wi: vec3f) -> f32 {
    if (wi.z <= 0.0 || wo.z <= 0.0) {
        return 0.0;
    }
    let p = specular_probability(bsdf, wo);
    var pdf = (1.0 - p) * diffuse_pdf(wi);
    if (p > 0.0 && !specular_is_delta(bsdf)) {
        pdf += p * ggx_pdf(bsdf.alpha, wo, normalize(wo + wi));
    }
    return pdf;
}

// Draw a direction: `u` moves it inside a lobe, `u_lobe` chooses the lobe.
fn bsdf_sample(bsdf: Bsdf, wo: vec3f, u: vec2f, u_lobe: f32) -> BsdfSample {
    let p = specular_probability(bsdf, wo);
    var wi: vec3f;
    if (u_lobe < p) {
        if (specular_is_delta(bsdf)) {
            let mirror = vec3f(-wo.xy, wo.z);
            return BsdfSample(mirror, schlick(bsdf.f0, bsdf.f90, wo.z) / p, 0.0, true);
        }
        wi = ggx_sample(bsdf.alpha, wo, u);
    } else {
        wi = diffuse_sample(u);
    }
    let pdf = bsdf_pdf(bsdf, wo, wi);
    if (!(pdf > 0.0)) {
        return BsdfSample(vec3f(0.0), vec3f(0.0), 0.0, false);
    }
    return BsdfSample(wi, bsdf_eval(bsdf, wo, wi) / pdf, pdf, false);
}

// Whether any light that is not in the mirror direction is reflected.
fn bsdf_has_smooth_part(bsdf: Bsdf) -> bool {
    return max_component(bsdf.diffuse) > 0.0 || (has_specular(bsdf) && !specular_is_delta(bsdf));
}
