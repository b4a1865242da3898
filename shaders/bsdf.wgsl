// The layered BSDF of glTF and its extensions. From the top: clear coat, sheen, a GGX specular layer
// (perhaps under a thin film), and below it what is diffuse or passes through. A layer leaves to those
// below what it does not reflect itself, by its directional albedo at wo (Turquin 2019, Practical Multiple
// Scattering Compensation for Microfacet Models): so a white material reflects all that arrives, whatever
// its layers. All directions are local: z is the shading normal, on the side of wo.

#include "bsdf/albedo.wgsl"
#include "bsdf/choice.wgsl"
#include "bsdf/clearcoat.wgsl"
#include "bsdf/diffuse.wgsl"
#include "bsdf/fresnel.wgsl"
#include "bsdf/ggx.wgsl"
#include "bsdf/iridescence.wgsl"
#include "bsdf/sheen.wgsl"
#include "bsdf/specular.wgsl"
#include "bsdf/transmission.wgsl"
#include "guide.wgsl"

// Whether light that bounces between microfacets is put back. Without it a rough white metal reflects as
// little as 0.31 of what arrives, as GGX in most renderers does.
override MULTIPLE_SCATTERING: bool = true;

// Whether light goes through any surface.
const TRANSMITS: bool = HAS_TRANSMISSION || HAS_DIFFUSE_TRANSMISSION;

// What a material is at a point, seen from one side.
struct BsdfParameters {
    base_color: vec3f,
    metallic: f32,
    // Perceptual, in [0, 1].
    roughness: f32,
    // GGX alpha along the local x and y axes.
    alpha: vec2f,
    // Index of refraction: of the far side over the near one, or, if nothing is transmitted, of the layer.
    // 0 stands for Schlick's term.
    eta: f32,
    // Strength and colour of the dielectric reflection.
    specular: f32,
    specular_color: vec3f,
    // First numbers of the tables for eta; glass_table is that of its side.
    albedo_table: u32,
    glass_table: u32,
    transmission: f32,
    thin: bool,
    diffuse_transmission: f32,
    diffuse_transmission_color: vec3f,
    clearcoat: f32,
    clearcoat_roughness: f32,
    clearcoat_normal: vec3f,
    sheen_color: vec3f,
    sheen_roughness: f32,
    film: Film,
}

// Lobes with their weights for one wo.
struct Bsdf {
    // Reflectances of the Lambertian lobes on either side.
    diffuse: vec3f,
    diffuse_transmission: vec3f,
    // The specular lobe's reflectance towards a half vector at a cosine c: f0 + dielectric * dielectric_weight(c)
    // + metal * schlick_weight(c).
    alpha: vec2f,
    eta: f32,
    f0: vec3f,
    dielectric: vec3f,
    metal: vec3f,
    // Weight of what the specular layer lets pass, 1 - passing_f0 - passing_f90 * dielectric_weight(c).
    transmission: vec3f,
    thin: bool,
    passing_f0: f32,
    passing_f90: f32,
    // A film adds its reflectance over a dielectric and over a metal, given by what these reflect at normal
    // incidence, times weights; its strength is how much of the light that would pass it changes.
    film: Film,
    film_f0: vec3f,
    film_weight: vec3f,
    film_metal_f0: vec3f,
    film_metal_weight: vec3f,
    coat: Clearcoat,
    sheen: vec3f,
    sheen_alpha: f32,
    // Probabilities that bsdf_sample draws from a lobe; the rest is the diffuse lobe's.
    p_specular: f32,
    p_transmission: f32,
    p_coat: f32,
    p_sheen: f32,
    p_diffuse_transmission: f32,
    // Where the diffuse lobe's directions preferably go, if HAS_GUIDE or RECORDS_PATHS.
    guide: Guide,
}

struct BsdfSample {
    // Local direction, below the surface if it is transmitted; its z is 0 if there is none.
    wi: vec3f,
    // f * |cos| / density.
    weight: vec3f,
    // bsdf_pdf, the density over solid angle but for what a guide changes; of no meaning if delta.
    pdf: f32,
    // Whether wi is the only direction of its lobe.
    delta: bool,
    // What a guide made of the density, 1 without one; in the weight.
    guided: f32,
}

fn bsdf_of(m: BsdfParameters, wo: vec3f) -> Bsdf {
    var bsdf: Bsdf;
    bsdf.alpha = m.alpha;
    bsdf.eta = m.eta;
    bsdf.thin = m.thin;
    // What the layers above leave.
    var below = vec3f(1.0);
    if (HAS_CLEARCOAT && m.clearcoat > 0.0) {
        below *= add_clearcoat(&bsdf, m, wo);
    }
    if (HAS_SHEEN && max_component(m.sheen_color) > 0.0) {
        bsdf.sheen_alpha = m.sheen_roughness * m.sheen_roughness;
        let albedo = albedo_at(ALBEDO_SHEEN, wo.z, m.sheen_roughness);
        // Smoother than about 0.25 the model reflects more than arrives at grazing angles, up to three times as
        // much: it is brought down to all.
        bsdf.sheen = below * m.sheen_color / max(albedo, 1.0);
        below *= 1.0 - max_component(m.sheen_color) * min(albedo, 1.0);
    }
    var base = (1.0 - m.metallic) * below;
    if (HAS_SPECULAR) {
        base *= add_specular(&bsdf, m, wo, below);
    }
    var reflected = m.base_color;
    if (HAS_TRANSMISSION) {
        bsdf.transmission *= m.base_color;
        reflected *= 1.0 - m.transmission;
    }
    if (HAS_DIFFUSE_TRANSMISSION) {
        let passing = (1.0 - m.transmission) * m.diffuse_transmission;
        bsdf.diffuse_transmission = base * passing * m.diffuse_transmission_color;
        reflected *= 1.0 - m.diffuse_transmission;
    }
    bsdf.diffuse = base * reflected;
    choose_probabilities(&bsdf, wo);
    return bsdf;
}

