//! Area lights over a Lambertian receiver: Lambert's formula for polygons, discs, spheres.

use std::f64::consts::PI;

use etendue::scene::Scene;
use glam::{DMat4, DQuat, DVec3};

use super::{RHO, integrators, receive, receiver, reflected};
use crate::common::builder::{Disc, Icosphere};
use crate::common::radiometry::polygon_irradiance;
use crate::common::{SceneBuilder, assert_exact, assert_radiance, lambert, lamp, render, square};

const RADIANCE: f64 = 5.0;

fn under_polygon(corners: &[DVec3]) -> (Scene, f64) {
    let corners: Vec<DVec3> = corners.iter().map(|c| c.as_vec3().as_dvec3()).collect();
    let scene = receiver(|b| b.polygon(lamp(RADIANCE as f32), &corners));
    let e = RADIANCE * polygon_irradiance(&corners, DVec3::ZERO, DVec3::Y);
    (scene, e)
}

/// A regular polygon of a radius of 1 about `center`, facing the origin but for a tilt.
fn regular(sides: usize, center: DVec3, tilt: f64) -> Vec<DVec3> {
    let facing = DQuat::from_rotation_arc(DVec3::Z, -center.normalize());
    let turn = DQuat::from_axis_angle(DVec3::new(0.6, 0.0, 0.8), tilt) * facing;
    let corner = |i: usize| {
        let (sin, cos) = (0.3 + 2.0 * PI * i as f64 / sides as f64).sin_cos();
        center + turn * DVec3::new(cos, sin, 0.0)
    };
    (0..sides).map(corner).collect()
}

#[test]
fn polygons_above_the_horizon_follow_lambert() {
    for (sides, center, tilt) in [
        (3, DVec3::new(0.0, 1.5, 0.0), 0.0),
        (4, DVec3::new(1.0, 2.0, -0.5), 0.6),
        (5, DVec3::new(-2.0, 1.3, 1.0), -0.3),
        (7, DVec3::new(4.0, 1.2, 3.0), 0.4),
    ] {
        let (scene, e) = under_polygon(&regular(sides, center, tilt));
        let name = format!("{sides} sides at {center}");
        assert_radiance(&name, &receive(&scene, 512), reflected(e), 0.005);
    }
}

#[test]
fn the_part_below_the_horizon_gives_nothing() {
    for (sides, center) in [
        (3, DVec3::new(2.0, 0.2, 0.0)),
        (4, DVec3::new(-1.5, -0.3, 0.8)),
        (6, DVec3::new(0.5, 0.0, -2.0)),
    ] {
        let (scene, e) = under_polygon(&regular(sides, center, 0.2));
        let name = format!("{sides} sides at {center}");
        assert_radiance(&name, &receive(&scene, 1024), reflected(e), 0.006);
    }
    let (scene, e) = under_polygon(&regular(5, DVec3::new(0.2, -1.5, 0.0), 0.0));
    assert_eq!(e, 0.0);
    assert_exact("below", &receive(&scene, 16), [0.0; 3]);
}

#[test]
fn every_integrator_meets_lamberts_formula() {
    let (scene, e) = under_polygon(&regular(5, DVec3::new(0.4, 1.0, 0.2), 0.3));
    for settings in integrators(&square(16, 512, 2)) {
        let film = render(&scene, &settings);
        assert_radiance(&settings.integrator, &film, reflected(e), 0.006);
    }
}

/// A square of side 2 at height 1, on its axis: E = πL · 0.554126.
#[test]
fn a_square_on_the_axis() {
    let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
    let (scene, e) = under_polygon(&corners.map(|(x, z)| DVec3::new(x, 1.0, z)));
    let table = PI * RADIANCE * 0.554126;
    assert!((e - table).abs() < 1e-5 * e, "{e} {table}");
    assert_radiance("square", &receive(&scene, 512), reflected(e), 0.005);
}

