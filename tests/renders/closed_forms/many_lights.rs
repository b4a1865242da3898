//! Many lamps: together they give what one large one gives, however a light is chosen.

use etendue::accel::BuildOptions;
use etendue::render::LightSelection;
use etendue::scene::{LightKind, Scene};
use glam::DVec3;

use super::{integrators, receive, receiver, reflected};
use crate::common::radiometry::polygon_irradiance;
use crate::common::statistics::{MAX_Z, compare_films};
use crate::common::{
    SceneBuilder, assert_radiance, effort, glossy, lambert, lamp, render, render_with, square,
};

const RADIANCE: f64 = 5.0;
/// Lamps along a side.
const SIDE: usize = 24;

/// A parallelogram of SIDE × SIDE lamps, and its corners.
fn tiled(center: DVec3, u: DVec3, v: DVec3) -> (Scene, [DVec3; 4]) {
    // Corners are shared: what is rounded leaves no gap.
    let corner = |i: usize, j: usize| {
        let at = |k: usize| 2.0 * k as f64 / SIDE as f64 - 1.0;
        (center + at(i) * u + at(j) * v).as_vec3().as_dvec3()
    };
    let scene = receiver(|b| {
        for i in 0..SIDE {
            for j in 0..SIDE {
                let (a, c) = (corner(i, j), corner(i + 1, j + 1));
                let corners = [a, corner(i + 1, j), c, corner(i, j + 1)];
                b.polygon(lamp(RADIANCE as f32), &corners);
            }
        }
    });
    let outline = [(0, 0), (SIDE, 0), (SIDE, SIDE), (0, SIDE)].map(|(i, j)| corner(i, j));
    (scene, outline)
}

/// Near and far, tilted, partly below the horizon, beside the receiver.
fn cases() -> Vec<(DVec3, DVec3, DVec3)> {
    vec![
        (DVec3::Y, DVec3::X, DVec3::Z),
        (DVec3::new(1.0, 0.1, 0.5), DVec3::X * 3.0, DVec3::Z * 2.0),
        (DVec3::new(30.0, 20.0, 5.0), DVec3::Y, DVec3::Z),
        (DVec3::new(2.0, 0.2, 0.0), DVec3::Y, DVec3::Z * 1.5),
        (
            DVec3::new(-1.0, 0.5, 1.0),
            DVec3::new(1.0, 0.4, 0.0),
            DVec3::new(0.0, 0.3, 1.0),
        ),
    ]
}

#[test]
fn many_lamps_give_what_one_gives() {
    for (center, u, v) in cases() {
        // Turned so that they face the receiver.
        let (u, v) = match u.cross(v).dot(center) < 0.0 {
            true => (u, v),
            false => (v, u),
        };
        let (scene, outline) = tiled(center, u, v);
        let e = RADIANCE * polygon_irradiance(&outline, DVec3::ZERO, DVec3::Y);
        assert!(e > 0.0);
        assert_radiance(
            &format!("{center}"),
            &receive(&scene, 1024),
            reflected(e),
            0.01,
        );
    }
}

#[test]
fn every_integrator_meets_many_lamps() {
    let (scene, outline) = tiled(DVec3::new(0.3, 0.7, 0.0), DVec3::X, DVec3::Z);
    let e = RADIANCE * polygon_irradiance(&outline, DVec3::ZERO, DVec3::Y);
    assert!(e > 0.0);
    for settings in integrators(&square(16, 1024, 2)) {
        let film = render(&scene, &settings);
        assert_radiance(&settings.integrator, &film, reflected(e), 0.01);
    }
}

/// Lamps that face all ways over a glossy floor, points, a spot, a sun and a sky.
fn mixture() -> Scene {
    let mut b = SceneBuilder::new();
    b.ground(lambert(0.6), 2.0);
    let wall = DVec3::new(0.0, 0.0, -1.5);
    b.quad(glossy(1.5, 0.4), wall, DVec3::X * 2.0, DVec3::Y);
    for i in 0..200_i32 {
        let turn = f64::from(i);
        let at = |k: f64| (k * turn).sin();
        let center = DVec3::new(1.8 * at(1.7), 0.7 + 0.5 * at(2.3), at(0.9));
        let u = 0.05 * DVec3::new(at(3.1), at(4.7), at(5.3));
        let v = 0.05 * DVec3::new(at(6.1), at(7.3), at(8.9));
        let strength = 10f32.powf(at(11.0) as f32);
        b.quad(lamp(20.0 * strength), center, u, v);
    }
    for i in 0..5 {
        let position = DVec3::new(0.7 * f64::from(i) - 1.4, 0.3, 0.4);
        b.point(position, 0.05);
    }
    let (inner, outer) = (0.1, 0.5);
    let kind = LightKind::Spot { inner, outer };
    b.light(DVec3::Y * 1.5, DVec3::new(0.3, -1.0, 0.2), 2.0, kind);
    let down = DVec3::new(0.2, -1.0, -0.3);
    b.light(DVec3::ZERO, down, 0.5, LightKind::Directional);
    b.sky(0.3);
    // It sees what is below all of the lamps, whose own noise would hide what differs.
    b.parallel(DVec3::Y * 0.15, DVec3::ZERO, 1.2);
    b.scene
}

/// False alarms of each comparison's tiles at most 1e-4, of its mean 6.8e-6.
#[test]
fn the_way_of_choosing_changes_no_expectation() {
    let scene = mixture();
    let draw = |selection, seed| {
        let mut settings = square(24, 4096 * effort(), 3);
        settings.seed = seed;
        render_with(&scene, &settings, &BuildOptions::default(), Some(selection))
    };
    let tree = draw(LightSelection::Tree, 1);
    let others = [(LightSelection::Power, 2), (LightSelection::Uniform, 3)];
    for (selection, seed) in others {
        let verdict = compare_films(&draw(selection, seed), &tree, 8, 1e-4);
        let z = verdict.relative_bias / verdict.relative_bias_error;
        let seen = (MAX_Z + 1.28) * verdict.relative_bias_error;
        let line = format!("{selection}: z = {z:+.2}, would have seen {seen:.4}; {verdict}");
        println!("{line}");
        assert!(verdict.pass && z.abs() < MAX_Z, "{line}");
        assert!(seen < 0.02, "too noisy to tell: {line}");
    }
}
