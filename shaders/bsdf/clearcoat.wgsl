// A clear coat: GGX with Schlick's term of an index of 1.5 (KHR_materials_clearcoat), about a normal of its
// own. Directions are those of the base's frame; the cosine is the one about the coat's normal.

#include "bsdf/fresnel.wgsl"
#include "bsdf/ggx.wgsl"
#include "math/frame.wgsl"

const CLEARCOAT_F0: f32 = 0.04;

struct Clearcoat {
    // Coverage, compensation of multiple scattering included; 0 where there is none.
    strength: f32,
    alpha: f32,
    // Its normal in the frame of the base.
    normal: vec3f,
}

fn clearcoat_fresnel(cos_theta: f32) -> f32 {
    return mix(CLEARCOAT_F0, 1.0, schlick_weight(cos_theta));
}

fn clearcoat_is_delta(coat: Clearcoat) -> bool {
    return ggx_is_delta(vec2f(coat.alpha));
}

// Whether both directions are on the outer side of the coat.
fn clearcoat_reflects(coat: Clearcoat, wo: vec3f, wi: vec3f) -> bool {
    return dot(wo, coat.normal) > 0.0 && dot(wi, coat.normal) > 0.0;
}

// BRDF times the cosine.
fn clearcoat_eval(coat: Clearcoat, wo: vec3f, wi: vec3f) -> f32 {
    let frame_ = frame_from_z(coat.normal);
    let o = to_local(frame_, wo);
    let i = to_local(frame_, wi);
    if (o.z <= 0.0 || i.z <= 0.0) {
        return 0.0;
    }
    let h = normalize(o + i);
    return coat.strength * clearcoat_fresnel(dot(o, h)) * ggx_eval(vec2f(coat.alpha), o, i, h);
}

// Density over solid angle.
fn clearcoat_pdf(coat: Clearcoat, wo: vec3f, wi: vec3f) -> f32 {
    let frame_ = frame_from_z(coat.normal);
    let o = to_local(frame_, wo);
    let i = to_local(frame_, wi);
    if (o.z <= 0.0 || i.z <= 0.0) {
        return 0.0;
    }
    return ggx_pdf(vec2f(coat.alpha), o, normalize(o + i));
}

fn clearcoat_sample(coat: Clearcoat, wo: vec3f, u: vec2f) -> vec3f {
    let frame_ = frame_from_z(coat.normal);
    return to_world(frame_, ggx_sample(vec2f(coat.alpha), to_local(frame_, wo), u));
}

// The mirror direction of a smooth coat.
fn clearcoat_mirror(coat: Clearcoat, wo: vec3f) -> vec3f {
    return 2.0 * dot(wo, coat.normal) * coat.normal - wo;
}
