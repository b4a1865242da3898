//! Exchange of light's source and the eye.

use etendue::scene::Material;
use glam::Vec3;

use super::bench::Bench;
use super::case::{Case, diffuse, glass, layered, metal};
use crate::common::Setup;

/// BSDFs there and back, for directions that the BSDF draws: f(wo, wi) times eta² where wi is on the far side, and
/// f(wi, wo), that of the far side. Both are infinite at grazing angles, where f32 loses digits.
fn there_and_back(bench: &Bench, case: &Case, below: bool) -> Vec<[f64; 2]> {
    let drawn = bench.draw(case, 1 << 14, 1);
    let kept = |d: &[f32; 4]| d[2].abs() > 1e-3 && (d[2] < 0.0) == below;
    let directions: Vec<[f32; 4]> = drawn.iter().map(|[d, _]| *d).filter(kept).collect();
    if directions.is_empty() {
        return Vec::new();
    }
    let there = bench.evaluate(case, &directions, false);
    let from = case.inside(case.inside != below);
    let back = bench.evaluate(&from, &directions, true);
    let scale = if below {
        1.0 / case.radiance_scale()
    } else {
        1.0
    };
    let pair = |((d, t), b): ((&[f32; 4], &[f32; 4]), &[f32; 4])| {
        let there = f64::from(t[0]) / f64::from(d[2].abs()) * scale;
        [there, f64::from(b[0]) / case.wo().z]
    };
    directions.iter().zip(&there).zip(&back).map(pair).collect()
}

/// Largest and root mean square difference, relative to the mean of both.
fn difference(pairs: &[[f64; 2]]) -> [f64; 2] {
    let relative = |[a, b]: &[f64; 2]| 2.0 * (a - b).abs() / (a + b).max(f64::MIN_POSITIVE);
    let largest = pairs.iter().map(relative).fold(0.0, f64::max);
    let squares: f64 = pairs.iter().map(|p| relative(p).powi(2)).sum();
    [largest, (squares / pairs.len().max(1) as f64).sqrt()]
}

const COSINES: [f64; 3] = [0.9, 0.5, 0.1];

/// Single lobes, without what is put back for multiple scattering, which depends on wo alone. A tilted coat is none of
/// them: it counts the cosine about its own normal.
#[test]
fn single_lobes_are_reciprocal() {
    let bench = Bench::new(&Setup::new().overriding("MULTIPLE_SCATTERING", 0.0));
    let mut stretched = metal([0.9, 0.5, 0.2]);
    stretched.name = "stretched metal";
    stretched.material.anisotropy = 0.6;
    let mut sheen = layered("sheen", [0.0; 3]);
    sheen.material.specular = 0.0;
    sheen.material.sheen_color = Vec3::ONE;
    sheen.material.sheen_roughness = 0.4;
    let mut coat = layered("coat", [0.0; 3]);
    coat.material.specular = 0.0;
    coat.material.clearcoat = 1.0;
    coat.material.clearcoat_roughness = 0.4;
    let mut film = metal([0.9, 0.5, 0.2]);
    film.name = "film";
    film.material.iridescence = 1.0;
    let glasses = [
        glass(1.5, true),
        glass(1.5, true).inside(true),
        glass(1.5, false),
    ];
    let lobes = [
        diffuse(),
        metal([0.9, 0.5, 0.2]),
        stretched,
        sheen,
        coat,
        film,
    ];
    for case in lobes.into_iter().chain(glasses) {
        for roughness in [0.2, 0.8] {
            for cos_o in COSINES {
                for below in [false, true] {
                    let case = case.roughness(roughness).at(cos_o);
                    let pairs = there_and_back(&bench, &case, below);
                    let [largest, rms] = difference(&pairs);
                    let n = pairs.len();
                    println!(
                        "{}, below {below}: {largest:.1e}, {rms:.1e}, {n}",
                        case.label()
                    );
                }
            }
        }
    }
}

/// Layers leave to those below what they do not reflect to wo (Turquin 2019): that is not reciprocal. The root mean
/// square of the relative difference, over directions that the BSDF draws, from cosines 0.9, 0.5 and 0.1:
///
/// | roughness 0.5 | 0.9 | 0.5 | 0.1 |
/// |---|---|---|---|
/// | dielectric over white | 0.04 | 0.03 | 0.11 |
/// | metal | 0.03 | 0.04 | 0.04 |
/// | coat and sheen over white | 0.20 | 0.17 | 0.43 |
/// | glass | 0.02 | 0.03 | 0.05 |
#[test]
fn layers_are_not_reciprocal() {
    let bench = Bench::new(&Setup::new());
    let mut coated = layered("coat and sheen over white", [1.0; 3]);
    coated.material = Material {
        clearcoat: 1.0,
        clearcoat_roughness: 0.3,
        sheen_color: Vec3::splat(0.3),
        sheen_roughness: 0.5,
        ..coated.material
    };
    for case in [
        layered("dielectric over white", [1.0; 3]),
        metal([1.0; 3]),
        coated,
        glass(1.5, true),
    ] {
        for cos_o in COSINES {
            let case = case.roughness(0.5).at(cos_o);
            let [largest, rms] = difference(&there_and_back(&bench, &case, false));
            println!("{}: {largest:.4}, {rms:.4}", case.label());
            assert!((0.01..0.45).contains(&rms), "{}: {rms}", case.label());
        }
    }
}
