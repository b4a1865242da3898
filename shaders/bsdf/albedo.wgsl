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
    let low = mix(bsdf_tables[at], bsdf_tables[at + 1u], fx);
    let next = at + ALBEDO_COSINES;
    let high = mix(bsdf_tables[next], bsdf_tables[next + 1u], fx);
    return mix(low, high, y - f32(row));
}
