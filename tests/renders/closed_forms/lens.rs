//! Thin lenses: what is out of focus is blurred to a disc of known radius, evenly lit.
//!
//! A point at distance d along the axis, seen through the point q of a lens that is focused at s, is at
//! q (1/s − 1/d) from where a pinhole sees it, in units of the film at distance 1: the ray through the
//! film's point p goes from q along (p − q/s, −1), and meets distance d at q + d (p − q/s). So a lens of
//! radius R shows it as a disc of radius R |1/s − 1/d|. Parallel rays, each through a lens of its own,
//! give one of radius R |1 − d/s| metres.

use std::f64::consts::PI;

use etendue::accel::BuildOptions;
use etendue::render::{Film, Prepared, Settings, distance_at};
use etendue::scene::{Lens, Projection, Scene};
use glam::DVec3;

use crate::common::{SceneBuilder, lambert, lamp, render, render_prepared, square};

/// Half the height of the film at distance 1.
const HALF: f64 = 0.5;
const PIXELS: u32 = 64;
const PIXEL: f64 = 2.0 * HALF / PIXELS as f64;
/// Half the side of a lamp that stands for a point, on the film.
const LAMP: f64 = 0.02;

/// A square lamp at distance `d`, whose middle is seen `x` to the right of the film's middle.
fn point(d: f64, x: f64, lens: Lens) -> SceneBuilder {
    let mut builder = SceneBuilder::new();
    let side = LAMP * d;
    let center = DVec3::X * x * d;
    builder.quad(lamp(1.0), center, DVec3::X * side, DVec3::Y * side);
    builder.pinhole(DVec3::Z * d, DVec3::ZERO, 2.0 * HALF.atan());
    builder.scene.cameras[0].lens = Some(lens);
    builder
}

/// Light of a picture, by the distance from a point of the film.
struct Blur<'a> {
    film: &'a Film,
    x: f64,
}

impl Blur<'_> {
    /// Radiance, variance of its mean and distance of each pixel.
    fn pixels(&self) -> impl Iterator<Item = (f64, f64, f64)> {
        (0..PIXELS * PIXELS).map(|i| {
            let at = |i: u32| (f64::from(i) + 0.5) * PIXEL - HALF;
            let r = (at(i % PIXELS) - self.x).hypot(at(i / PIXELS));
            let pixel = i as usize;
            (
                self.film.mean(pixel)[0],
                self.film.variance_of_mean(pixel)[0],
                r,
            )
        })
    }

    /// Mean and standard error of the radiance at distances in a range.
    fn ring(&self, from: f64, to: f64) -> (f64, f64) {
        let inside: Vec<_> = self
            .pixels()
            .filter(|(.., r)| (from..to).contains(r))
            .collect();
        let count = inside.len() as f64;
        let mean = inside.iter().map(|(l, ..)| l).sum::<f64>() / count;
        let variance = inside.iter().map(|(_, v, _)| v).sum::<f64>() / (count * count);
        (mean, variance.sqrt())
    }

    /// Mean square of the distance, and its standard error.
    fn second_moment(&self) -> (f64, f64) {
        let total: f64 = self.pixels().map(|(l, ..)| l).sum();
        let moment = self.pixels().map(|(l, _, r)| l * r * r).sum::<f64>() / total;
        let variance = self.pixels().map(|(_, v, r)| v * (r * r - moment).powi(2));
        (moment, variance.sum::<f64>().sqrt() / total)
    }
}

fn assert_close(what: &str, (found, error): (f64, f64), expected: f64, precision: f64) {
    let line = format!("{what}: {found:.7} ± {error:.7}, expected {expected:.7}");
    println!("{line}");
    assert!(error < precision * expected, "too noisy to tell: {line}");
    assert!((found - expected).abs() < 4.5 * error, "{line}");
}

/// A disc of this radius around `x`, evenly lit, and nothing else.
fn assert_disc(what: &str, film: &Film, x: f64, radius: f64) {
    let blur = Blur { film, x };
    // The disc's own r²/2, the lamp's, and that of the squares of pixels in place of their middles.
    let moment = radius * radius / 2.0 + 2.0 * LAMP * LAMP / 3.0 + PIXEL * PIXEL / 6.0;
    assert_close(
        &format!("{what}, second moment"),
        blur.second_moment(),
        moment,
        0.01,
    );
    // Where all of the lamp is inside of the disc around a pixel.
    let edge = 2.0_f64.sqrt() * (LAMP + 0.5 * PIXEL);
    let even = (2.0 * LAMP).powi(2) / (PI * radius * radius);
    let inner = blur.ring(0.0, 0.5 * radius);
    let outer = blur.ring(0.5 * radius, radius - edge);
    assert_close(&format!("{what}, inner half"), inner, even, 0.02);
    assert_close(&format!("{what}, outer half"), outer, even, 0.02);
    assert_eq!(
        blur.ring(radius + edge, 9.0).0,
        0.0,
        "{what}: light beyond the disc"
    );
}

#[test]
fn a_point_out_of_focus_is_a_disc_of_the_thin_lens_equation() {
    for (what, d, s, x) in [
        ("behind", 4.0, 2.0, 0.0),
        ("before", 1.25, 2.0, 0.0),
        ("aside", 4.0, 2.0, 0.15),
        ("focused far away", 4.0, f64::INFINITY, 0.0),
    ] {
        let lens = Lens {
            radius: 1.0,
            focus_distance: s,
        };
        let film = render(&point(d, x, lens).scene, &square(PIXELS, 4096, 1));
        assert_disc(what, &film, x, (1.0 / s - 1.0 / d).abs());
    }
}

