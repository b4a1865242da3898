// Directional albedos of lobes, from tables that the host integrates (src/render/albedo.rs): rows at
// perceptual roughnesses (j / (m - 1))^2, in each row ALBEDO_COSINES values at cosines (i / (n - 1))^4.

#include "bindings.wgsl"
#include "math/float.wgsl"

const ALBEDO_COSINES: u32 = 64u;
const ALBEDO_ROUGHNESSES: u32 = 32u;
const ALBEDO_SIZE: u32 = ALBEDO_COSINES * ALBEDO_ROUGHNESSES;
// GGX with a Fresnel term of 1, and with Schlick's weight.
const ALBEDO_GGX: u32 = 0u;
const ALBEDO_SCHLICK: u32 = ALBEDO_SIZE;
// Sheen of colour 1.
const ALBEDO_SHEEN: u32 = 2u * ALBEDO_SIZE;

fn albedo_at(first: u32, cos_theta: f32, roughness: f32) -> f32 {
    let x = sqrt(sqrt(clamp(cos_theta, 0.0, 1.0))) * f32(ALBEDO_COSINES - 1u);
    let y = sqrt(clamp(roughness, 0.0, 1.0)) * f32(ALBEDO_ROUGHNESSES - 1u);
    let column = min(floor_to_u32(x), ALBEDO_COSINES - 2u);
    let row = min(floor_to_u32(y), ALBEDO_ROUGHNESSES - 2u);
    let fx = x - f32(column);
    let at = first + row * ALBEDO_COSINES + column;
    let low = mix(load_bsdf_number(at), load_bsdf_number(at + 1u), fx);
    let next = at + ALBEDO_COSINES;
    let high = mix(load_bsdf_number(next), load_bsdf_number(next + 1u), fx);
    return mix(low, high, y - f32(row));
}

// The table of stretched lobes (src/render/stretched.rs): its axes are a root of the direction's cosine, of
// that of its azimuth from the stretch, of the roughness across, and how far the one along goes beyond it.
const STRETCHED_SIZES: vec4u = vec4u(24u, 8u, 16u, 8u);

// Albedo of GGX with a Fresnel term of 1, rougher along x than along y.
fn stretched_albedo(wo: vec3f, alpha: vec2f) -> f32 {
    let azimuth = abs(wo.x) / max(length(wo.xy), 1.0e-20);
    let across = sqrt(sqrt(alpha.y));
    let along = (sqrt(sqrt(alpha.x)) - across) / max(1.0 - across, 1.0e-6);
    let place = clamp(vec4f(sqrt(sqrt(wo.z)), sqrt(azimuth), across, along), vec4f(0.0), vec4f(1.0));
    let x = place * vec4f(STRETCHED_SIZES - 1u);
    let low = min(
        vec4u(floor_to_u32(x.x), floor_to_u32(x.y), floor_to_u32(x.z), floor_to_u32(x.w)),
        STRETCHED_SIZES - 2u,
    );
    let f = x - vec4f(low);
    let smoother = stretched_plane(low, low.w, f);
    return mix(smoother, stretched_plane(low, low.w + 1u, f), f.w);
}

fn stretched_plane(low: vec4u, along: u32, f: vec4f) -> f32 {
    let first = STRETCHED_TABLE + STRETCHED_SIZES.x * (low.y + STRETCHED_SIZES.y * (low.z + STRETCHED_SIZES.z * along));
    let next = first + STRETCHED_SIZES.x * STRETCHED_SIZES.y;
    return mix(stretched_rows(first + low.x, f), stretched_rows(next + low.x, f), f.z);
}

fn stretched_rows(at: u32, f: vec4f) -> f32 {
    let next = at + STRETCHED_SIZES.x;
    let low = mix(load_bsdf_number(at), load_bsdf_number(at + 1u), f.x);
    return mix(low, mix(load_bsdf_number(next), load_bsdf_number(next + 1u), f.x), f.y);
}
