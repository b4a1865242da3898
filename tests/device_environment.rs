//! Environment sampling on the device: samples against densities. The rate of false alarms is
//! stated in device_common/statistics.rs.

mod device_common;

use std::f64::consts::PI;

use device_common::grid::{SphereGrid, even, even_grid};
use device_common::lights::*;
use device_common::statistics::*;
use device_common::*;
use etendue::scene::{EnvironmentImage, Scene};
use glam::{DMat3, DVec3, Vec3};

fn axes(grid_pole: DVec3, x: DVec3) -> DMat3 {
    DMat3::from_cols(x, grid_pole.cross(x), grid_pole)
}

const COLUMNS: usize = 32;
const ROWS: usize = 16;

/// Dim noise, a sun, hot texels at both poles and at the seam, and a region of zeros.
fn hot_environment() -> Scene {
    let mut random = Random(6);
    let mut texels: Vec<[f32; 3]> = (0..COLUMNS * ROWS)
        .map(|_| [random.unit() as f32; 3])
        .collect();
    for y in 5..12 {
        for x in 12..20 {
            texels[y * COLUMNS + x] = [0.0; 3];
        }
    }
    for (x, y, value) in [
        (8, 3, 3000.0),
        (0, 7, 100.0),
        (31, 9, 200.0),
        (16, 0, 50.0),
        (3, 15, 80.0),
    ] {
        texels[y * COLUMNS + x] = [value, 0.5 * value, 0.1 * value];
    }
    environment(Some(EnvironmentImage {
        width: COLUMNS,
        height: ROWS,
        texels,
    }))
}

/// Two by two cells a texel; phi about +y as the picture has it, turned with the environment.
fn texel_grid(rotation: f64) -> SphereGrid {
    let rows = even(0.0, PI, 2 * ROWS);
    let turn = DMat3::from_rotation_y(rotation);
    SphereGrid {
        nu: rows.into_iter().map(|theta| 1.0 - theta.cos()).collect(),
        phi: even(-PI, PI, 2 * COLUMNS),
        axes: turn * DMat3::from_cols(DVec3::X, DVec3::Z, DVec3::Y),
    }
}

/// Weight × pdf = radiance, and the pdf of the sample that of its direction.
fn check_environment_consistency(bench: &Bench, drawn: &[Drawn]) {
    let directions: Vec<[f32; 4]> = drawn.iter().map(|d| d[0]).collect();
    let (mut off, mut unlike) = (0, 0);
    for (d, value) in drawn
        .iter()
        .zip(bench.evaluate("evaluate_environment", &directions))
    {
        let close = |a: f32, b: f32| (a - b).abs() <= 1e-3 * a.abs().max(b.abs());
        // The direction of a sample next to a texel's edge may round into the neighbour.
        unlike += usize::from(!close(d[0][3], value[3]));
        let radiance: [f32; 3] = std::array::from_fn(|c| d[1][c] * d[0][3]);
        off += usize::from((0..3).any(|c| !close(radiance[c], value[c])));
    }
    assert!(unlike * 50_000 <= drawn.len(), "{unlike} densities differ");
    assert!(off * 10_000 <= drawn.len(), "{off} weights differ");
}

#[test]
fn environment_samples_follow_their_density() {
    let bench = Bench::new(&hot_environment(), Vec3::ZERO, Vec3::Y);
    let grid = texel_grid(0.9);
    let (directions, weights) = grid.points();
    let values = bench.evaluate("evaluate_environment", &directions);
    let expected = SphereGrid::integrate(&weights, values.iter().map(|v| f64::from(v[3])));
    let total: f64 = expected.iter().sum();
    assert!((total - 1.0).abs() < 1e-5, "{total}");
    let drawn = bench.draw("sample_environment", 2);
    let wi: Vec<[f32; 3]> = drawn.iter().map(|d| xyz(&d[0])).collect();
    let (counts, lost) = grid.histogram(&wi);
    assert_fits("environment picture", &counts, &expected, lost);
    check_environment_consistency(&bench, &drawn);
    // The mean weight is the integral of the radiance.
    for c in 0..3 {
        let radiance = values.iter().map(|v| f64::from(v[c]));
        let expected: f64 = SphereGrid::integrate(&weights, radiance).iter().sum();
        let (mean, error) = mean_and_error(drawn.iter().map(|d| f64::from(d[1][c])));
        assert!(
            (mean - expected).abs() < 5.0 * error + 1e-3 * expected,
            "{mean} {error} {expected}"
        );
    }
}

#[test]
fn constant_environment_samples_follow_their_density() {
    let normal = Vec3::new(0.3, -0.5, 0.7);
    let bench = Bench::new(&environment(None), Vec3::ZERO, normal);
    let pole = normal.as_dvec3().normalize();
    let grid = SphereGrid {
        axes: axes(pole, pole.any_orthonormal_vector()),
        ..even_grid()
    };
    let (directions, weights) = grid.points();
    let values = bench.evaluate("evaluate_environment", &directions);
    let expected = SphereGrid::integrate(&weights, values.iter().map(|v| f64::from(v[3])));
    assert!((expected.iter().sum::<f64>() - 1.0).abs() < 1e-5);
    let drawn = bench.draw("sample_environment", 3);
    let wi: Vec<[f32; 3]> = drawn.iter().map(|d| xyz(&d[0])).collect();
    let (counts, lost) = grid.histogram(&wi);
    assert_fits("constant environment", &counts, &expected, lost);
    check_environment_consistency(&bench, &drawn);
}

/// Negative controls: texels chosen without their rows' solid angle, and a turn the wrong way.
#[test]
fn wrong_environments_are_rejected() {
    let file = "light/environment.wgsl";
    for (name, from, to) in [
        (
            "a pdf without the sine",
            "(2.0 * PI * PI * sin_theta)",
            "(4.0 * PI)",
        ),
        (
            "no alias",
            "return select(entry.y, index,",
            "return select(index, index,",
        ),
        (
            "the wrong turn",
            "return vec3f(c * d.x + s * d.z, d.y, -s * d.x + c * d.z);",
            "return vec3f(c * d.x - s * d.z, d.y, s * d.x + c * d.z);",
        ),
    ] {
        let mut bench = Bench::new(&hot_environment(), Vec3::ZERO, Vec3::Y);
        bench.setup = bench.setup.patched(file, from, to);
        let grid = texel_grid(0.9);
        let (directions, weights) = grid.points();
        let values = bench.evaluate("evaluate_environment", &directions);
        let expected = SphereGrid::integrate(&weights, values.iter().map(|v| f64::from(v[3])));
        let drawn = bench.draw("sample_environment", 2);
        let wi: Vec<[f32; 3]> = drawn.iter().map(|d| xyz(&d[0])).collect();
        let (counts, lost) = grid.histogram(&wi);
        assert_rejected(name, &counts, &expected, lost);
    }
}
