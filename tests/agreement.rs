//! Estimators that share little agree on every scene of `scenes/`: light sampling alone, BSDF
//! sampling alone, both with multiple importance sampling, and the naive one; the Sobol' sampler
//! and the independent one; roulette from the first edge and none.
//!
//! Every comparison is of two renders with samples of their own: Welch's t of the mean of each tile
//! and channel, false alarms at most [`ALPHA`] a comparison (Šidák), and the mean of the whole
//! picture, |z| < 4.5. With 36 comparisons a right program fails on a new device with a chance of
//! 0.4 %; on one device nothing varies. `--nocapture` prints each verdict and the smallest
//! relative bias that it would have seen; `ETENDUE_LONG=1` draws 16 times the samples.

mod scene_common;

use etendue::image::statistics::Verdict;
use etendue::render::{Film, Settings};
use etendue::scene::Scene;

use scene_common::statistics::{MAX_Z, compare_films};
use scene_common::{effort, load, render, square, with_integrator, without_roulette};

/// False alarms of a comparison's tiles together.
const ALPHA: f64 = 1e-4;
/// Side of a picture and of its tiles, pixels.
const SIZE: u32 = 24;
const TILE: usize = 12;
/// Edges of the longest path.
const DEPTH: u32 = 4;

/// Samples a pixel of each kind of render.
struct Effort {
    path: u64,
    lights: u64,
    bsdf: u64,
    naive: u64,
}

const USUAL: Effort = Effort {
    path: 128,
    lights: 128,
    bsdf: 256,
    naive: 256,
};

fn settings(spp: u64, seed: u32) -> Settings {
    Settings {
        seed,
        ..square(SIZE, spp * effort(), DEPTH)
    }
}

/// Prints the verdict on b against a, and fails where it is bad.
fn assert_agree(scene: &str, what: &str, a: &Film, b: &Film) {
    let verdict = compare_films(b, a, TILE, ALPHA);
    let z = verdict.relative_bias / verdict.relative_bias_error;
    let (z, seen) = (if z.is_nan() { 0.0 } else { z }, smallest(&verdict));
    println!(
        "{scene}, {what}: z = {z:+.2}, seen from {:.3} %; {verdict}",
        100.0 * seen
    );
    assert!(verdict.pass, "{scene}, {what}: {verdict}");
    assert!(z.abs() < MAX_Z, "{scene}, {what}: z = {z:.2}; {verdict}");
}

/// Relative bias of the whole picture that its mean shows with a probability of 90 %.
fn smallest(verdict: &Verdict) -> f64 {
    (MAX_Z + 1.28) * verdict.relative_bias_error
}

fn compare_integrators(name: &str, scene: &Scene, effort: &Effort) {
    let reference = render(scene, &settings(effort.path, 1));
    for (integrator, spp, seed) in [
        ("path_lights", effort.lights, 2),
        ("path_bsdf", effort.bsdf, 3),
        ("naive", effort.naive, 4),
    ] {
        let film = render(scene, &with_integrator(&settings(spp, seed), integrator));
        assert_agree(name, integrator, &reference, &film);
    }
    compare_samplers_and_roulette(name, scene, effort, &reference);
}

fn compare_samplers_and_roulette(name: &str, scene: &Scene, effort: &Effort, reference: &Film) {
    let sobol = Settings {
        sampler: "sobol".into(),
        ..settings(effort.path, 5)
    };
    // Its samples depend on each other, so that its film's variance is too large: never too strict.
    assert_agree(name, "sobol", reference, &render(scene, &sobol));
    // The longest path is shorter than roulette's usual first edge: here it starts at once.
    let early = Settings {
        overrides: vec![("ROULETTE_DEPTH".into(), 1.0)],
        ..settings(effort.path, 6)
    };
    let early = render(scene, &early);
    assert_agree(name, "roulette", reference, &early);
    let none = render(scene, &without_roulette(&settings(effort.path, 7)));
    assert_agree(name, "none against roulette", &early, &none);
}

#[test]
fn cornell_box() {
    compare_integrators("cornell_box", &load("cornell_box"), &USUAL);
}

#[test]
fn furnace() {
    compare_integrators("furnace", &load("furnace"), &USUAL);
}

#[test]
fn foliage() {
    compare_integrators("foliage", &load("foliage"), &USUAL);
}

#[test]
fn many_lights() {
    compare_integrators("many_lights", &load("many_lights"), &USUAL);
}

#[test]
fn sphere_grid() {
    compare_integrators("sphere_grid", &load("sphere_grid"), &USUAL);
}

#[test]
fn veach_mis() {
    compare_integrators("veach_mis", &load("veach_mis"), &USUAL);
}
