//! Samples against their densities, lobe by lobe and all together.

use etendue::scene::Material;
use glam::Vec3;

use super::bench::{Bench, LOBES};
use super::case::{Case, diffuse, glass, layered, metal, tilted};
use crate::common::{SAMPLES, Setup};

/// Samples of a case of a sweep.
const SWEEP: u32 = 1 << 18;
/// From straight above to grazing.
const COSINES: [f64; 4] = [1.0, 0.7, 0.1, 0.02];
const GOLD: [f32; 3] = [1.0, 0.78, 0.34];

/// The case at each cosine with each roughness, from each side where light passes.
fn sweep(bench: &Bench, case: &Case, roughnesses: &[f32], cosines: &[f64], seed: u32) {
    let sides: &[bool] = if case.is_solid() {
        &[false, true]
    } else {
        &[false]
    };
    let mut seed = seed;
    for &roughness in roughnesses {
        for &cos_o in cosines {
            for &inside in sides {
                let case = case.roughness(roughness).at(cos_o).inside(inside);
                bench.check(&case, SWEEP, seed);
                seed += 1;
            }
        }
    }
}

#[test]
fn a_dielectric_over_a_base_follows_its_density() {
    // With nothing else compiled in.
    let bench = Bench::with(&Setup::new(), &LOBES[..1]);
    for (i, roughness) in [0.05, 0.3, 0.6, 1.0].into_iter().enumerate() {
        for (j, cos_o) in COSINES.into_iter().enumerate() {
            let case = layered("layered", [0.8, 0.5, 0.2])
                .roughness(roughness)
                .at(cos_o);
            bench.check(&case, SAMPLES, (4 * i + j) as u32);
        }
    }
    bench.check(&diffuse().at(0.4), SAMPLES, 99);
    let total: f64 = bench
        .integrate(&diffuse(), &diffuse().grid())
        .pdf
        .iter()
        .sum();
    assert!((total - 1.0).abs() < 1e-6, "{total}");
}

#[test]
fn metals_follow_their_density() {
    let bench = Bench::with(&Setup::new(), &LOBES[..1]);
    // Alpha is 1e-6, 9e-4 (single directions), 1.2e-3 and so on.
    let roughnesses = [0.001, 0.03, 0.035, 0.1, 0.5, 1.0];
    sweep(&bench, &metal(GOLD), &roughnesses, &COSINES, 100);
}

#[test]
fn glass_follows_its_density() {
    let bench = Bench::with(&Setup::new(), &LOBES[..2]);
    let roughnesses = [0.001, 0.04, 0.1, 0.4, 1.0];
    sweep(&bench, &glass(1.5, true), &roughnesses, &COSINES, 200);
    sweep(&bench, &glass(2.4, true), &[0.3], &COSINES, 300);
    sweep(&bench, &glass(1.5, false), &roughnesses, &COSINES, 400);
}

#[test]
fn stretched_lobes_follow_their_density() {
    let bench = Bench::with(&Setup::new(), &LOBES[..2]);
    let mut seed = 500;
    for anisotropy in [0.3, 1.0] {
        for mut case in [metal(GOLD), glass(1.5, true), glass(1.5, false)] {
            case.name = "stretched";
            case.material.anisotropy = anisotropy;
            sweep(&bench, &case, &[0.05, 0.3, 0.9], &[0.9, 0.1], seed);
            seed += 20;
        }
    }
}

/// A material of nothing but what `change` adds to black.
fn only(name: &'static str, change: impl FnOnce(&mut Material)) -> Case {
    let mut case = layered(name, [0.0; 3]);
    case.material.specular = 0.0;
    change(&mut case.material);
    case
}

#[test]
fn layers_and_films_follow_their_density() {
    let bench = Bench::new(&Setup::new());
    let sheen = |roughness| {
        only("sheen", |m| {
            m.sheen_color = Vec3::new(0.9, 0.5, 0.2);
            m.sheen_roughness = roughness;
        })
    };
    for (i, roughness) in [0.05, 0.3, 1.0].into_iter().enumerate() {
        sweep(
            &bench,
            &sheen(roughness),
            &[0.5],
            &COSINES,
            600 + 10 * i as u32,
        );
    }
    for (i, roughness) in [0.02, 0.1, 0.5, 1.0].into_iter().enumerate() {
        let mut coat = only("tilted coat", |m| {
            m.clearcoat = 0.8;
            m.clearcoat_roughness = roughness;
        });
        coat.coat_normal = tilted(0.25);
        sweep(&bench, &coat, &[0.5], &[1.0, 0.7, 0.3], 640 + 10 * i as u32);
    }
    let leaf = only("leaf", |m| {
        m.base_color = Vec3::new(0.2, 0.6, 0.1).extend(1.0);
        m.diffuse_transmission = 0.4;
        m.diffuse_transmission_color = Vec3::new(0.5, 0.9, 0.2);
    });
    sweep(&bench, &leaf, &[0.5], &COSINES, 700);
    for (i, mut film) in [metal(GOLD), layered("film", [0.5; 3])]
        .into_iter()
        .enumerate()
    {
        film.material.iridescence = 0.7;
        film.material.iridescence_thickness = [0.0, 420.0];
        sweep(
            &bench,
            &film,
            &[0.02, 0.4],
            &[0.9, 0.2],
            720 + 10 * i as u32,
        );
    }
}

/// Each layer of the model at once.
fn everything(solid: bool) -> Case {
    let name = if solid {
        "everything"
    } else {
        "everything, thin"
    };
    let mut case = layered(name, [0.8, 0.5, 0.3]);
    case.coat_normal = tilted(0.2);
    case.material = Material {
        metallic: 0.2,
        transmission: 0.4,
        solid,
        diffuse_transmission: 0.3,
        diffuse_transmission_color: Vec3::new(0.9, 0.6, 0.3),
        clearcoat: 0.5,
        clearcoat_roughness: 0.4,
        sheen_color: Vec3::new(0.3, 0.2, 0.5),
        sheen_roughness: 0.6,
        iridescence: 0.5,
        iridescence_thickness: [0.0, 350.0],
        ..case.material
    };
    case
}

#[test]
fn everything_at_once_follows_its_density() {
    let bench = Bench::new(&Setup::new());
    let roughnesses = [0.001, 0.1, 0.4, 1.0];
    let cosines = [1.0, 0.7, 0.3];
    sweep(&bench, &everything(true), &roughnesses, &cosines, 800);
    sweep(&bench, &everything(false), &roughnesses, &cosines, 850);
}
