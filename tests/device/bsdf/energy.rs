//! How much of the light that arrives is sent on.

use super::bench::{Bench, LOBES, QUADRATURE_ERROR};
use super::case::{Case, diffuse, layered, metal};
use crate::common::Setup;

/// Albedo of the GGX lobe with a Fresnel term of 1: alpha, cosine, answer, tolerance. At alpha 1
/// and normal view it is 1 - ln 2; the others were integrated in f64 by a program of its own.
const GGX_ALBEDO: [(f64, f64, f64, f64); 8] = [
    (1.0, 1.0, 1.0 - std::f64::consts::LN_2, 2e-5),
    (0.1, 1.0, 0.988_304, 2e-5),
    (0.25, 1.0, 0.915_813, 2e-5),
    (0.5, 1.0, 0.687_848, 2e-5),
    (1.0, 0.1, 0.760_210, 2e-5),
    (0.1, 0.1, 0.883_455, 2e-5),
    (0.25, 0.1, 0.891_622, 2e-5),
    (0.5, 0.1, 0.860_105, 2e-5),
];

#[test]
fn ggx_albedo_has_its_closed_form() {
    let single = Setup::new().overriding("MULTIPLE_SCATTERING", 0.0);
    let bench = Bench::with(&single, &LOBES[..1]);
    for (alpha, cos_o, expected, tolerance) in GGX_ALBEDO {
        let case = metal([1.0; 3]).roughness(alpha.sqrt() as f32).at(cos_o);
        let [albedo, ..] = bench.albedo(&case);
        println!("alpha {alpha}, cos {cos_o}: {albedo:.6}");
        assert!(
            (albedo - expected).abs() < tolerance,
            "{alpha} {cos_o}: {albedo}"
        );
    }
}

#[test]
fn a_lambertian_base_reflects_its_color() {
    let bench = Bench::with(&Setup::new(), &LOBES[..1]);
    let case = diffuse().at(0.4);
    for (a, expected) in bench.albedo(&case).into_iter().zip([0.9, 0.5, 0.1]) {
        assert!((a - expected).abs() < 1e-6, "{a}");
    }
}

/// Cosines at which albedos are measured.
fn view_cosines() -> impl Iterator<Item = f64> {
    (0..12)
        .map(|i| 1.0 - f64::from(i) / 12.0)
        .chain([0.04, 0.02, 0.01])
}

/// Smallest and largest albedo over view.
fn albedo_range(bench: &Bench, case: &Case) -> [f64; 2] {
    let mut range = [f64::INFINITY, 0.0];
    for cos_o in view_cosines() {
        for a in bench.albedo(&case.at(cos_o)) {
            range = [range[0].min(a), range[1].max(a)];
        }
    }
    range
}

const ROUGHNESSES: [f32; 8] = [0.02, 0.05, 0.1, 0.2, 0.4, 0.6, 0.8, 1.0];

#[test]
fn single_lobes_reflect_no_more_than_arrives() {
    let single = Setup::new().overriding("MULTIPLE_SCATTERING", 0.0);
    let bench = Bench::with(&single, &LOBES[..1]);
    for roughness in ROUGHNESSES {
        for case in [metal([1.0; 3]), layered("glossy black", [0.0; 3])] {
            let case = case.roughness(roughness);
            let [low, high] = albedo_range(&bench, &case);
            println!("{} {roughness}: {low:.5} to {high:.5}", case.name);
            assert!(high < 1.0 + QUADRATURE_ERROR, "{}: {high}", case.name);
        }
    }
}