#[test]
fn parallel_rays_are_blurred_alike() {
    // The film of half a metre is not scaled by distance: the lamp has the size that it has on the film.
    let (d, s, x) = (3.0, 2.0, 0.1);
    let mut builder = SceneBuilder::new();
    builder.quad(lamp(1.0), DVec3::X * x, DVec3::X * LAMP, DVec3::Y * LAMP);
    builder.parallel(DVec3::Z * d, DVec3::ZERO, HALF);
    builder.scene.cameras[0].lens = Some(Lens {
        radius: 0.5,
        focus_distance: s,
    });
    let film = render(&builder.scene, &square(PIXELS, 4096, 1));
    assert_disc("parallel", &film, x, 0.5 * (1.0 - d / s).abs());
}

/// In focus pixels are what they are without a lens, in every sampler's picture.
#[test]
fn the_plane_in_focus_is_sharp() {
    let (d, side) = (4.0, 2.0 * HALF * 4.0 / 8.0);
    let mut builder = SceneBuilder::new();
    // The two left columns of eight but a hundredth of a pixel, and all rows.
    let width = 1.99 * side;
    let center = DVec3::X * (-4.0 * side + 0.5 * width);
    builder.quad(lamp(1.0), center, DVec3::X * 0.5 * width, DVec3::Y * 9.0);
    builder.pinhole(DVec3::Z * d, DVec3::ZERO, 2.0 * HALF.atan());
    builder.scene.cameras[0].lens = Some(Lens {
        radius: 0.7,
        focus_distance: d,
    });
    for sampler in ["independent", "sobol"] {
        let settings = Settings {
            sampler: sampler.into(),
            ..square(8, 1024, 1)
        };
        let film = render(&builder.scene, &settings);
        for i in 0..64 {
            let mean = film.mean(i)[0];
            match i % 8 {
                0 => assert_eq!(mean, 1.0),
                1 => assert!((mean - 0.99).abs() < 0.02, "{sampler}: {mean}"),
                _ => assert_eq!(mean, 0.0),
            }
        }
    }
}

/// A lens shifts no random number of what follows, and one of no size is none.
#[test]
fn what_is_compiled_in_and_not_used_changes_no_bit() {
    let mut builder = SceneBuilder::new();
    builder.ground(lambert(0.6), 1.0);
    builder.sky(1.0);
    builder.pinhole(DVec3::new(0.0, 1.0, 2.0), DVec3::ZERO, 0.7);
    let scene = builder.scene;
    let lens = Lens {
        radius: 0.0,
        focus_distance: 2.0,
    };
    let mut without_size = scene.clone();
    without_size.cameras[0].lens = Some(lens);
    for sampler in ["independent", "sobol"] {
        let settings = Settings {
            sampler: sampler.into(),
            ..square(16, 16, 4)
        };
        let plain = render(&scene, &settings);
        let mut prepared = prepare(&without_size);
        assert!(!prepared.features.lens && !prepared.features.panorama);
        prepared.features.lens = true;
        prepared.features.panorama = true;
        let compiled_in = render_prepared(&without_size, &prepared, &settings);
        assert_eq!(plain.pixels, compiled_in.pixels, "{sampler}");
    }
}

fn prepare(scene: &Scene) -> Prepared {
    Prepared::new(scene, 0, &BuildOptions::default()).expect("a prepared scene")
}

#[test]
fn the_distance_to_focus_at_is_along_the_axis() {
    let mut builder = SceneBuilder::new();
    builder.quad(lambert(0.5), DVec3::ZERO, DVec3::X, DVec3::Y);
    builder.pinhole(DVec3::new(0.5, 0.0, 3.0), DVec3::X * 0.5, 2.0 * HALF.atan());
    let mut scene = builder.scene;
    let settings = Settings {
        width: 8,
        height: 8,
        ..Settings::default()
    };
    let at = |scene: &Scene, at| distance_at(scene, &prepare(scene), &settings, at);
    let near = |found: Option<f64>, expected: f64| {
        let found = found.expect("a surface");
        assert!(
            (found - expected).abs() < 1e-5 * expected,
            "{found} {expected}"
        );
    };
    near(at(&scene, [0.5, 0.5]), 3.0);
    // Aside it is the same plane.
    near(at(&scene, [0.2, 0.3]), 3.0);
    assert_eq!(at(&scene, [0.9, 0.5]), None);
    // From behind the camera sees through it; double-sided it does not.
    builder = SceneBuilder {
        scene: scene.clone(),
    };
    builder.quad(
        lambert(0.5),
        DVec3::Z * -2.0,
        DVec3::NEG_X * 9.0,
        DVec3::Y * 9.0,
    );
    builder.quad(
        lambert(0.5),
        DVec3::Z * -3.0,
        DVec3::X * 9.0,
        DVec3::Y * 9.0,
    );
    builder.scene.instances.remove(0);
    scene = builder.scene;
    near(at(&scene, [0.4, 0.5]), 6.0);
    scene.materials[1].double_sided = true;
    near(at(&scene, [0.4, 0.5]), 5.0);
    scene.cameras[0].projection = Projection::Orthographic {
        xmag: 1.0,
        ymag: 1.0,
    };
    near(at(&scene, [0.1, 0.9]), 5.0);
    scene.cameras[0].projection = Projection::Panorama;
    assert_eq!(at(&scene, [0.5, 0.5]), None);
}
