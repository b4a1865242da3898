//! Light from infinitely far away.

use std::f64::consts::PI;

use etendue::scene::{EnvironmentImage, Scene};
use glam::{DMat4, DVec3};

use super::{RHO, integrators, receiver};
use crate::common::radiometry::{sky_irradiance, sky_radiance};
use crate::common::statistics::assert_estimate;
use crate::common::{assert_radiance, estimate, render, square, with_integrator};

fn image(
    width: usize,
    height: usize,
    texel: impl Fn(usize, usize) -> [f32; 3],
) -> EnvironmentImage {
    let texels = (0..width * height).map(|i| texel(i % width, i / width));
    EnvironmentImage {
        width,
        height,
        texels: texels.collect(),
    }
}

/// The receiver and its camera turned about the origin, so that it faces `turn` · Y.
fn tilted(mut scene: Scene, turn: DMat4) -> Scene {
    for instance in &mut scene.instances {
        instance.to_world = turn * instance.to_world;
    }
    for camera in &mut scene.cameras {
        camera.to_world = turn * camera.to_world;
    }
    scene
}

#[test]
fn a_uniform_sky_gives_rho_l() {
    let scene = receiver(|b| b.sky(3.0));
    for settings in integrators(&square(16, 64, 2)) {
        let film = render(&scene, &settings);
        assert_radiance(&settings.integrator, &film, RHO * 3.0, 0.005);
    }
}

#[test]
fn a_uniform_picture_of_the_sky_gives_rho_l() {
    for (width, height) in [(1, 1), (5, 3), (64, 32)] {
        let scene = receiver(|b| b.sky_image(image(width, height, |_, _| [3.0; 3]), 0.4));
        let film = render(&scene, &square(16, 128, 2));
        assert_radiance(&format!("{width}×{height}"), &film, RHO * 3.0, 0.005);
    }
    let scene = receiver(|b| b.sky_image(image(16, 8, |_, _| [3.0; 3]), 0.4));
    for settings in integrators(&square(16, 256, 2)) {
        let film = render(&scene, &settings);
        assert_radiance(&settings.integrator, &film, RHO * 3.0, 0.008);
    }
}

/// A dim coloured pattern with a sun of one texel 500 times as bright, a tilted receiver and a
/// turned sky: E by quadrature of the bilinear picture.
#[test]
fn a_picture_with_a_sun_gives_its_integral() {
    let sun = (21, 3);
    let pattern = |x: usize, y: usize| {
        let k = (x * 7 + y * 13) % 11;
        let base = 0.1 + 0.05 * k as f32;
        let dim = [base, 0.8 - base, 0.2 + 0.02 * y as f32];
        if (x, y) == sun {
            dim.map(|c| 500.0 * c)
        } else {
            dim
        }
    };
    let picture = image(32, 16, pattern);
    let (rotation, turn) = (
        1.1,
        DMat4::from_axis_angle(DVec3::new(0.3, 0.1, 1.0).normalize(), -0.5),
    );
    let scene = tilted(receiver(|b| b.sky_image(picture.clone(), rotation)), turn);
    // Counter-clockwise about +Y by `rotation`: what is at direction d came from Ry(−rotation) d.
    let back = DMat4::from_rotation_y(-rotation);
    let normal = turn.transform_vector3(DVec3::Y);
    let expected = [0, 1, 2].map(|c| {
        let radiance = |d| sky_radiance(&picture, back.transform_vector3(d), c);
        RHO / PI * sky_irradiance(radiance, normal)
    });
    for (integrator, spp, precision) in [
        ("path", 512, 0.006),
        ("path_lights", 512, 0.006),
        ("path_bsdf", 2048, 0.02),
        ("naive", 2048, 0.02),
    ] {
        let film = render(&scene, &with_integrator(&square(16, spp, 2), integrator));
        assert_estimate(integrator, &estimate(&film), expected, precision);
    }
}

/// The top row is +Y, and u = ½ is +X: four views of a picture of four quarters.
#[test]
fn the_picture_hangs_the_right_way_round() {
    let picture = image(8, 4, |x, y| [x as f32, y as f32, 1.0]);
    for (direction, expected) in [
        (DVec3::X, [3.5, 1.5]),
        (DVec3::Z, [5.5, 1.5]),
        (DVec3::NEG_Z, [1.5, 1.5]),
        (DVec3::new(1.0, 1.0, 0.0), [3.5, 0.5]),
        (DVec3::new(1.0, -1.0, 0.0), [3.5, 2.5]),
    ] {
        let mut scene = receiver(|b| b.sky_image(picture.clone(), 0.0));
        scene.instances.clear();
        scene.cameras.clear();
        let mut builder = super::SceneBuilder { scene };
        builder.parallel(DVec3::ZERO, direction, 1.0);
        let film = render(&builder.scene, &square(1, 2, 1));
        let mean = film.mean(0);
        for c in 0..2 {
            assert!(
                (mean[c] - expected[c]).abs() < 1e-4,
                "{direction}: {mean:?}"
            );
        }
    }
}