// Adds the coat; gives what it leaves.
fn add_clearcoat(bsdf: ptr<function, Bsdf>, m: BsdfParameters, wo: vec3f) -> f32 {
    let alpha = m.clearcoat_roughness * m.clearcoat_roughness;
    let cos_o = dot(wo, m.clearcoat_normal);
    var albedo = clearcoat_fresnel(cos_o);
    var compensation = 1.0;
    if (!ggx_is_delta(vec2f(alpha))) {
        let ggx = albedo_at(ALBEDO_GGX, cos_o, m.clearcoat_roughness);
        compensation = 1.0 + CLEARCOAT_F0 * lost_share(ggx);
        albedo = compensation * mix(CLEARCOAT_F0 * ggx, ggx, albedo_at(ALBEDO_SCHLICK, cos_o, m.clearcoat_roughness) / ggx);
    }
    (*bsdf).coat = Clearcoat(m.clearcoat * compensation, alpha, m.clearcoat_normal);
    return 1.0 - m.clearcoat * albedo;
}

// What microfacets of albedo 1 lose, in units of what they keep.
fn lost_share(ggx: f32) -> f32 {
    return select(0.0, (1.0 - ggx) / ggx, MULTIPLE_SCATTERING);
}

fn has_coat(bsdf: Bsdf) -> bool {
    return HAS_CLEARCOAT && bsdf.coat.strength > 0.0;
}

fn has_sheen(bsdf: Bsdf) -> bool {
    return HAS_SHEEN && max_component(bsdf.sheen) > 0.0;
}

// BSDF without delta lobes, times |cos| of wi, for radiance (refraction divides it by eta^2).
fn bsdf_eval(b: Bsdf, wo: vec3f, wi: vec3f) -> vec3f {
    if (wi.z > 0.0) {
        return reflection_eval(b, wo, wi);
    }
    var f = vec3f(0.0);
    if (HAS_DIFFUSE_TRANSMISSION) {
        f += diffuse_eval(b.diffuse_transmission) * -wi.z;
    }
    if (has_transmission(b) && !bsdf_transmission_is_delta(b)) {
        let h = transmission_normal(wo, wi, b.eta, b.thin);
        let share = passing_share(b, max(dot(wo, h), 0.0)) * radiance_scale(b);
        f += b.transmission * (share * transmission_eval(b.alpha, b.eta, b.thin, wo, wi, h));
    }
    return f;
}

fn reflection_eval(b: Bsdf, wo: vec3f, wi: vec3f) -> vec3f {
    var f = diffuse_eval(b.diffuse) * wi.z;
    if (has_specular(b) && !specular_is_delta(b)) {
        let h = normalize(wo + wi);
        f += specular_reflectance(b, dot(wi, h)) * ggx_eval(b.alpha, wo, wi, h);
    }
    if (has_coat(b) && !clearcoat_is_delta(b.coat)) {
        f += vec3f(clearcoat_eval(b.coat, wo, wi));
    }
    if (has_sheen(b)) {
        f += b.sheen * sheen_eval(b.sheen_alpha, wo, wi);
    }
    return f;
}

// Radiance in a medium goes with the square of its index.
fn radiance_scale(b: Bsdf) -> f32 {
    return select(1.0 / (b.eta * b.eta), 1.0, b.thin);
}

// Density over solid angle with which bsdf_sample returns wi (delta lobes apart).
fn bsdf_pdf(b: Bsdf, wo: vec3f, wi: vec3f) -> f32 {
    if (wi.z > 0.0) {
        return reflection_pdf(b, wo, wi);
    }
    var pdf = 0.0;
    if (HAS_DIFFUSE_TRANSMISSION) {
        pdf += b.p_diffuse_transmission * diffuse_pdf(vec3f(wi.xy, -wi.z));
    }
    if (b.p_transmission > 0.0 && !bsdf_transmission_is_delta(b)) {
        let h = transmission_normal(wo, wi, b.eta, b.thin);
        pdf += b.p_transmission * transmission_pdf(b.alpha, b.eta, b.thin, wo, wi, h);
    }
    return pdf;
}

