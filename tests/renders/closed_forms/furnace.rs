//! Closed surfaces of equal emission and reflectance.

use std::f64::consts::PI;

use etendue::render::Settings;
use etendue::scene::{Material, Scene};
use glam::DVec3;

use crate::common::builder::Icosphere;
use crate::common::statistics::assert_between;
use crate::common::{SceneBuilder, assert_radiance, lambert, load, render, square};
use crate::common::{render_with_roulette, with_integrator, without_roulette};

/// A closed box that emits 1 and reflects ρ, by Lambert's law, seen from inside.
fn furnace(rho: f32) -> Scene {
    let mut builder = SceneBuilder::new();
    let wall = Material {
        emissive: glam::Vec3::ONE,
        ..lambert(rho)
    };
    builder.room(wall, DVec3::ZERO, DVec3::new(1.0, 0.8, 1.2));
    builder.pinhole(DVec3::new(0.3, 0.2, -0.4), DVec3::new(-1.0, -0.5, 1.0), 1.3);
    builder.scene
}

/// Paths of at most `depth` edges in a furnace: (1 − ρ^depth) / (1 − ρ).
fn answer(rho: f64, depth: u32) -> f64 {
    (1.0 - rho.powi(depth as i32)) / (1.0 - rho)
}

#[test]
fn a_furnace_is_uniform_at_every_albedo_and_depth() {
    for rho in [0.0_f32, 0.2, 0.5, 0.8, 0.95] {
        let scene = furnace(rho);
        for (depth, spp) in [(1, 4), (2, 32), (3, 32), (8, 64), (400, 128)] {
            let film = render(&scene, &square(16, spp, depth));
            let expected = answer(f64::from(rho), depth);
            let precision = if depth > 8 { 0.006 } else { 0.003 };
            assert_radiance(
                &format!("ρ = {rho}, depth {depth}"),
                &film,
                expected,
                precision,
            );
        }
    }
}

#[test]
fn every_integrator_meets_the_furnace() {
    let scene = furnace(0.8);
    for settings in super::integrators(&square(16, 128, 5)) {
        let film = render(&scene, &settings);
        // Light samples alone meet the 1 / d² of the nearest corner.
        let alone = settings.integrator == "path_lights";
        let precision = if alone { 0.02 } else { 0.005 };
        assert_radiance(&settings.integrator, &film, answer(0.8, 5), precision);
    }
}

#[test]
fn roulette_changes_no_mean() {
    let scene = furnace(0.8);
    let settings = square(16, 64, 40);
    let early = Settings {
        overrides: vec![("ROULETTE_DEPTH".into(), 1.0)],
        ..settings.clone()
    };
    for (name, settings) in [
        ("from depth 1", early),
        ("none", without_roulette(&settings)),
    ] {
        let film = render(&scene, &settings);
        assert_radiance(name, &film, answer(0.8, 40), 0.008);
    }
}

/// In a furnace of reflectance ½ a path carries 2^-k after k edges, so with a threshold t it has a next one with the
/// chance min(1, 2^-k / t).
#[test]
fn a_threshold_shortens_paths_as_far_as_it_says() {
    let scene = furnace(0.5);
    let depth = 12;
    let settings = Settings {
        stats: true,
        overrides: vec![("ROULETTE_MAX_SURVIVAL".into(), 1.0)],
        ..square(16, 256, depth)
    };
    for threshold in [1e-30, 0.01, 0.5, 2.0] {
        let film = render_with_roulette(&scene, &settings, threshold);
        let what = format!("threshold {threshold}");
        assert_radiance(&what, &film, answer(0.5, depth), 0.005);
        let paths = film.samples() as f64;
        let rays: u64 = film.pixels.iter().map(|p| u64::from(p.closest_rays)).sum();
        let goes_on = |k: u32| (0.5_f64.powi(k as i32) / f64::from(threshold)).min(1.0);
        let expected = 1.0 + (1..depth).map(goes_on).sum::<f64>();
        // Lengths differ by less than 2 edges.
        let error = (rays as f64 / paths - expected).abs();
        assert!(error <= 5.0 * 2.0 / paths.sqrt(), "{what}: {error}");
    }
    // Hardly any path goes on, but none of them weighs more than 10,000.
    let film = render_with_roulette(&scene, &settings, 1e30);
    assert!((0..film.pixels.len()).all(|i| film.mean(i)[0] < answer(0.5, depth) * 1e4));
}

#[test]
fn the_furnace_file_gives_what_its_extras_derive() {
    let scene = load("furnace");
    for (depth, spp) in [(1, 4), (2, 32), (3, 32), (60, 64)] {
        let film = render(&scene, &square(16, spp, depth));
        let expected = 2.0 - 2.0_f64.powi(1 - depth as i32);
        assert_radiance(&format!("depth {depth}"), &film, expected, 0.003);
    }
}

/// In a unit sphere of reflectance ½ a point light of intensity π at the centre gives direct light
/// ρI/π = ½ everywhere, and L = ½ + ½ L = 1. In an inscribed polyhedron whose planes are at least
/// h from the centre, direct light ρI cosθ/(π r²) = ½ h'/r³ with h ≤ h' ≤ r ≤ 1 lies between ½ h
/// and ½ / h², and reflection averages, so the radiance lies between h and 1 / h².
#[test]
fn a_lamp_in_a_sphere_gives_radiance_one() {
    let sphere = Icosphere::new(DVec3::ZERO, 1.0, 4);
    let h = sphere.inradius(DVec3::ZERO);
    assert!(h > 0.998, "the polyhedron is too coarse: {h}");
    let mut builder = SceneBuilder::new();
    builder.sphere(lambert(0.5), &sphere, true);
    builder.point(DVec3::ZERO, PI as f32);
    builder.pinhole(DVec3::new(0.2, -0.3, 0.1), DVec3::new(-1.0, 0.4, -0.7), 1.0);
    for (integrator, spp, precision) in [("path", 48, 0.003), ("naive", 64, 0.004)] {
        let settings = with_integrator(&square(16, spp, 30), integrator);
        let film = render(&builder.scene, &settings);
        assert_between(integrator, &film, h, 1.0 / (h * h), precision);
    }
}
