// Lambertian reflection.

#include "math/sampling.wgsl"

// The BRDF.
fn diffuse_eval(reflectance: vec3f) -> vec3f {
    return reflectance * INV_PI;
}

// Density over solid angle.
fn diffuse_pdf(wi: vec3f) -> f32 {
    return pdf_cosine_hemisphere(wi.z);
}

fn diffuse_sample(u: vec2f) -> vec3f {
    return sample_cosine_hemisphere(u);
}
