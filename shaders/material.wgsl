// From a material and its textures to the numbers that a BSDF needs.

#include "surface.wgsl"
#include "bsdf.wgsl"
#include "medium.wgsl"

fn base_color_at(s: Surface) -> vec4f {
    return material_base_color(s.material) * s.color * s.texels.base_color;
}

// Radiance that the surface emits towards wo. Emission is one-sided unless the material is double-sided.
fn emitted_radiance(s: Surface) -> vec3f {
    if (!HAS_EMISSION && !HAS_UNLIT) {
        return vec3f(0.0);
    }
    let flags = material_flags(s.material);
    if (HAS_UNLIT && (flags & MATERIAL_UNLIT) != 0u) {
        return base_color_at(s).rgb;
    }
    if (s.back_face && (flags & MATERIAL_DOUBLE_SIDED) == 0u) {
        return vec3f(0.0);
    }
    return emissive_at(s.material, s.texels, dot(s.wo, s.normal));
}

// Emitted radiance at a cosine to the triangle's normal: a clear coat reflects a part of it back. Of the texels those of
// emission and of the clear coat are needed.
fn emissive_at(material: u32, texels: Texels, cos_theta: f32) -> vec3f {
    var emissive = material_emissive(material);
    if (HAS_CLEARCOAT && material_clearcoat(material) > 0.0) {
        var clearcoat = material_clearcoat(material);
        if (HAS_CLEARCOAT_TEXTURE) {
            clearcoat *= texels.clearcoat.r;
        }
        emissive *= 1.0 - clearcoat * clearcoat_fresnel(abs(cos_theta));
    }
    if (HAS_EMISSIVE_TEXTURE) {
        emissive *= texels.emissive.rgb;
    }
    return emissive;
}

fn is_unlit(s: Surface) -> bool {
    return HAS_UNLIT && (material_flags(s.material) & MATERIAL_UNLIT) != 0u;
}

// The BSDF at a surface, in the frame s.shading.
fn bsdf_at(s: Surface, wo: vec3f, crossing: Crossing) -> Bsdf {
    return bsdf_of(bsdf_parameters(s, crossing), wo);
}

fn bsdf_parameters(s: Surface, crossing: Crossing) -> BsdfParameters {
    var m: BsdfParameters;
    m.base_color = base_color_at(s).rgb;
    m.metallic = material_metallic(s.material);
    m.roughness = material_roughness(s.material);
    if (HAS_METALLIC_ROUGHNESS_TEXTURE) {
        let texel = s.texels.metallic_roughness;
        m.roughness *= texel.g;
        m.metallic *= texel.b;
    }
    m.eta = crossing.eta;
    m.thin = true;
    m.albedo_table = material_albedo_table(s.material);
    if (HAS_SPECULAR) {
        add_specular_parameters(&m, s);
    }
    m.alpha = vec2f(m.roughness * m.roughness);
    if (HAS_ANISOTROPY && s.anisotropy > 0.0) {
        // Across the stretch a mirror is not smoother than single precision resolves.
        m.alpha = vec2f(mix(m.alpha.x, 1.0, square(s.anisotropy)), max(m.alpha.y, ANISOTROPIC_SMOOTHEST));
    }
    if (is_solid(s)) {
        m.thin = false;
        // The tables of the inside follow those of the outside.
        m.albedo_table += select(0u, ALBEDO_SIZE, s.back_face);
    }
    if (HAS_TRANSMISSION) {
        add_transmission_parameters(&m, s, crossing);
    }
    if (HAS_DIFFUSE_TRANSMISSION) {
        add_diffuse_transmission_parameters(&m, s);
    }
    if (HAS_CLEARCOAT) {
        add_clearcoat_parameters(&m, s);
    }
    if (HAS_SHEEN) {
        add_sheen_parameters(&m, s);
    }
    if (HAS_IRIDESCENCE) {
        m.film = film_at(s);
    }
    return m;
}

fn add_specular_parameters(m: ptr<function, BsdfParameters>, s: Surface) {
    (*m).specular = material_specular(s.material);
    (*m).specular_color = material_specular_color(s.material);
    if (HAS_SPECULAR_TEXTURE) {
        (*m).specular *= s.texels.specular.a;
    }
    if (HAS_SPECULAR_COLOR_TEXTURE) {
        let texel = s.texels.specular_color;
        (*m).specular_color *= texel.rgb;
        if (HAS_GLOSSINESS_TEXTURE && (material_flags(s.material) & MATERIAL_GLOSSINESS) != 0u) {
            (*m).roughness = 1.0 - (1.0 - (*m).roughness) * texel.a;
        }
    }
}

fn add_transmission_parameters(m: ptr<function, BsdfParameters>, s: Surface, crossing: Crossing) {
    (*m).transmission = material_transmission(s.material);
    if (HAS_TRANSMISSION_TEXTURE) {
        (*m).transmission *= s.texels.transmission.r;
    }
    (*m).glass_table = material_glass_table(s.material) + select(0u, ALBEDO_SIZE, s.back_face && !(*m).thin);
    if (crossing.near != NONE && crossing.far != NONE) {
        // The tables are for air on one side. Between two media the indices differ less, and so little is lost
        // that nothing is put back.
        (*m).glass_table = NONE;
    }
}

fn add_diffuse_transmission_parameters(m: ptr<function, BsdfParameters>, s: Surface) {
    (*m).diffuse_transmission = material_diffuse_transmission(s.material);
    (*m).diffuse_transmission_color = material_diffuse_transmission_color(s.material);
    if (HAS_DIFFUSE_TRANSMISSION_TEXTURE) {
        (*m).diffuse_transmission *= s.texels.diffuse_transmission.a;
        (*m).diffuse_transmission_color *= s.texels.diffuse_transmission_color.rgb;
    }
}

fn add_clearcoat_parameters(m: ptr<function, BsdfParameters>, s: Surface) {
    (*m).clearcoat = material_clearcoat(s.material);
    (*m).clearcoat_roughness = material_clearcoat_roughness(s.material);
    if (HAS_CLEARCOAT_TEXTURE) {
        (*m).clearcoat *= s.texels.clearcoat.r;
        (*m).clearcoat_roughness *= s.texels.clearcoat_roughness.g;
    }
    (*m).clearcoat_normal = to_local(s.shading, s.clearcoat_normal);
}

fn add_sheen_parameters(m: ptr<function, BsdfParameters>, s: Surface) {
    (*m).sheen_color = material_sheen_color(s.material);
    (*m).sheen_roughness = material_sheen_roughness(s.material);
    if (HAS_SHEEN_TEXTURE) {
        (*m).sheen_color *= s.texels.sheen_color.rgb;
        (*m).sheen_roughness *= s.texels.sheen_roughness.a;
    }
}

fn film_at(s: Surface) -> Film {
    var strength = material_iridescence(s.material);
    var thickness = material_iridescence_thickness_max(s.material);
    if (HAS_IRIDESCENCE_TEXTURE) {
        strength *= s.texels.iridescence.r;
        let texel = s.texels.iridescence_thickness;
        thickness = mix(material_iridescence_thickness_min(s.material), thickness, texel.g);
    }
    return Film(strength, material_iridescence_ior(s.material), 1.0e-9 * thickness);
}

