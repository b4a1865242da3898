//! The panorama camera: the whole sphere in the axes of the world.

use std::f64::consts::PI;

use etendue::render::Settings;
use etendue::scene::{EnvironmentImage, Projection};
use glam::{DMat4, DVec3};

use crate::common::{SceneBuilder, assert_exact, lamp, render, square};

/// A panorama at `eye`, its camera turned somehow.
fn panorama(builder: &mut SceneBuilder, eye: DVec3) {
    builder.parallel(eye, eye + DVec3::new(1.0, -2.0, 0.3), 1.0);
    builder.scene.cameras[0].projection = Projection::Panorama;
}

fn settings(width: u32, height: u32, spp: u64) -> Settings {
    Settings {
        width,
        height,
        ..square(1, spp, 1)
    }
}

#[test]
fn a_constant_environment_is_a_constant_picture() {
    let mut builder = SceneBuilder::new();
    builder.sky(3.0);
    panorama(&mut builder, DVec3::new(5.0, 6.0, -7.0));
    assert_exact(
        "sky",
        &render(&builder.scene, &settings(16, 8, 16)),
        [3.0; 3],
    );
}

/// The picture of an environment is the environment's picture, turned as that is.
#[test]
fn an_environment_is_seen_as_it_is_stored() {
    let (width, height) = (32, 16);
    let texels = (0..width * height).map(|i| [(i % width) as f32, (i / width) as f32, 1.0]);
    let image = EnvironmentImage {
        width,
        height,
        texels: texels.collect(),
    };
    // A turn by a quarter moves the columns by a quarter: what was at u is at u − rotation/2π.
    for (rotation, shift) in [(0.0, 0), (0.5 * PI, 8)] {
        let mut builder = SceneBuilder::new();
        builder.sky_image(image.clone(), rotation);
        panorama(&mut builder, DVec3::ONE);
        let film = render(&builder.scene, &settings(32, 16, 4096));
        for y in 1..height - 1 {
            for x in 0..width {
                // Linear but for where the columns begin again.
                let column = (x + shift) % width;
                if column == 0 || column == width - 1 {
                    continue;
                }
                let mean = film.mean(y * width + x);
                // Positions in a pixel are even: 4.5 standard errors of a mean of 4096.
                let error = 4.5 * (1.0 / 12.0_f64).sqrt() / 64.0;
                let wrong = (mean[0] - column as f64)
                    .abs()
                    .max((mean[1] - y as f64).abs());
                assert!(wrong < error, "{x} {y} {rotation}: {mean:?}");
            }
        }
    }
}

/// +X is in the middle, +Z half way to the right edge, +Y at the top; a turned camera sees the same,
/// from where it is.
#[test]
fn lamps_are_where_their_directions_say() {
    let eye = DVec3::new(10.0, -3.0, 4.0);
    for (direction, [u, v]) in [
        (DVec3::X, [0.5, 0.5]),
        (DVec3::Z, [0.75, 0.5]),
        (DVec3::NEG_Z, [0.25, 0.5]),
        (DVec3::new(1.0, 1.0, 0.0), [0.5, 0.25]),
        (DVec3::new(0.0, -1.0, 1.0), [0.75, 0.75]),
        (
            DVec3::new(-1.0, 0.0, 0.35),
            [0.5 + 0.35_f64.atan2(-1.0) / (2.0 * PI), 0.5],
        ),
    ] {
        let mut builder = SceneBuilder::new();
        let z = direction.normalize();
        let x = DVec3::new(0.3, 1.0, 0.2).cross(z).normalize();
        // 0.02 across at distance 1: less than the half pixel that it is moved by.
        builder.quad(lamp(1.0), eye + z, x * -0.01, z.cross(x) * 0.01);
        panorama(&mut builder, eye);
        builder.scene.cameras[0].to_world *= DMat4::from_rotation_z(0.4);
        let (width, height) = (65, 33);
        let film = render(&builder.scene, &settings(width, height, 256));
        let at = |share: f64, count: u32| ((share * f64::from(count)) as u32).min(count - 1);
        let expected = at(v, height) * width + at(u, width);
        let brightest = (0..width * height)
            .max_by(|&a, &b| film.mean(a as usize)[0].total_cmp(&film.mean(b as usize)[0]));
        assert_eq!(brightest, Some(expected), "{direction}");
    }
}
