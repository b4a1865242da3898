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

const ENVIRONMENT: &str = "light/environment.wgsl";
/// By how much the variance at 64 Sobol samples is at least below that of independent ones.
const SOBOL_GAIN: f64 = 10.0;
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

/// Negative controls: cells chosen without their rows' solid angle, all columns alike, points spread
/// evenly within their cells, and a turn the wrong way.
#[test]
fn wrong_environments_are_rejected() {
    for (name, from, to) in [
        (
            "a pdf without the sine",
            "density / sin_theta",
            "0.5 * PI * density",
        ),
        (
            "columns alike",
            "let above = load_environment_cdf(first + middle) <= number;",
            "let above = (number & (1u << (last & 31u))) != 0u;",
        ),
        (
            "points evenly in their cells",
            "let x = sample_linear(point.inside.x, across.x, across.y);",
            "let x = point.inside.x;",
        ),
        (
            "the wrong turn",
            "return vec3f(c * d.x + s * d.z, d.y, -s * d.x + c * d.z);",
            "return vec3f(c * d.x - s * d.z, d.y, s * d.x + c * d.z);",
        ),
    ] {
        let mut bench = Bench::new(&hot_environment(), Vec3::ZERO, Vec3::Y);
        bench.setup = bench.setup.patched(ENVIRONMENT, from, to);
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

/// Lower end and length of the interval of a distribution that holds a number.
fn interval(cdf: &[u32], number: u32) -> (usize, u32, u32) {
    let index = cdf.partition_point(|end| *end <= number) - 1;
    let upper = cdf.get(index + 1).copied().unwrap_or(1 << 31);
    (index, cdf[index], upper - cdf[index])
}

/// The cell and the uniform place in it that a pair of numbers must choose, in 2⁻³¹ (column, then row).
fn chosen(cdf: &[u32], [width, rows]: [usize; 2], [x, y]: [u32; 2]) -> [f64; 4] {
    let inside = |first: u32, length: u32, bits: u32, other: u32| {
        let low = f64::from(other & 0xffff) / 65536.0;
        (f64::from((bits >> 1) - first) + low) / f64::from(length)
    };
    let (row, first_row, height) = interval(&cdf[..rows], y >> 1);
    let columns = &cdf[rows + row * width..][..width];
    let (column, first, length) = interval(columns, x >> 1);
    [
        column as f64,
        row as f64,
        inside(first, length, x, y),
        inside(first_row, height, y, x),
    ]
}

/// Ends of rows and of their columns, the numbers next to them, the least and the greatest.
fn hard_numbers(cdf: &[u32], [width, rows]: [usize; 2]) -> Vec<[u32; 2]> {
    let about = |end: &u32| [end << 1, (end << 1).wrapping_sub(1), (end << 1) | 1];
    let mut random = Random(21);
    let mut pairs = vec![[0, 0], [u32::MAX, u32::MAX], [0, u32::MAX], [u32::MAX, 0]];
    for (row, end) in cdf[..rows].iter().enumerate() {
        let columns = &cdf[rows + row * width..][..width];
        for y in about(end) {
            pairs.extend(columns.iter().step_by(7).flat_map(about).map(|x| [x, y]));
            pairs.push([random.bits() as u32, y]);
        }
    }
    pairs.extend((0..50_000).map(|_| [random.bits() as u32, random.bits() as u32]));
    pairs
}

#[test]
fn numbers_choose_the_cells_that_the_distribution_says() {
    let narrow = |x: usize, y: usize| ((x * y) % 5) as f32;
    for (scene, size) in [
        (hot_environment(), [COLUMNS, ROWS + 1]),
        (sunny(1e6), [256, 129]),
        (picture(1, 1, |_, _| 2.0), [1, 2]),
        (picture(1, 19, |_, y| narrow(1, y)), [1, 20]),
        (picture(23, 1, |x, _| narrow(x, 1)), [23, 2]),
    ] {
        let bench = Bench::new(&scene, Vec3::ZERO, Vec3::Y);
        let table = &bench.stage.prepared.environment;
        let numbers = hard_numbers(&table.cdf, size);
        let inputs: Vec<[f32; 4]> = numbers
            .iter()
            .map(|[x, y]| [f32::from_bits(*x), f32::from_bits(*y), 0.0, 0.0])
            .collect();
        let results = bench.evaluate("invert_environment", &inputs);
        for (pair, result) in numbers.iter().zip(results) {
            let expected = chosen(&table.cdf, size, *pair);
            let result = result.map(f64::from);
            assert_eq!(result[..2], expected[..2], "{pair:?} in {size:?}");
            let cell = result[1] as usize * size[0] + result[0] as usize;
            assert!(table.texels[cell][3] > 0.0, "{pair:?} in {size:?}");
            for c in 2..4 {
                assert!(
                    (result[c] - expected[c]).abs() < 3e-7 && result[c] < 1.0,
                    "{pair:?}"
                );
            }
        }
    }
}

/// Mean and variance, over pixels, of the light that 64 samples estimate; half of it is the sun's.
fn estimate(setup: impl Fn(Setup) -> Setup) -> (f64, f64) {
    const PIXELS: usize = 4096;
    let mut bench = Bench::new(&sunny(1e4), Vec3::ZERO, Vec3::new(0.2, 1.0, 0.1));
    bench.setup = setup(bench.setup);
    let estimates = bench.estimate("estimate_environment", PIXELS, 64);
    let (mean, error) = mean_and_error(estimates.iter().map(|e| f64::from(e[0])));
    (mean, error * error * PIXELS as f64)
}

/// Sobol points keep their order, so that the variance at 64 samples is a small part of that of
/// independent samples; if the numbers are shuffled first, it is not.
#[test]
fn sobol_samples_stay_well_spread() {
    let (mean, independent) = estimate(|setup| setup);
    let (sobol_mean, sobol) = estimate(|setup| setup.sampler("sobol"));
    let (_, shuffled) = estimate(|setup| {
        let (from, to) = (
            "= environment_choose(bits);",
            "= environment_choose(vec2u(mix32(bits.x), mix32(bits.y)));",
        );
        setup.sampler("sobol").patched(ENVIRONMENT, from, to)
    });
    println!("independent {independent:e}, Sobol {sobol:e}, shuffled {shuffled:e}");
    let error = (independent / 4096.0).sqrt();
    assert!(
        (mean - sobol_mean).abs() < 6.0 * error,
        "{mean} {sobol_mean}"
    );
    assert!(
        sobol * SOBOL_GAIN < independent,
        "{sobol:e} {independent:e}"
    );
    assert!(
        shuffled * SOBOL_GAIN > independent,
        "{shuffled:e} {independent:e}"
    );
}
