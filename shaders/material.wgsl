// From a material and its textures to the numbers that a BSDF needs.

#include "surface.wgsl"

// The parameters of glTF's appendix B layering, evaluated at a point.
struct Bsdf {
    // Diffuse reflectance, (1 - metallic) * base_color.
    diffuse: vec3f,
    // GGX alpha, the square of the perceptual roughness.
    alpha: f32,
    // Specular reflectance at normal incidence, dielectric and metal mixed.
    f0: vec3f,
    // Specular reflectance at grazing incidence, likewise.
    f90: f32,
    // Largest channel of the dielectric part at normal and grazing incidence: what the specular
    // layer takes from the diffuse one.
    dielectric_f0: f32,
    dielectric_f90: f32,
}

fn base_color_at(s: Surface) -> vec4f {
    var color = materials[s.material].base_color * s.color;
    if (HAS_BASE_COLOR_TEXTURE) {
        let slot = materials[s.material].base_color_texture;
        if (slot.texture != NONE) {
            color *= sample_texture(slot, s.uv0, s.uv1);
        }
    }
    return color;
}

// Radiance that the surface emits towards wo. Emission is one-sided unless the material is double-sided.
fn emitted_radiance(s: Surface) -> vec3f {
    if (!HAS_EMISSION && !HAS_UNLIT) {
        return vec3f(0.0);
    }
    let flags = materials[s.material].flags;
    if (HAS_UNLIT && (flags & MATERIAL_UNLIT) != 0u) {
        return base_color_at(s).rgb;
    }
    if (s.back_face && (flags & MATERIAL_DOUBLE_SIDED) == 0u) {
        return vec3f(0.0);
    }
    return emissive_at(s.material, s.uv0, s.uv1);
}

fn emissive_at(material: u32, uv0: vec2f, uv1: vec2f) -> vec3f {
    var emissive = materials[material].emissive;
    if (HAS_EMISSIVE_TEXTURE) {
        let slot = materials[material].emissive_texture;
        if (slot.texture != NONE) {
            emissive *= sample_texture(slot, uv0, uv1).rgb;
        }
    }
    return emissive;
}

fn is_unlit(s: Surface) -> bool {
    return HAS_UNLIT && (materials[s.material].flags & MATERIAL_UNLIT) != 0u;
}

fn bsdf_at(s: Surface) -> Bsdf {
    let base_color = base_color_at(s).rgb;
    var metallic = materials[s.material].metallic;
    var roughness = materials[s.material].roughness;
    if (HAS_METALLIC_ROUGHNESS_TEXTURE) {
        let slot = materials[s.material].metallic_roughness_texture;
        if (slot.texture != NONE) {
            let texel = sample_texture(slot, s.uv0, s.uv1);
            roughness *= texel.g;
            metallic *= texel.b;
        }
    }
    var specular = materials[s.material].specular;
    var specular_color = materials[s.material].specular_color;
    if (HAS_SPECULAR_TEXTURE) {
        let slot = materials[s.material].specular_texture;
        if (slot.texture != NONE) {
            specular *= sample_texture(slot, s.uv0, s.uv1).a;
        }
    }
    if (HAS_SPECULAR_COLOR_TEXTURE) {
        let slot = materials[s.material].specular_color_texture;
        if (slot.texture != NONE) {
            specular_color *= sample_texture(slot, s.uv0, s.uv1).rgb;
        }
    }
    // KHR_materials_specular: the colour acts at normal incidence, the strength everywhere.
    let f0 = min(materials[s.material].ior_f0 * specular_color, vec3f(1.0)) * specular;
    var bsdf: Bsdf;
    bsdf.diffuse = (1.0 - metallic) * base_color;
    bsdf.alpha = roughness * roughness;
    bsdf.f0 = mix(f0, base_color, metallic);
    bsdf.f90 = mix(specular, 1.0, metallic);
    bsdf.dielectric_f0 = max_component(f0);
    bsdf.dielectric_f90 = specular;
    return bsdf;
}
