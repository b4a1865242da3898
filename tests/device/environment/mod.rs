//! Environment sampling on the device: samples against densities. The rate of false alarms is
//! stated in common/statistics.rs.

mod choice;
mod variance;

use std::f64::consts::PI;

use crate::accel_common::Random;
use crate::common::grid::{SphereGrid, even, even_grid};
use crate::common::lights::*;
use crate::common::statistics::*;
use etendue::scene::{EnvironmentImage, Scene};
use glam::{DMat3, DVec3, Vec3};

fn axes(grid_pole: DVec3, x: DVec3) -> DMat3 {
    DMat3::from_cols(x, grid_pole.cross(x), grid_pole)
}

const ENVIRONMENT: &str = "light/environment.wgsl";
const CHOICE: &str = "light/environment_choice.wgsl";
const COLUMNS: usize = 32;
const ROWS: usize = 16;

/// Dim noise, a sun, hot texels at both poles and at the seam, and a region of zeros.
fn hot_environment() -> Scene {
    let mut random = Random(6);
    let mut texels: Vec<[f32; 3]> = (0..COLUMNS * ROWS)
        .map(|_| [random.unit_f64() as f32; 3])
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
    let normals = [Vec3::Y, Vec3::NEG_Y, Vec3::new(-0.6, 0.1, -0.7)];
    for normal in normals {
        let bench = Bench::new(&hot_environment(), Vec3::ZERO, normal);
        check_environment(&bench, |d| d.dot(normal.normalize().as_dvec3()).max(0.0));
    }
    let bench = Bench::new(&hot_environment(), Vec3::ZERO, Vec3::Y).both_sides();
    check_environment(&bench, |_| 1.0);
}

/// Samples follow their density, which integrates to 1, and the mean of their weights, each times what its direction
/// counts, is the integral of the radiance.
fn check_environment(bench: &Bench, counts_for: impl Fn(DVec3) -> f64) {
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
    check_environment_consistency(bench, &drawn);
    let count = |d: &[f32; 4]| counts_for(DVec3::from(xyz(d).map(f64::from)));
    for c in 0..3 {
        let radiance = values.iter().zip(&directions);
        let radiance = radiance.map(|(v, d)| f64::from(v[c]) * count(d));
        let expected: f64 = SphereGrid::integrate(&weights, radiance).iter().sum();
        let (mean, error) = mean_and_error(drawn.iter().map(|d| f64::from(d[1][c]) * count(&d[0])));
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

/// Negative controls: a pdf without the sine, all columns alike, the table of another normal, points spread evenly within
/// their cells, and a turn the wrong way.
#[test]
fn wrong_environments_are_rejected() {
    for (name, file, from, to) in [
        (
            "a pdf without the sine",
            ENVIRONMENT,
            "density / sin_theta",
            "0.5 * PI * density",
        ),
        (
            "columns alike",
            CHOICE,
            "let above = load_environment_cdf(first + middle) <= half;",
            "let above = (half & (1u << (last & 31u))) != 0u;",
        ),
        (
            "the table of another normal",
            CHOICE,
            "let table = environment_table(grid, normal);",
            "let table = environment_table(grid, normal.zxy);",
        ),
        (
            "points evenly in their cells",
            ENVIRONMENT,
            "let x = sample_linear(point.inside.x, across.x, across.y);",
            "let x = point.inside.x;",
        ),
        (
            "the wrong turn",
            ENVIRONMENT,
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

fn picture(width: usize, height: usize, at: impl Fn(usize, usize) -> f32) -> Scene {
    let texel = |i: usize| [at(i % width, i / width); 3];
    environment(Some(EnvironmentImage {
        width,
        height,
        texels: (0..width * height).map(texel).collect(),
    }))
}

/// A sky that is brighter above, with a small sun.
fn sunny(sun: f32) -> Scene {
    picture(256, 128, |x, y| match (x, y) {
        (70..72, 30..32) => sun,
        _ => 1.5 - y as f32 / 128.0,
    })
}

/// All of the light that reaches a surface can be drawn, and what is drawn is seldom below its horizon.
#[test]
fn no_light_above_the_horizon_is_left_out() {
    let (directions, _) = texel_grid(0.9).points();
    let mut random = Random(23);
    for _ in 0..40 {
        let mut coordinate = || random.unit_f64() as f32 - 0.5;
        let normal = Vec3::new(coordinate(), coordinate(), coordinate()).normalize();
        let bench = Bench::new(&hot_environment(), Vec3::ZERO, normal);
        let values = bench.evaluate("evaluate_environment", &directions);
        for (direction, value) in directions.iter().zip(values) {
            let cosine = Vec3::from(xyz(direction)).dot(normal);
            let is_lit = value[..3] != [0.0; 3];
            assert!(
                value[3] > 0.0 || cosine <= 0.0 || !is_lit,
                "{direction:?} {normal}"
            );
        }
        let bench = Bench::new(&picture(64, 32, |_, _| 1.0), Vec3::ZERO, normal);
        let drawn = bench.draw("sample_environment", 4);
        let below = |d: &&Drawn| Vec3::from(xyz(&d[0])).dot(normal) < 0.0;
        let share = drawn.iter().filter(below).count() as f64 / drawn.len() as f64;
        assert!(share < 0.05, "{share} below {normal}");
    }
}
