// Reflectance of a base under a thin film, by interference of the waves that go through it up to three
// times, integrated over the eye's response in closed form (Belcour and Barla 2017, A Practical Extension
// to Microfacet Theory for the Modeling of Varying Iridescence, section 4).

#include "bsdf/fresnel.wgsl"
#include "math/trigonometry.wgsl"

struct Film {
    // Coverage; 0 where there is none.
    strength: f32,
    ior: f32,
    // Metres.
    thickness: f32,
}

// Phases of light in the film: sensitivity of X, Y, Z to a path difference, after a fit of Gaussians to
// the colour-matching functions in the space of frequencies (their supplemental material), in linear
// Rec. 709. `path` in metres, `shift` in radians.
fn film_sensitivity(path: f32, shift: vec3f) -> vec3f {
    let phase = 2.0 * PI * path;
    let value = vec3f(5.4856e-13, 4.4201e-13, 5.2481e-13);
    let position = vec3f(1.6810e6, 1.7953e6, 2.2084e6);
    let variance = vec3f(4.3278e9, 9.3046e9, 6.6121e9);
    let p2 = phase * phase;
    var xyz = value * sqrt(2.0 * PI * variance) * film_cos(position * phase + shift) * exp(-p2 * variance);
    xyz.x += 9.7470e-14 * sqrt(2.0 * PI * 4.5282e9) * film_cos(vec3f(2.2399e6 * phase + shift.x)).x
        * exp(-4.5282e9 * p2);
    xyz /= 1.0685e-7;
    return vec3f(
        dot(vec3f(3.2404542, -1.5371385, -0.4985314), xyz),
        dot(vec3f(-0.9692660, 1.8760108, 0.0415560), xyz),
        dot(vec3f(0.0556434, -0.2040259, 1.0572252), xyz),
    );
}

fn film_cos(angle: vec3f) -> vec3f {
    let turns = angle * INV_2PI;
    return vec3f(cos_sin_2pi(turns.x).x, cos_sin_2pi(turns.y).x, cos_sin_2pi(turns.z).x);
}

// The index of a base from its reflectance at normal incidence.
fn ior_of_reflectance(f0: vec3f) -> vec3f {
    let root = sqrt(clamp(f0, vec3f(0.0), vec3f(0.9999)));
    return (1.0 + root) / (1.0 - root);
}

// Reflectance towards a cosine, in air; f0 is that of the base without the film at normal incidence.
fn film_fresnel(film: Film, f0: vec3f, cos_theta: f32) -> vec3f {
    // A film of no thickness is none: its index fades out below 30 nm.
    let ior = mix(1.0, film.ior, smoothstep(0.0, 3.0e-8, film.thickness));
    let cos2_film = 1.0 - (1.0 - cos_theta * cos_theta) / (ior * ior);
    if (cos2_film < 0.0) {
        return vec3f(1.0);
    }
    let cos_film = sqrt(cos2_film);
    // The upper interface; from inside it reflects with half a turn of phase, as the film is the denser.
    let r12 = fresnel_dielectric(cos_theta, ior);
    let t121 = 1.0 - r12;
    // The lower one.
    let base_ior = ior_of_reflectance(f0);
    let r23_normal = (base_ior - ior) / (base_ior + ior);
    let r23_f0 = r23_normal * r23_normal;
    let r23 = r23_f0 + (1.0 - r23_f0) * schlick_weight(cos_film);
    let phase23 = select(vec3f(0.0), vec3f(PI), base_ior < vec3f(ior));
    let path = 2.0 * ior * film.thickness * cos_film;
    let phase = vec3f(PI) + phase23;
    // Airy's sum: its constant term and the first two harmonics.
    let r123 = clamp(r12 * r23, vec3f(1.0e-5), vec3f(0.9999));
    let root = sqrt(r123);
    let rs = t121 * t121 * r23 / (1.0 - r123);
    let first = (rs - t121) * root;
    let second = first * root;
    let result = r12 + rs
        + 2.0 * first * film_sensitivity(path, phase)
        + 2.0 * second * film_sensitivity(2.0 * path, 2.0 * phase);
    return clamp(result, vec3f(0.0), vec3f(1.0));
}
