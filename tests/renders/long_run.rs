//! Long runs do not drift. Some drivers leave every loop after 65,535 iterations a dispatch,
//! silently: a renderer that trusts them loses samples, or the ends of long paths, and darkens.
//! Here thousands of samples a pixel and paths of thousands of edges meet the furnace's closed form.

use std::ops::ControlFlow;

use etendue::accel::BuildOptions;
use etendue::render::{Film, GpuScene, Prepared, RenderError, Renderer, Settings};
use etendue::scene::{Material, Scene};
use etendue::shader::ShaderLibrary;
use glam::{DVec3, Vec3};

use crate::common::statistics::MAX_Z;
use crate::common::{
    SceneBuilder, assert_radiance, device, effort, estimate, lambert, render, square,
    without_roulette,
};

/// A closed box that emits 1 and reflects ρ.
fn furnace(rho: f32) -> Scene {
    let mut builder = SceneBuilder::new();
    let wall = Material {
        emissive: Vec3::ONE,
        ..lambert(rho)
    };
    builder.room(wall, DVec3::ZERO, DVec3::new(1.0, 0.8, 1.2));
    builder.pinhole(DVec3::new(0.3, 0.2, -0.4), DVec3::NEG_X, 1.3);
    builder.scene
}

fn answer(rho: f64, depth: u32) -> f64 {
    (1.0 - rho.powi(depth as i32)) / (1.0 - rho)
}

/// Renders samples `first` to `first + spp`.
fn part(scene: &Scene, settings: &Settings, first: u64, spp: u64) -> Film {
    let settings = Settings {
        first_sample: first,
        spp,
        ..settings.clone()
    };
    render(scene, &settings)
}

#[test]
fn thousands_of_samples_do_not_drift() {
    let (scene, spp) = (furnace(0.5), 8192 * effort());
    let settings = square(8, spp, 8);
    let whole = render(&scene, &settings);
    let expected = answer(0.5, 8);
    assert_radiance("whole", &whole, expected, 5e-4);
    let halves = [0, spp / 2].map(|first| part(&scene, &settings, first, spp / 2));
    let [a, b] = halves.each_ref().map(estimate);
    for (name, half) in ["first half", "second half"].iter().zip(&halves) {
        assert_radiance(name, half, expected, 7e-4);
    }
    let z = (a.mean[0] - b.mean[0]) / a.error[0].hypot(b.error[0]);
    println!("first half against second: z = {z:.2}");
    assert!(z.abs() < MAX_Z, "the halves differ: z = {z}");
    // They are the same samples: all that may differ is the rounding of the sums.
    for i in 0..whole.pixels.len() {
        let mean = 0.5 * (halves[0].mean(i)[0] + halves[1].mean(i)[0]);
        assert!((whole.mean(i)[0] - mean).abs() < 1e-9, "pixel {i}");
    }
}

#[test]
fn many_short_runs_are_one_long_run() {
    let (scene, runs, spp) = (furnace(0.8), 16, 64);
    let settings = square(8, runs * spp, 6);
    let whole = render(&scene, &settings);
    assert_radiance("whole", &whole, answer(0.8, 6), 0.004);
    let parts: Vec<Film> = (0..runs)
        .map(|i| part(&scene, &settings, i * spp, spp))
        .collect();
    for i in 0..whole.pixels.len() {
        let mean = parts.iter().map(|f| f.mean(i)[0]).sum::<f64>() / runs as f64;
        assert!((whole.mean(i)[0] - mean).abs() < 1e-9, "pixel {i}");
    }
}

/// Passes of 8,192 samples a pixel: each lane gets thousands of samples
/// and far more than 65,535 iterations before its pixel is done.
#[test]
fn a_pass_of_thousands_of_samples_is_complete() {
    let scene = furnace(0.5);
    let settings = Settings {
        pass_samples: Some(8192),
        ..square(4, 16_384 * effort(), 8)
    };
    let (film, largest) = render_with_largest_pass(&scene, &settings);
    // An edge takes at least one iteration of the path loop and two of the traversals.
    let iterations = largest / 16.0 * 8.0 * 3.0;
    println!("largest pass: {largest} samples, at least {iterations} iterations a lane");
    assert!(
        iterations > 4.0 * 65_535.0 / 8.0,
        "passes too small to show anything"
    );
    assert_radiance("big passes", &film, answer(0.5, 8), 8e-4);
}

fn render_with_largest_pass(scene: &Scene, settings: &Settings) -> (Film, f64) {
    let prepared = Prepared::new(scene, 0, &BuildOptions::default()).expect("a prepared scene");
    let gpu_scene = GpuScene::upload(device(), &prepared).expect("room on the device");
    let library = ShaderLibrary::embedded();
    let mut renderer = Renderer::new(device(), &library, scene, &prepared, &gpu_scene, settings)
        .expect("a compiled shader");
    let (mut before, mut largest) = (0, 0);
    let flow = renderer.render(&mut |_, progress| {
        largest = largest.max(progress.samples_done - before);
        before = progress.samples_done;
        ControlFlow::Continue(())
    });
    assert!(flow.expect("a render that ends").is_continue());
    let film = renderer.film().expect("a film");
    let spp = settings.spp as u32;
    assert_eq!(film.spp_range(), (spp, spp), "samples are missing");
    (film, largest as f64)
}

#[test]
fn paths_of_256_edges_end_where_they_should() {
    let (scene, expected) = (furnace(0.95), answer(0.95, 256));
    let settings = square(8, 1024 * effort(), 256);
    assert_radiance("roulette", &render(&scene, &settings), expected, 0.008);
    let settings = without_roulette(&square(8, 64 * effort(), 256));
    assert_radiance("no roulette", &render(&scene, &settings), expected, 0.008);
}

/// A single path takes more iterations than the lanes of a SIMD group may share.
#[test]
fn paths_of_1500_edges_end_where_they_should() {
    let settings = without_roulette(&square(4, 16 * effort(), 1500));
    let film = render(&furnace(0.95), &settings);
    assert_radiance("1500 edges", &film, answer(0.95, 1500), 0.05);
}

/// A path of 10,000 edges takes more iterations than an old driver lets a SIMD group run: it is
/// rendered whole or refused, never cut.
#[test]
fn overlong_paths_are_whole_or_refused() {
    let scene = furnace(1.0);
    let settings = Settings {
        integrator: "path_bsdf".into(),
        ..without_roulette(&square(8, 1, 10_000))
    };
    let prepared = Prepared::new(&scene, 0, &BuildOptions::default()).expect("a prepared scene");
    let gpu_scene = GpuScene::upload(device(), &prepared).expect("room on the device");
    let library = ShaderLibrary::embedded();
    let mut renderer = Renderer::new(device(), &library, &scene, &prepared, &gpu_scene, &settings)
        .expect("a compiled shader");
    match renderer.render(&mut |_, _| ControlFlow::Continue(())) {
        Ok(_) => {
            let mean = renderer.film().expect("a film").mean_radiance()[0];
            assert!((mean - 10_000.0).abs() < 100.0, "paths were cut: {mean}");
        }
        Err(RenderError::LoopLimit { .. }) => {}
        Err(other) => panic!("{other}"),
    }
}