/// E = πL r² / (r² + h²) of a disc; its polygon of 96 sides has 1 − 7e-4 of its area.
#[test]
fn a_coaxial_disc() {
    for (radius, height) in [(1.0, 1.0), (0.3, 1.0), (4.0, 1.0)] {
        let disc = Disc {
            center: DVec3::Y * height,
            up: false,
            radius,
            segments: 96,
        };
        let (scene, e) = under_polygon(&disc.corners());
        let round = PI * RADIANCE * radius * radius / (radius * radius + height * height);
        assert!((e / round - 1.0).abs() < 8e-4, "{e} {round}");
        let name = format!("radius {radius}");
        assert_radiance(&name, &receive(&scene, 512), reflected(e), 0.005);
    }
}

/// E = πL (r/d)² cosθ of a sphere above the horizon. The polyhedron that stands for it sends the
/// sum over its faces that see the receiver, which is within 0.6 % of that.
#[test]
fn a_sphere_above_the_horizon() {
    for (radius, d, theta) in [(0.5_f64, 1.5_f64, 0.0_f64), (0.4, 2.0, 0.9)] {
        let center = d * DVec3::new(theta.sin(), theta.cos(), 0.0);
        let sphere = Icosphere::new(center, radius, 3);
        let seen = |corners: [DVec3; 3]| polygon_irradiance(&corners, DVec3::ZERO, DVec3::Y);
        let e: f64 = RADIANCE * sphere.triangles().map(seen).sum::<f64>();
        let round = PI * RADIANCE * (radius / d).powi(2) * theta.cos();
        assert!((e / round - 1.0).abs() < 6e-3, "{e} {round}");
        let scene = receiver(|b| b.sphere(lamp(RADIANCE as f32), &sphere, false));
        let name = format!("radius {radius}, {theta} rad");
        assert_radiance(&name, &receive(&scene, 1024), reflected(e), 0.006);
    }
}

/// Between equal coaxial discs, r = h, the form factor is 0.381966: the light that the lower
/// disc reflects, averaged over it, is ρ L times that. Both are polygons of 256 sides, whose area
/// is 1 − 1.0e-4 of the disc's; the form factor falls by no more than 3e-4.
#[test]
fn the_form_factor_of_coaxial_discs() {
    let disc = |height, up| Disc {
        center: DVec3::Y * height,
        up,
        radius: 1.0,
        segments: 256,
    };
    let (lower, upper) = (disc(0.0, true), disc(1.0, false));
    let mut builder = SceneBuilder::new();
    builder.disc(lambert(RHO as f32), &lower);
    builder.disc(lamp(RADIANCE as f32), &upper);
    builder.parallel(DVec3::Y * 0.5, DVec3::ZERO, 1.0);
    let film = render(&builder.scene, &square(16, 512, 2));
    // The view is the square around the disc.
    let share = lower.area_ratio() * PI / 4.0;
    let expected = RHO * RADIANCE * 0.381966 * share;
    let e = crate::common::estimate(&film);
    println!("{e:?}, expected {expected}");
    assert!(e.error[0] < 0.003 * expected);
    assert!((e.mean[0] - expected).abs() < 4.5 * e.error[0] + 3e-4 * expected);
}

/// A receiver turned in any way, its lamp with it: nothing prefers an axis.
#[test]
fn turning_everything_changes_nothing() {
    let (scene, e) = under_polygon(&regular(4, DVec3::new(1.0, 2.0, -0.5), 0.6));
    for (axis, angle) in [
        (DVec3::X, 1.0),
        (DVec3::new(0.6, 0.0, 0.8), 2.5),
        (DVec3::Z, PI),
    ] {
        let turn = DMat4::from_axis_angle(axis, angle);
        let mut turned = scene.clone();
        for instance in &mut turned.instances {
            instance.to_world = turn;
        }
        turned.cameras[0].to_world = turn * turned.cameras[0].to_world;
        let film = receive(&turned, 512);
        assert_radiance(&format!("{axis} {angle}"), &film, reflected(e), 0.005);
    }
}
