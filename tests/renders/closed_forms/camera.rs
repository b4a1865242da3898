//! Which pixel sees what.

use etendue::render::{Film, Settings};
use etendue::scene::Scene;
use glam::DVec3;

use crate::common::{SceneBuilder, lamp, render, square};

/// A lamp of radiance 1 in the plane z = 0 that covers [x0, x1] × [y0, y1].
fn window(builder: &mut SceneBuilder, [x0, x1]: [f64; 2], [y0, y1]: [f64; 2]) {
    let center = DVec3::new(x0 + x1, y0 + y1, 0.0) * 0.5;
    let (u, v) = (DVec3::X * (x1 - x0) * 0.5, DVec3::Y * (y1 - y0) * 0.5);
    builder.quad(lamp(1.0), center, u, v);
}

fn picture(scene: &Scene, width: u32, height: u32) -> Film {
    let settings = Settings {
        width,
        height,
        ..square(1, 64, 1)
    };
    render(scene, &settings)
}

/// Fails unless exactly the pixels of a rectangle (columns, rows from the top) are lit.
fn assert_covers(film: &Film, columns: std::ops::Range<u32>, rows: std::ops::Range<u32>) {
    for y in 0..film.height {
        for x in 0..film.width {
            let inside = columns.contains(&x) && rows.contains(&y);
            let mean = film.mean((y * film.width + x) as usize);
            assert_eq!(mean, [f64::from(u8::from(inside)); 3], "pixel ({x}, {y})");
        }
    }
}

/// Edges lie a millionth of a pixel outside of what they cover, since a sample may round to the
/// edge.
const MARGIN: f64 = 1e-6;

#[test]
fn an_orthographic_pixel_is_a_square_of_known_size() {
    // 2 m wide, 16 × 8 pixels of 1/8 m.
    let mut builder = SceneBuilder::new();
    let side = 0.125;
    let (x, y) = (|i: f64| -1.0 + i * side, |j: f64| 0.5 - j * side);
    window(
        &mut builder,
        [x(3.0) - MARGIN * side, x(5.0) + MARGIN * side],
        [y(2.0) - MARGIN * side, y(1.0) + MARGIN * side],
    );
    builder.parallel(DVec3::Z * 3.0, DVec3::ZERO, 0.5);
    let etendue::scene::Projection::Orthographic { xmag, .. } =
        &mut builder.scene.cameras[0].projection
    else {
        unreachable!("a parallel camera")
    };
    *xmag = 1.0;
    assert_covers(&picture(&builder.scene, 16, 8), 3..5, 1..2);
}

#[test]
fn a_perspective_pixel_is_a_square_on_the_image_plane() {
    // Half the height is tan(yfov / 2) = 0.5 at distance 1; the lamp is at distance 4, so a pixel
    // of a picture of 16 × 8 is 4 · 1 / 8 m wide there.
    let mut builder = SceneBuilder::new();
    let side = 0.5;
    let (x, y) = (|i: f64| (i - 8.0) * side, |j: f64| (4.0 - j) * side);
    window(
        &mut builder,
        [x(10.0) - MARGIN * side, x(16.0) + side],
        [y(8.0) - side, y(5.0) + MARGIN * side],
    );
    builder.pinhole(DVec3::Z * 4.0, DVec3::ZERO, 2.0 * 0.5_f64.atan());
    assert_covers(&picture(&builder.scene, 16, 8), 10..16, 5..8);
}

#[test]
fn pixel_0_0_is_the_top_left() {
    let mut builder = SceneBuilder::new();
    window(&mut builder, [-9.0, -0.75 + MARGIN], [0.75 - MARGIN, 9.0]);
    builder.parallel(DVec3::Z, DVec3::ZERO, 1.0);
    assert_covers(&picture(&builder.scene, 8, 8), 0..1, 0..1);
}

/// The samples of a pixel fill its square evenly: a lamp that covers 0.3 of a pixel lights 0.3 of it.
#[test]
fn samples_fill_the_pixel_evenly() {
    for sampler in ["independent", "sobol"] {
        let mut builder = SceneBuilder::new();
        window(&mut builder, [-2.0, -0.4], [-2.0, 2.0]);
        builder.parallel(DVec3::Z, DVec3::ZERO, 1.0);
        let settings = Settings {
            sampler: sampler.into(),
            ..square(1, 65_536, 1)
        };
        let mean = render(&builder.scene, &settings).mean(0)[0];
        let error = (0.3_f64 * 0.7 / 65_536.0).sqrt();
        assert!((mean - 0.3).abs() < 4.5 * error, "{sampler}: {mean}");
        // A (0, m, 2)-net puts the right number of samples into every strip, but for one.
        if sampler == "sobol" {
            assert!((mean - 0.3).abs() < 2.0 / 65_536.0, "{mean}");
        }
    }
}
