//! Estimators that share little agree on every scene of `scenes/`: light sampling alone, BSDF
//! sampling alone, both with multiple importance sampling, and the naive one; the Sobol' sampler
//! and the independent one; roulette from the first edge and none.
//!
//! Every comparison is of two renders with samples of their own: Welch's t of the mean of each tile
//! and channel, false alarms at most [`ALPHA`] a comparison (Šidák), and the mean of the whole
//! picture, |z| < 4.5. With 58 comparisons a right program fails on a new device with a chance of
//! 0.6 %; on one device nothing varies. `--nocapture` prints each verdict and the smallest
//! relative bias that it would have seen; `ETENDUE_LONG=1` draws 16 times the samples.

use crate::common::builder::Icosphere;
use crate::common::statistics::{MAX_Z, compare_films};
use crate::common::{
    SceneBuilder, effort, lamp, load, render, render_guided, render_with_roulette, square,
    with_integrator, without_roulette,
};
use etendue::image::statistics::Verdict;
use etendue::render::{Film, Settings};
use etendue::scene::{Environment, EnvironmentImage, Material, Scene};
use glam::{DVec3, Vec3, Vec4};

/// False alarms of a comparison's tiles together.
const ALPHA: f64 = 1e-4;
/// Side of a picture and of its tiles, pixels.
const SIZE: u32 = 24;
const TILE: usize = 8;
/// Edges of the longest path.
const DEPTH: u32 = 4;

/// Smallest perceptual roughness that estimators without BSDF sampling are asked to meet: where
/// lobes are sharper their samples are so rarely large that neither the mean nor its error can be
/// told from an affordable number.
const ROUGH: f32 = 0.3;
/// Largest radiance of a lamp that the naive estimator is asked to find: brighter ones are so small
/// that a uniform direction meets them less than once in ten thousand.
const BRIGHT: f32 = 100.0;

/// Renders of a scene, all alike but for what is compared. Pixels that see a lamp are left out: what
/// is seen directly is the same for all, and its noise would hide what differs.
struct Bench<'a> {
    scene: &'a Scene,
    name: String,
    lamps: Vec<bool>,
}

impl<'a> Bench<'a> {
    fn new(name: &str, scene: &'a Scene) -> Self {
        let seen = Settings {
            sampler: "sobol".into(),
            ..square(SIZE, 4096, 1)
        };
        let seen = render(scene, &seen);
        let lit = |i| seen.mean(i) != [0.0; 3];
        let mut lamps: Vec<bool> = (0..seen.pixels.len()).map(lit).collect();
        // In a furnace there is nothing else.
        if lamps.iter().all(|lamp| *lamp) {
            lamps.fill(false);
        }
        Self {
            scene,
            name: name.into(),
            lamps,
        }
    }

    fn render(&self, settings: &Settings) -> Film {
        self.without_lamps(render(self.scene, settings))
    }

    fn render_guided(&self, settings: &Settings) -> Film {
        self.without_lamps(render_guided(self.scene, settings))
    }

    fn without_lamps(&self, mut film: Film) -> Film {
        for (pixel, lamp) in film.pixels.iter_mut().zip(&self.lamps) {
            if *lamp {
                (pixel.sum, pixel.sum_low) = Default::default();
                (pixel.square, pixel.square_low) = Default::default();
            }
        }
        film
    }

    /// Prints the verdict on b against a, and fails where it is bad.
    fn assert_agree(&self, what: &str, a: &Film, b: &Film) {
        let verdict = compare_films(b, a, TILE, ALPHA);
        let z = verdict.relative_bias / verdict.relative_bias_error;
        let z = if z.is_nan() { 0.0 } else { z };
        let seen = 100.0 * smallest(&verdict);
        let line = format!(
            "{}, {what}: z = {z:+.2}, a bias of {seen:.3} % of the whole would have been seen; {verdict}",
            self.name
        );
        println!("{line}");
        assert!(verdict.pass && z.abs() < MAX_Z, "{line}");
    }
}

/// Relative bias of the whole picture that its mean shows with a probability of 90 %.
fn smallest(verdict: &Verdict) -> f64 {
    (MAX_Z + 1.28) * verdict.relative_bias_error
}

fn settings(spp: u64, seed: u32) -> Settings {
    Settings {
        seed,
        ..square(SIZE, spp * effort(), DEPTH)
    }
}

