//! Negative controls: each mistake, of the kind that is easily made, must be rejected.

use super::bench::{Bench, histogram};
use super::case::{Case, diffuse, glass, layered, metal};
use crate::common::SAMPLES;
use crate::common::Setup;
use crate::common::statistics::assert_rejected;

fn rejected(name: &str, setup: &Setup, lobes: &[&'static str], case: &Case) {
    let (bench, grid) = (Bench::with(setup, lobes), case.grid());
    let expected = bench.integrate(case, &grid).pdf;
    let (counts, lost) = histogram(&grid, &bench.draw(case, SAMPLES, 400));
    assert_rejected(name, &counts, &expected, lost);
}

#[test]
fn wrong_densities_and_samples_are_rejected() {
    let ggx = "bsdf/ggx.wgsl";
    let reflection = ["HAS_SPECULAR"];
    rejected(
        "a pdf without masking",
        &Setup::new().patched(
            ggx,
            "let g1 = 2.0 / (1.0 + ggx_lambda_term(alpha, wo));",
            "let g1 = 1.0;",
        ),
        &reflection,
        &metal([1.0; 3]).roughness(0.5).at(0.5),
    );
    rejected(
        "a sample with the roughness 3% off",
        &Setup::new().patched(
            ggx,
            "vec3f(h.xy * alpha, h.z)",
            "vec3f(h.xy * alpha * 1.03, h.z)",
        ),
        &reflection,
        &metal([1.0; 3]).roughness(0.3).at(0.7),
    );
    rejected(
        "a lobe chosen 1% too often",
        &Setup::new().patched(
            "bsdf.wgsl",
            "let in_specular = u_lobe < below;",
            "let in_specular = u_lobe < below + 0.01;",
        ),
        &reflection,
        &layered("layered", [0.5; 3]).roughness(0.4).at(0.5),
    );
    rejected(
        "a uniform base",
        &Setup::new().patched(
            "bsdf/diffuse.wgsl",
            "sample_cosine_hemisphere(u)",
            "sample_uniform_hemisphere(u)",
        ),
        &reflection,
        &diffuse().at(0.5),
    );
}

#[test]
fn wrong_refraction_is_rejected() {
    let transmission = "bsdf/transmission.wgsl";
    let lobes = ["HAS_SPECULAR", "HAS_TRANSMISSION"];
    rejected(
        "a Jacobian without the index",
        &Setup::new().patched(
            transmission,
            "square(eta / (cos_o + eta * cos_i))",
            "square(1.0 / (cos_o + eta * cos_i))",
        ),
        &lobes,
        &glass(1.5, true).roughness(0.4).at(0.7),
    );
    rejected(
        "an index 1% off",
        &Setup::new().patched(
            transmission,
            "ggx_sample_normal(alpha, wo, u), eta)",
            "ggx_sample_normal(alpha, wo, u), 1.01 * eta)",
        ),
        &lobes,
        &glass(1.5, true).inside(true).roughness(0.3).at(0.9),
    );
    rejected(
        "a thin wall that does not mirror to the far side",
        &Setup::new().patched(
            transmission,
            "let wi = ggx_sample(alpha, wo, u);",
            "let wi = -ggx_sample(alpha, wo, u);",
        ),
        &lobes,
        &glass(1.5, false).roughness(0.3).at(0.6),
    );
}