fn reflection_pdf(b: Bsdf, wo: vec3f, wi: vec3f) -> f32 {
    var pdf = p_diffuse(b) * diffuse_pdf(wi);
    if (b.p_specular > 0.0 && !specular_is_delta(b)) {
        pdf += b.p_specular * ggx_pdf(b.alpha, wo, normalize(wo + wi));
    }
    if (b.p_coat > 0.0 && !clearcoat_is_delta(b.coat)) {
        pdf += b.p_coat * clearcoat_pdf(b.coat, wo, wi);
    }
    if (b.p_sheen > 0.0) {
        pdf += b.p_sheen * sheen_pdf(wi);
    }
    return pdf;
}

fn no_bsdf_sample() -> BsdfSample {
    return BsdfSample(vec3f(0.0), vec3f(0.0), 0.0, false, 1.0);
}

// Draw a direction: `u` moves it inside a lobe, `u_lobe` chooses the lobe.
fn bsdf_sample(b: Bsdf, wo: vec3f, u: vec2f, u_lobe: f32) -> BsdfSample {
    var wi: vec3f;
    var guided = 1.0;
    var below = b.p_specular;
    let in_specular = u_lobe < below;
    let in_transmission = !in_specular && u_lobe < below + b.p_transmission;
    below += b.p_transmission;
    let in_coat = !in_specular && !in_transmission && u_lobe < below + b.p_coat;
    below += b.p_coat;
    let in_sheen = u_lobe >= below && u_lobe < below + b.p_sheen;
    below += b.p_sheen;
    if (HAS_SPECULAR && in_specular) {
        if (specular_is_delta(b)) {
            return BsdfSample(vec3f(-wo.xy, wo.z), specular_reflectance(b, wo.z) / b.p_specular, 0.0, true, 1.0);
        }
        wi = ggx_sample(b.alpha, wo, u);
    } else if (HAS_TRANSMISSION && in_transmission) {
        if (bsdf_transmission_is_delta(b)) {
            wi = transmission_direction(wo, b.eta, b.thin);
            let weight = b.transmission * (passing_share(b, wo.z) * radiance_scale(b) / b.p_transmission);
            return BsdfSample(wi, weight, 0.0, true, 1.0);
        }
        wi = transmission_sample(b.alpha, b.eta, b.thin, wo, u);
    } else if (HAS_CLEARCOAT && in_coat) {
        if (clearcoat_is_delta(b.coat)) {
            let weight = b.coat.strength * clearcoat_fresnel(dot(wo, b.coat.normal)) / b.p_coat;
            wi = clearcoat_mirror(b.coat, wo);
            return BsdfSample(vec3f(wi.xy, max(wi.z, 0.0)), vec3f(weight), 0.0, true, 1.0);
        }
        wi = clearcoat_sample(b.coat, wo, u);
    } else if (HAS_SHEEN && in_sheen) {
        wi = sheen_sample(u);
    } else if (HAS_DIFFUSE_TRANSMISSION && u_lobe < below + b.p_diffuse_transmission) {
        let up = diffuse_sample(u);
        wi = vec3f(up.xy, -up.z);
    } else if (HAS_GUIDE || RECORDS_PATHS) {
        let point = guided_point(b.guide, u);
        wi = guided_cosine(b.guide, point.u);
        guided = point.density;
    } else {
        wi = diffuse_sample(u);
    }
    // Lobes reflect or transmit, never both: what leaves on the wrong side is lost.
    if ((in_specular || in_coat) && wi.z <= 0.0) {
        return no_bsdf_sample();
    }
    if (HAS_CLEARCOAT && in_coat && !clearcoat_reflects(b.coat, wo, wi)) {
        return no_bsdf_sample();
    }
    let pdf = bsdf_pdf(b, wo, wi);
    if (wi.z == 0.0 || !(pdf > 0.0)) {
        return no_bsdf_sample();
    }
    return BsdfSample(wi, bsdf_eval(b, wo, wi) / (pdf * guided), pdf, false, guided);
}

// Whether bsdf_sample draws from the diffuse lobe.
fn draws_diffuse(b: Bsdf, u_lobe: f32) -> bool {
    return u_lobe >= b.p_specular + b.p_transmission + b.p_coat + b.p_sheen + b.p_diffuse_transmission;
}

// Whether any light is scattered that does not keep to the direction of a mirror or of refraction.
fn bsdf_has_smooth_part(b: Bsdf) -> bool {
    return max_component(b.diffuse) > 0.0
        || (has_specular(b) && !specular_is_delta(b))
        || (has_coat(b) && !clearcoat_is_delta(b.coat))
        || has_sheen(b)
        || bsdf_has_smooth_transmission(b);
}

// Whether some lobe has a single direction.
fn bsdf_has_delta(b: Bsdf) -> bool {
    return (has_specular(b) && specular_is_delta(b))
        || (has_transmission(b) && bsdf_transmission_is_delta(b))
        || (has_coat(b) && clearcoat_is_delta(b.coat));
}

fn bsdf_has_smooth_transmission(b: Bsdf) -> bool {
    return (HAS_DIFFUSE_TRANSMISSION && max_component(b.diffuse_transmission) > 0.0)
        || (has_transmission(b) && !bsdf_transmission_is_delta(b));
}