fn check(name: &str) {
    let scene = load(name);
    let bench = Bench::new(name, &scene);
    let reference = bench.render(&settings(256, 1));
    let bsdf = with_integrator(&settings(512, 3), "path_bsdf");
    bench.assert_agree("path_bsdf", &reference, &bench.render(&bsdf));
    check_samplers_and_roulette(&bench, &reference);
    let rough = roughened(&scene);
    let lights = with_integrator(&settings(256, 2), "path_lights");
    check_variant(&bench, &reference, &rough, &lights);
    let naive = with_integrator(&settings(512, 4), "naive");
    check_variant(&bench, &reference, &dimmed(&rough), &naive);
}

/// Compares an integrator with `path` on a variant of the scene; `reference` is of the scene itself.
fn check_variant(bench: &Bench, reference: &Film, variant: &Scene, settings_of: &Settings) {
    let what = &settings_of.integrator;
    if variant.materials == bench.scene.materials {
        return bench.assert_agree(what, reference, &bench.render(settings_of));
    }
    let bench = Bench::new(&format!("{}, a variant", bench.name), variant);
    let reference = bench.render(&settings(256, 8));
    bench.assert_agree(what, &reference, &bench.render(settings_of));
}

fn check_samplers_and_roulette(bench: &Bench, reference: &Film) {
    let sobol = Settings {
        sampler: "sobol".into(),
        ..settings(256, 5)
    };
    // Its samples depend on each other, so that its film's variance is too large: never too strict.
    bench.assert_agree("sobol", reference, &bench.render(&sobol));
    // The longest path is shorter than roulette's usual first edge: here it starts at once.
    let early = Settings {
        overrides: vec![("ROULETTE_DEPTH".into(), 1.0)],
        ..settings(256, 6)
    };
    let early = bench.render(&early);
    bench.assert_agree("roulette", reference, &early);
    let none = bench.render(&without_roulette(&settings(256, 7)));
    bench.assert_agree("none against roulette", &early, &none);
    let lights = Settings {
        overrides: vec![("FIRST_LIGHT_SAMPLES".into(), 5.0)],
        ..settings(256, 9)
    };
    bench.assert_agree("five light samples", reference, &bench.render(&lights));
}

/// The scene with no material smoother than [`ROUGH`].
fn roughened(scene: &Scene) -> Scene {
    let mut scene = scene.clone();
    for material in &mut scene.materials {
        material.roughness = material.roughness.max(ROUGH);
    }
    scene
}

/// The scene with lamps brighter than [`BRIGHT`] put out.
fn dimmed(scene: &Scene) -> Scene {
    let mut scene = scene.clone();
    for material in &mut scene.materials {
        if material.emissive.max_element() > BRIGHT {
            material.emissive = glam::Vec3::ZERO;
        }
    }
    scene
}

#[test]
fn cornell_box() {
    check("cornell_box");
}

#[test]
fn furnace() {
    check("furnace");
}

#[test]
fn foliage() {
    check("foliage");
}

#[test]
fn many_lights() {
    check("many_lights");
}

#[test]
fn sphere_grid() {
    check("sphere_grid");
}

#[test]
fn veach_mis() {
    check("veach_mis");
}

/// A floor and a wall of every layer, with a thin leaf and a block of rough glass that absorbs, under a lamp and a
/// dim sky.
fn all_lobes() -> Scene {
    let mut builder = SceneBuilder::new();
    let layered = Material {
        base_color: Vec4::new(0.8, 0.5, 0.3, 1.0),
        metallic: 0.2,
        roughness: 0.4,
        clearcoat: 0.5,
        clearcoat_roughness: 0.3,
        sheen_color: Vec3::new(0.2, 0.3, 0.5),
        sheen_roughness: 0.5,
        iridescence: 0.6,
        iridescence_thickness: [0.0, 350.0],
        ..Material::default()
    };
    let leaf = Material {
        base_color: Vec4::new(0.3, 0.7, 0.2, 1.0),
        metallic: 0.0,
        roughness: 0.8,
        transmission: 0.3,
        diffuse_transmission: 0.5,
        diffuse_transmission_color: Vec3::new(0.6, 0.9, 0.3),
        ..Material::default()
    };
    let glass = Material {
        base_color: Vec4::ONE,
        metallic: 0.0,
        roughness: 0.9,
        transmission: 1.0,
        solid: true,
        absorption: Vec3::new(0.2, 1.0, 2.0),
        dispersion: 0.5,
        ..Material::default()
    };
    builder.ground(layered.clone(), 2.0);
    builder.quad(
        layered,
        DVec3::new(0.0, 1.0, -1.5),
        DVec3::X * 2.0,
        DVec3::Y,
    );
    builder.quad(
        leaf,
        DVec3::new(-0.7, 0.6, 0.2),
        DVec3::new(0.2, 0.0, 0.4),
        DVec3::Y * 0.5,
    );
    let sphere = Icosphere::new(DVec3::new(0.5, 0.6, 0.0), 0.5, 1);
    builder.sphere(glass, &sphere, false);
    let above = DVec3::new(0.0, 2.5, 0.3);
    builder.quad(lamp(6.0), above, DVec3::X * 0.7, DVec3::Z * 0.7);
    builder.sky(0.3);
    builder.pinhole(DVec3::new(0.2, 1.1, 3.0), DVec3::new(0.0, 0.6, 0.0), 0.7);
    builder.scene
}

