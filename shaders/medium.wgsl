// The media that a path is in: solids of transmitting materials, each entered through a front face and left
// through a back face. Where several overlap, that of the largest rank is there alone (the host ranks smaller
// solids higher, so that what lies inside of another counts).

#include "bindings.wgsl"
#include "surface.wgsl"
#include "sampler.wgsl"

// Up to four entries, each a material's index + 1, or 0. NONE is 0 - 1.
alias Media = vec4u;

// What happens to the media at a surface.
struct Crossing {
    // Materials of the media on the near and on the far side, or NONE for air.
    near: u32,
    far: u32,
    // The media beyond the surface.
    media: Media,
    // The index of refraction on the far side over that on the near one; of an opaque surface or a thin wall
    // that of its material over that of the medium around it.
    eta: f32,
}

// The medium that is there, or NONE.
fn medium_of(media: Media) -> u32 {
    return winner(winner(media.x, media.y), winner(media.z, media.w)) - 1u;
}

// The entry of the larger rank.
fn winner(a: u32, b: u32) -> u32 {
    if (a == 0u || b == 0u) {
        return a | b;
    }
    return select(b, a, material_medium_rank(a - 1u) >= material_medium_rank(b - 1u));
}

// With one more entry, unless all are taken.
fn entered(media: Media, material: u32) -> Media {
    return replaced(media, 0u, material + 1u);
}

// With one entry of the material less, if it is there.
fn left(media: Media, material: u32) -> Media {
    return replaced(media, material + 1u, 0u);
}

// With `by` in place of the first entry `old`.
fn replaced(media: Media, old: u32, by: u32) -> Media {
    if (media.x == old) {
        return Media(by, media.yzw);
    }
    if (media.y == old) {
        return Media(media.x, by, media.zw);
    }
    if (media.z == old) {
        return Media(media.xy, by, media.w);
    }
    return Media(media.xyz, select(media.w, by, media.w == old));
}

// Index of refraction of a medium for light of a wavelength in micrometres (0: of all). Cauchy's equation
// through the index of the d line with the Abbe number 20 / dispersion (KHR_materials_dispersion).
fn medium_ior(medium: u32, wavelength: f32) -> f32 {
    if (medium == NONE) {
        return 1.0;
    }
    let ior = material_ior(medium);
    if (!HAS_DISPERSION || wavelength == 0.0) {
        return ior;
    }
    // 1 / 0.4861^2 - 1 / 0.6563^2, and 1 / 0.5876^2.
    let b = (ior - 1.0) * material_dispersion(medium) / (20.0 * 1.9103);
    return max(1.0, ior + b * (1.0 / (wavelength * wavelength) - 2.8963));
}

// Whether the surface bounds a medium that light enters.
fn is_solid(s: Surface) -> bool {
    return HAS_MEDIA && (material_flags(s.material) & MATERIAL_SOLID) != 0u;
}

// What the surface does to the media of a path that meets it.
fn crossing_at(media: Media, wavelength: f32, s: Surface) -> Crossing {
    var crossing: Crossing;
    crossing.media = media;
    crossing.near = NONE;
    crossing.far = NONE;
    if (HAS_MEDIA) {
        crossing.near = medium_of(media);
        crossing.far = crossing.near;
    }
    if (is_solid(s)) {
        if (s.back_face) {
            crossing.media = left(media, s.material);
            // Whoever meets a back face has been inside.
            crossing.near = medium_of(entered(crossing.media, s.material));
        } else {
            crossing.media = entered(media, s.material);
        }
        crossing.far = medium_of(crossing.media);
        crossing.eta = medium_ior(crossing.far, wavelength) / medium_ior(crossing.near, wavelength);
    } else {
        crossing.eta = material_ior(s.material);
        if (HAS_MEDIA) {
            crossing.eta /= medium_ior(crossing.near, wavelength);
        }
    }
    return crossing;
}

// Whether a surface changes nothing, being inside of a medium that wins over its own.
fn is_invisible(s: Surface, crossing: Crossing) -> bool {
    return is_solid(s) && crossing.near == crossing.far;
}

// The share of light that passes a distance in metres through a medium (Beer and Lambert).
fn medium_transmittance(medium: u32, distance: f32) -> vec3f {
    if (!HAS_ABSORPTION || medium == NONE) {
        return vec3f(1.0);
    }
    let absorption = material_absorption(medium);
    // 0 times an infinite distance is no number.
    return select(vec3f(1.0), exp(-absorption * distance), absorption > vec3f(0.0));
}

// Wavelengths: SPECTRUM_BINS bins of equal probability behind the albedo tables, each with its lower end in
// micrometres and what it weighs in red, green and blue (src/render/spectrum.rs).
const SPECTRUM_BINS: u32 = 64u;

// Draws a wavelength; gives what light of it weighs, in the mean white.
fn sample_wavelength(u: f32, wavelength: ptr<function, f32>) -> vec3f {
    let x = u * f32(SPECTRUM_BINS);
    let bin = min(floor_to_u32(x), SPECTRUM_BINS - 1u);
    let first = SPECTRUM_TABLE + 4u * bin;
    *wavelength = mix(load_bsdf_number(first), load_bsdf_number(first + 4u), x - f32(bin));
    return vec3f(load_bsdf_number(first + 1u), load_bsdf_number(first + 2u), load_bsdf_number(first + 3u));
}

// Whether the index of the media at a surface depends on the wavelength.
fn is_dispersive(crossing: Crossing) -> bool {
    return medium_dispersion(crossing.near) > 0.0 || medium_dispersion(crossing.far) > 0.0;
}

fn medium_dispersion(medium: u32) -> f32 {
    if (medium == NONE) {
        return 0.0;
    }
    return material_dispersion(medium);
}
