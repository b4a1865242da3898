//! A scene made larger, smaller or moved gives the same picture.

use etendue::render::{Film, Settings};
use etendue::scene::{Material, Projection, Scene};
use glam::{DMat4, DVec3};

use crate::common::statistics::compare_films;
use crate::common::{SceneBuilder, black, glossy, lambert, lamp, metal, render, square};

/// A room with a lamp, a point light, a mirror, a veil, a glossy plate near the floor and a ball, all
/// surfaces turned by `turn` radians out of the axes.
fn room(turn: f64) -> Scene {
    let mut b = SceneBuilder::new();
    b.room(lambert(0.6), DVec3::ZERO, DVec3::new(1.0, 0.8, 1.2));
    b.quad(lamp(6.0), DVec3::Y * 0.79, DVec3::X * 0.3, DVec3::Z * 0.3);
    b.point(DVec3::new(-0.625, 0.125, 0.5), 0.3);
    let (x, y) = (DVec3::X * 0.3, DVec3::Y * 0.3);
    b.quad(metal(0.9, 0.0), DVec3::new(0.3, -0.4, -0.9), x, y);
    let veil = Material {
        alpha_mode: etendue::scene::AlphaMode::Blend,
        base_color: glam::Vec4::new(0.2, 0.5, 0.3, 0.5),
        double_sided: true,
        ..black()
    };
    b.quad(veil, DVec3::new(-0.3, 0.1, -0.5), x, y);
    let (x, z) = (DVec3::X * 0.4, DVec3::Z * 0.4);
    b.quad(glossy(1.5, 0.5), DVec3::new(0.1, -0.79, 0.2), z, x);
    let ball = crate::common::builder::Icosphere::new(DVec3::new(-0.4, -0.5, -0.2), 0.3, 2);
    b.sphere(lambert(0.8), &ball, false);
    b.pinhole(
        DVec3::new(0.25, 0.125, 1.125),
        DVec3::new(0.0, -0.2, 0.0),
        1.4,
    );
    let turn = DMat4::from_axis_angle(DVec3::new(0.48, 0.6, 0.64), turn);
    for instance in &mut b.scene.instances {
        instance.to_world = turn;
    }
    b.scene
}

/// The scene scaled about the origin, then moved. Intensities grow with the square of lengths, so
/// that radiance stays.
fn placed(scene: &Scene, scale: f64, offset: DVec3) -> Scene {
    let mut scene = scene.clone();
    let place = DMat4::from_translation(offset) * DMat4::from_scale(DVec3::splat(scale));
    for instance in &mut scene.instances {
        instance.to_world = place * instance.to_world;
    }
    for light in &mut scene.lights {
        light.position = place.transform_point3(light.position);
        light.intensity *= (scale * scale) as f32;
    }
    for camera in &mut scene.cameras {
        let eye = camera.to_world.w_axis.truncate();
        camera.to_world.w_axis = place.transform_point3(eye).extend(1.0);
        if let Projection::Orthographic { xmag, ymag } = &mut camera.projection {
            *xmag *= scale;
            *ymag *= scale;
        }
    }
    scene
}

fn settings() -> Settings {
    square(16, 128, 5)
}

fn assert_same_bits(name: &str, a: &Film, b: &Film) {
    let differ = a
        .pixels
        .iter()
        .zip(&b.pixels)
        .filter(|(a, b)| a.sum != b.sum);
    assert_eq!(differ.count(), 0, "{name}: pixels differ");
}

/// Where roundings differ the same random numbers still lead along nearly the same paths: nearly
/// all pixels agree to rounding, the rest as two renders do.
fn assert_same_picture(name: &str, a: &Film, b: &Film) {
    let close = (0..a.pixels.len()).filter(|&i| {
        let (x, y) = (a.mean(i), b.mean(i));
        (0..3).all(|c| (x[c] - y[c]).abs() <= 1e-4 * x[c].abs())
    });
    let share = close.count() as f64 / a.pixels.len() as f64;
    let verdict = compare_films(a, b, 4, 1e-4);
    println!("{name}: {share} of the pixels equal; {verdict}");
    assert!(verdict.pass, "{name}: {verdict}");
    assert!(share > 0.98, "{name}: only {share} of the pixels are equal");
    assert!(verdict.relative_bias.abs() < 1e-4, "{name}: {verdict}");
}

/// Coordinates of the room's camera and point light are multiples of 1/8, so that moves by powers of
/// two round nothing either.
#[test]
fn powers_of_two_change_no_bit() {
    let room = room(0.0);
    let film = render(&room, &settings());
    for exponent in [-20, 20, 30] {
        let scaled = placed(&room, 2.0_f64.powi(exponent), DVec3::ZERO);
        let name = format!("2^{exponent}");
        assert_same_bits(&name, &film, &render(&scaled, &settings()));
    }
    let far = placed(&room, 1.0, DVec3::new(1.0, -1.0, 0.5) * 2.0_f64.powi(20));
    assert_same_bits("moved", &film, &render(&far, &settings()));
}

#[test]
fn a_millionth_and_a_million_give_the_same_picture() {
    // Along the axes splits of the hierarchy tie and rounding decides: another order of the triangles
    // is another use of the random numbers.
    let room = room(0.1);
    let film = render(&room, &settings());
    for scale in [1e-6, 1e6] {
        let scaled = placed(&room, scale, DVec3::ZERO);
        assert_same_picture(&format!("× {scale}"), &film, &render(&scaled, &settings()));
    }
    let far = placed(&room, 1.0, DVec3::new(1e6, -7e5, 1e6));
    assert_same_picture("moved", &film, &render(&far, &settings()));
}