/// Light samples alone are left out: below a surface that light passes they do not find the sky.
#[test]
fn every_lobe() {
    let scene = all_lobes();
    let bench = Bench::new("every lobe", &scene);
    let reference = bench.render(&settings(256, 1));
    let naive = with_integrator(&settings(4096, 4), "naive");
    check_variant(&bench, &reference, &roughened(&scene), &naive);
    let bsdf = with_integrator(&settings(512, 3), "path_bsdf");
    bench.assert_agree("path_bsdf", &reference, &bench.render(&bsdf));
    check_samplers_and_roulette(&bench, &reference);
}

/// A striped sky, dark in one quarter, with a sun of two texels.
fn panorama() -> EnvironmentImage {
    let (width, height) = (50, 20);
    let texel = |i: usize| match (i % width, i / width) {
        (30..32, 5) => [60.0, 50.0, 40.0],
        (0..12, _) => [0.0; 3],
        (x, y) => [0.2, 0.1 + 0.02 * (x % 5) as f32, 0.02 * y as f32],
    };
    EnvironmentImage {
        width,
        height,
        texels: (0..width * height).map(texel).collect(),
    }
}

fn lobes_under_a_panorama() -> Scene {
    let mut scene = all_lobes();
    scene.environment = Some(Environment {
        radiance: [1.0; 3],
        rotation: 0.7,
        image: Some(panorama().into()),
    });
    scene
}

/// Whatever samples of the picture count for against those of the BSDF.
#[test]
fn under_a_panorama() {
    let scene = lobes_under_a_panorama();
    let bench = Bench::new("under a panorama", &scene);
    let reference = bench.render(&settings(256, 1));
    let lights = with_integrator(&settings(256, 2), "path_lights");
    check_variant(&bench, &reference, &roughened(&scene), &lights);
    let bsdf = with_integrator(&settings(1024, 3), "path_bsdf");
    bench.assert_agree("path_bsdf", &reference, &bench.render(&bsdf));
    for (count, seed) in [(0.25, 4), (1.0, 5), (8.0, 6)] {
        let other = Settings {
            overrides: vec![("ENVIRONMENT_SAMPLES".into(), count)],
            ..settings(256, seed)
        };
        let what = format!("samples that count for {count}");
        bench.assert_agree(&what, &reference, &bench.render(&other));
    }
    check_samplers_and_roulette(&bench, &reference);
}

/// Guided paths, and paths that end where they carry less than a threshold, find what others find, whatever has a
/// diffuse part; guided ones with every way to find lights.
#[test]
fn guided_paths() {
    let scenes = [
        ("cornell box", load("cornell_box")),
        ("every lobe", all_lobes()),
        ("under a panorama", lobes_under_a_panorama()),
    ];
    for (name, scene) in scenes {
        let bench = Bench::new(name, &scene);
        let reference = bench.render(&settings(512, 1));
        let guided = bench.render_guided(&settings(512, 2));
        bench.assert_agree("guided", &reference, &guided);
        let bsdf = with_integrator(&settings(1024, 3), "path_bsdf");
        bench.assert_agree("guided, path_bsdf", &reference, &bench.render_guided(&bsdf));
        let early = render_with_roulette(&scene, &settings(512, 4), 0.7);
        bench.assert_agree("threshold", &reference, &bench.without_lamps(early));
    }
}
