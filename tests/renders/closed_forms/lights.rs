//! Punctual lights on a Lambertian receiver: ρ E / π, without noise.

use std::f64::consts::{FRAC_PI_2, PI};

use etendue::scene::LightKind;
use glam::DVec3;

use super::{receive, receiver, reflected};
use crate::common::{assert_exact, assert_radiance, black};

/// Places above the receiver, in polar form: distance, angle from the normal.
const PLACES: [(f64, f64); 7] = [
    (0.1, 0.0),
    (1.0, 0.0),
    (1.0, 0.5),
    (2.0, 1.0),
    (30.0, 1.3),
    (1000.0, 1.5),
    (1.0, 1.7),
];

fn place(distance: f64, angle: f64) -> DVec3 {
    distance * DVec3::new(0.6 * angle.sin(), angle.cos(), 0.8 * angle.sin())
}

#[test]
fn a_point_light_falls_with_the_square_of_distance_and_the_cosine() {
    for (d, theta) in PLACES {
        let scene = receiver(|b| b.point(place(d, theta), 4.0));
        let expected = reflected(4.0 * theta.cos().max(0.0) / (d * d));
        assert_exact(
            &format!("{d} m, {theta} rad"),
            &receive(&scene, 4),
            [expected; 3],
        );
    }
}

#[test]
fn a_directional_light_gives_its_irradiance_times_the_cosine() {
    for (_, theta) in PLACES {
        let kind = LightKind::Directional;
        let scene = receiver(|b| b.light(DVec3::ZERO, -place(1.0, theta), 4.0, kind));
        let expected = reflected(4.0 * theta.cos().max(0.0));
        assert_exact(&format!("{theta} rad"), &receive(&scene, 4), [expected; 3]);
    }
}

/// KHR_lights_punctual: intensity × clamp((cos − cos outer) / (cos inner − cos outer))².
#[test]
fn a_spot_light_fades_between_its_cones() {
    let (inner, outer) = (0.3_f64, 0.8_f64);
    for off_axis in [0.0, 0.25, 0.4, 0.6, 0.75, 0.85] {
        let (d, theta) = (2.0, 0.7);
        let position = place(d, theta);
        let to_receiver = -position.normalize();
        let side = to_receiver.cross(DVec3::Y).normalize();
        let axis = to_receiver * f64::cos(off_axis) + side * f64::sin(off_axis);
        let scene = receiver(|b| b.light(position, axis, 4.0, LightKind::Spot { inner, outer }));
        let ramp = (off_axis.cos() - outer.cos()) / (inner.cos() - outer.cos());
        let fade = ramp.clamp(0.0, 1.0).powi(2);
        let expected = reflected(4.0 * fade * theta.cos() / (d * d));
        assert_exact(
            &format!("{off_axis} rad off"),
            &receive(&scene, 4),
            [expected; 3],
        );
    }
    let (inner, outer) = (0.0, FRAC_PI_2);
    let kind = LightKind::Spot { inner, outer };
    let scene = receiver(|b| b.light(DVec3::Y, DVec3::new(0.6, -0.8, 0.0), 4.0, kind));
    assert_exact("widest", &receive(&scene, 4), [reflected(4.0 * 0.64); 3]);
}

/// KHR_lights_punctual: × clamp(1 − (d / range)⁴).
#[test]
fn a_range_fades_a_light_out() {
    for (range, factor) in [
        (2.0, 1.0 - 0.0625),
        (1.0, 0.0),
        (0.5, 0.0),
        (100.0, 1.0 - 1e-8),
    ] {
        let mut scene = receiver(|b| b.point(DVec3::Y, 4.0));
        scene.lights[0].range = range;
        let expected = reflected(4.0 * factor);
        assert_exact(
            &format!("range {range}"),
            &receive(&scene, 4),
            [expected; 3],
        );
    }
}

#[test]
fn what_is_in_the_way_casts_a_shadow() {
    let shaded = receiver(|b| {
        b.point(DVec3::Y, 4.0);
        b.quad(black(), DVec3::Y * 0.5, DVec3::X * 0.1, DVec3::Z * 0.1);
    });
    assert_exact("shade", &receive(&shaded, 4), [0.0; 3]);
    // Behind the light nothing is in the way, however near.
    let lit = receiver(|b| {
        b.point(DVec3::Y, 4.0);
        b.quad(black(), DVec3::Y * 1.000001, DVec3::X, DVec3::Z);
    });
    assert_exact("lit", &receive(&lit, 4), [reflected(4.0); 3]);
}

#[test]
fn lights_add_up() {
    let places = [(1.0, 0.2), (2.0, 0.9), (0.7, 1.2), (5.0, 0.0)];
    let scene = receiver(|b| {
        for (d, theta) in places {
            b.point(place(d, theta), 4.0);
        }
        b.light(
            DVec3::ZERO,
            DVec3::new(1.0, -1.0, 0.0),
            2.0,
            LightKind::Directional,
        );
    });
    let points: f64 = places.iter().map(|(d, t)| 4.0 * t.cos() / (d * d)).sum();
    let expected = reflected(points + 2.0 * (PI / 4.0).cos());
    assert_radiance("sum", &receive(&scene, 512), expected, 0.005);
}
