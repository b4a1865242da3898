// The specular layer of a Bsdf (bsdf.wgsl): metal and dielectric mixed, perhaps under a thin film, with what
// refraction lets through.

// Adds the specular lobes, of which `above` is left; gives what a dielectric leaves to the diffuse base.
fn add_specular(bsdf: ptr<function, Bsdf>, m: BsdfParameters, wo: vec3f, above: vec3f) -> f32 {
    if (m.metallic == 0.0 && m.specular == 0.0 && (!HAS_TRANSMISSION || m.transmission == 0.0)) {
        return 1.0;
    }
    let normal = select(normal_reflectance(m.eta), 1.0, m.eta == 0.0);
    let f0 = min(normal * m.specular_color, vec3f(1.0)) * m.specular;
    let f90 = m.specular;
    var ggx = 1.0;
    var weight = dielectric_weight(wo.z, m.eta);
    if (!ggx_is_delta(m.alpha)) {
        ggx = albedo_at(ALBEDO_GGX, wo.z, m.roughness);
        // Nothing lies below a metal.
        if (m.metallic < 1.0) {
            let table = select(m.albedo_table, ALBEDO_SCHLICK, m.eta == 0.0);
            weight = albedo_at(table, wo.z, m.roughness) / ggx;
        }
    }
    if (HAS_ANISOTROPY && m.alpha.x != m.alpha.y) {
        ggx = stretched_albedo(wo, m.alpha);
    }
    let lost = lost_share(ggx);
    let for_metal = m.metallic * (1.0 + m.base_color * lost);
    var of_dielectric = 1.0 + f0 * lost;
    var albedo = max_component(of_dielectric * mix(f0, vec3f(f90), weight)) * ggx;
    if (HAS_TRANSMISSION && m.transmission > 0.0) {
        var glass = 1.0;
        if (MULTIPLE_SCATTERING && !ggx_is_delta(m.alpha) && (m.thin || m.glass_table != NONE)) {
            if (m.thin) {
                glass = 1.0 / ggx;
            } else {
                glass = 1.0 / albedo_at(m.glass_table, wo.z, m.roughness);
            }
        }
        (*bsdf).transmission = above * ((1.0 - m.metallic) * m.transmission * glass);
        of_dielectric = mix(of_dielectric, vec3f(glass), m.transmission);
    }
    let for_dielectric = (1.0 - m.metallic) * of_dielectric;
    (*bsdf).passing_f0 = max_component(f0);
    (*bsdf).passing_f90 = f90 - max_component(f0);
    var bare = above;
    if (HAS_IRIDESCENCE && m.film.strength > 0.0) {
        (*bsdf).film = m.film;
        (*bsdf).film_f0 = f0;
        (*bsdf).film_metal_f0 = m.base_color;
        (*bsdf).film_weight = above * (m.film.strength * m.specular) * for_dielectric;
        (*bsdf).film_metal_weight = above * m.film.strength * for_metal;
        bare *= 1.0 - m.film.strength;
        var cos_film = wo.z;
        if (!ggx_is_delta(m.alpha)) {
            // The cosine at which Schlick's weight is its mean over the microfacets.
            cos_film = 1.0 - pow(albedo_at(ALBEDO_SCHLICK, wo.z, m.roughness) / ggx, 0.2);
        }
        let film_albedo = max_component(film_reflectance(*bsdf, f0, cos_film)) * m.specular * ggx;
        albedo = mix(albedo, max_component(of_dielectric) * film_albedo, m.film.strength);
    }
    (*bsdf).f0 = bare * (for_metal * m.base_color + for_dielectric * f0);
    (*bsdf).metal = bare * (for_metal * (1.0 - m.base_color));
    (*bsdf).dielectric = bare * (for_dielectric * (vec3f(f90) - f0));
    return max(0.0, 1.0 - albedo);
}

// What a film over a base reflects; from inside of a solid as much as from where that light would go.
fn film_reflectance(bsdf: Bsdf, f0: vec3f, cos_h: f32) -> vec3f {
    if (bsdf.thin || bsdf.eta >= 1.0 || bsdf.eta == 0.0) {
        return film_fresnel(bsdf.film, f0, cos_h);
    }
    if (reflects_totally(cos_h, bsdf.eta)) {
        return vec3f(1.0);
    }
    let cos_outside = sqrt(max(0.0, 1.0 - (1.0 - cos_h * cos_h) / (bsdf.eta * bsdf.eta)));
    return film_fresnel(bsdf.film, f0, cos_outside);
}

// The specular lobe's reflectance towards a half vector.
fn specular_reflectance(bsdf: Bsdf, cos_h: f32) -> vec3f {
    var reflectance = bsdf.f0 + bsdf.dielectric * dielectric_weight(cos_h, bsdf.eta) + bsdf.metal * schlick_weight(cos_h);
    if (HAS_IRIDESCENCE && bsdf.film.strength > 0.0) {
        reflectance += bsdf.film_weight * film_reflectance(bsdf, bsdf.film_f0, cos_h)
            + bsdf.film_metal_weight * film_reflectance(bsdf, bsdf.film_metal_f0, cos_h);
    }
    return reflectance;
}

// What the specular layer lets pass towards a half vector.
fn passing_share(bsdf: Bsdf, cos_h: f32) -> f32 {
    if (reflects_totally(cos_h, bsdf.eta) && !bsdf.thin) {
        return 0.0;
    }
    let bare = 1.0 - bsdf.passing_f0 - bsdf.passing_f90 * dielectric_weight(cos_h, bsdf.eta);
    if (HAS_IRIDESCENCE && bsdf.film.strength > 0.0) {
        let film = 1.0 - max_component(film_reflectance(bsdf, bsdf.film_f0, cos_h));
        return mix(bare, film, bsdf.film.strength);
    }
    return bare;
}

fn has_specular(bsdf: Bsdf) -> bool {
    let reflectance = bsdf.f0 + bsdf.dielectric + bsdf.metal + bsdf.film_weight + bsdf.film_metal_weight;
    return HAS_SPECULAR && max_component(reflectance) > 0.0;
}

fn specular_is_delta(bsdf: Bsdf) -> bool {
    return ggx_is_delta(bsdf.alpha);
}

fn has_transmission(bsdf: Bsdf) -> bool {
    return HAS_TRANSMISSION && max_component(bsdf.transmission) > 0.0;
}

fn bsdf_transmission_is_delta(bsdf: Bsdf) -> bool {
    return transmission_is_delta(bsdf.alpha, bsdf.eta, bsdf.thin);
}
