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
const CHOICE: &str = "light/environment_choice.wgsl";
/// By how much the variance at 64 Sobol samples is at least below that of independent ones.
const SOBOL_GAIN: f64 = 10.0;
/// By how much the variance of independent samples is at least below that of samples that know no normal.
const NORMAL_GAIN: f64 = 10.0;
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

/// Negative controls: cells chosen without their rows' solid angle, all columns alike, points spread
/// evenly within their cells, and a turn the wrong way.
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
        let mut coordinate = || random.unit() as f32 - 0.5;
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

const ALL: f64 = (1u32 << 31) as f64;

/// The distributions by which the device chooses, for light from both sides.
struct Words<'a> {
    words: &'a [u32],
    cells: [usize; 2],
    /// Cells along the sides of a block.
    block: [usize; 2],
    blocks: [usize; 2],
}

impl<'a> Words<'a> {
    fn new(words: &'a [u32], cells: [usize; 2]) -> Self {
        let texels = [cells[0], cells[1] - 1];
        let block = [texels[0] as f64 / 32.0, texels[1] as f64 / 16.0];
        let block =
            block.map(|least| 1usize << (0..).find(|n| f64::from(1 << n) >= least).unwrap_or(0));
        let blocks = [0, 1].map(|axis| cells[axis].div_ceil(block[axis]));
        Self {
            words,
            cells,
            block,
            blocks,
        }
    }

    /// The last of the tables of 16 by 16 normals and one.
    fn table(&self) -> &[u32] {
        let [columns, rows] = self.blocks;
        &self.words[self.words.len() - rows - 2 * columns * rows..]
    }

    /// Block of a cell along an axis, and the block's cells.
    fn block_of(&self, axis: usize, cell: usize) -> (usize, std::ops::Range<usize>) {
        let block = cell / self.block[axis];
        let first = block * self.block[axis];
        (
            block,
            first..(first + self.block[axis]).min(self.cells[axis]),
        )
    }

    /// The numbers, from 0 to 1, by which a place in a cell (column and row) is chosen.
    fn numbers(&self, cell: [usize; 2], inside: [f64; 2]) -> [f64; 2] {
        let (column, columns) = self.block_of(0, cell[0]);
        let (row, rows) = self.block_of(1, cell[1]);
        let [width, height] = self.cells;
        let row_ends = &self.words[width * height + column * height..][rows.clone()];
        let cell_ends = &self.words[cell[1] * width..][columns.clone()];
        let block_ends = &self.table()[self.blocks[1] + row * self.blocks[0]..][..self.blocks[0]];
        let in_block = [
            place(cell_ends, cell[0] - columns.start, inside[0]),
            place(row_ends, cell[1] - rows.start, inside[1]),
        ];
        let row_place = place(&self.table()[..self.blocks[1]], row, in_block[1]);
        [place(block_ends, column, in_block[0]), row_place]
    }
}

/// What is inside an interval of a distribution, as a number from 0 to 1.
fn place(ends: &[u32], index: usize, inside: f64) -> f64 {
    let upper = ends.get(index + 1).copied().unwrap_or(1 << 31);
    assert!(ends[index] < upper, "an empty interval was chosen");
    (f64::from(ends[index]) + f64::from(upper - ends[index]) * inside) / ALL
}

/// Numbers at and next to the ends of blocks, rows and columns, the least and the greatest.
fn hard_numbers(words: &Words) -> Vec<[u32; 2]> {
    let about = |number: f64| {
        let bits = (number * 4_294_967_296.0) as u32;
        [bits, bits.wrapping_sub(1), bits | 1, bits.wrapping_sub(512)]
    };
    let mut random = Random(21);
    let mut pairs = vec![[0, 0], [u32::MAX, u32::MAX], [0, u32::MAX], [u32::MAX, 0]];
    pairs.extend((0..50_000).map(|_| [random.bits() as u32, random.bits() as u32]));
    let [columns, rows] = words.blocks;
    for row in 0..rows {
        let y = f64::from(words.table()[row]) / ALL;
        for column in 0..columns {
            let x = f64::from(words.table()[rows + row * columns + column]) / ALL;
            let both = about(y).into_iter().flat_map(|y| about(x).map(|x| [x, y]));
            pairs.extend(both);
        }
    }
    pairs
}

/// The place in the cell that a pair of numbers chooses gives the numbers back, and no empty cell is chosen.
#[test]
fn numbers_choose_the_cells_that_the_distribution_says() {
    let narrow = |x: usize, y: usize| ((x * y) % 5) as f32;
    for (scene, size) in [
        (hot_environment(), [COLUMNS, ROWS + 1]),
        (sunny(1e6), [256, 129]),
        (picture(1, 1, |_, _| 2.0), [1, 2]),
        (picture(1, 19, |_, y| narrow(1, y)), [1, 20]),
        (picture(23, 1, |x, _| narrow(x, 1)), [23, 2]),
        (picture(700, 333, narrow), [700, 334]),
    ] {
        let bench = Bench::new(&scene, Vec3::ZERO, Vec3::Y).both_sides();
        let table = &bench.stage.prepared.environment;
        let words = Words::new(&table.cdf, size);
        let numbers = hard_numbers(&words);
        let inputs: Vec<[f32; 4]> = numbers
            .iter()
            .map(|[x, y]| [f32::from_bits(*x), f32::from_bits(*y), 0.0, 0.0])
            .collect();
        let results = bench.evaluate("invert_environment", &inputs);
        for (pair, result) in numbers.iter().zip(results) {
            let cell = [result[0] as usize, result[1] as usize];
            let inside = [f64::from(result[2]), f64::from(result[3])];
            assert!(inside.iter().all(|i| (0.0..1.0).contains(i)), "{pair:?}");
            let density = table.texels[cell[1] * size[0] + cell[0]][3];
            assert!(density > 0.0, "{pair:?} in {size:?}");
            let back = words.numbers(cell, inside);
            for (number, back) in pair.iter().zip(back) {
                let number = f64::from(*number) / (2.0 * ALL);
                assert!((number - back).abs() < 3e-7, "{pair:?} in {size:?}: {back}");
            }
        }
    }
}

/// Mean and variance, over pixels, of the light that 64 samples estimate; half of it is the sun's.
fn estimate(both_sides: bool, setup: impl Fn(Setup) -> Setup) -> (f64, f64) {
    const PIXELS: usize = 4096;
    let mut bench = Bench::new(&sunny(1e4), Vec3::ZERO, Vec3::new(0.2, 1.0, 0.1));
    if both_sides {
        bench = bench.both_sides();
    }
    bench.setup = setup(bench.setup);
    let estimates = bench.estimate("estimate_environment", PIXELS, 64);
    let (mean, error) = mean_and_error(estimates.iter().map(|e| f64::from(e[0])));
    (mean, error * error * PIXELS as f64)
}

fn assert_same_mean((mean, variance): (f64, f64), (other, other_variance): (f64, f64)) {
    let error = ((variance + other_variance) / 4096.0).sqrt();
    assert!((mean - other).abs() < 6.0 * error, "{mean} {other}");
}

/// Sobol points keep their order, so that the variance at 64 samples is a small part of that of
/// independent samples; if the numbers are shuffled first, it is not.
#[test]
fn sobol_samples_stay_well_spread() {
    let independent = estimate(true, |setup| setup);
    let sobol = estimate(true, |setup| setup.sampler("sobol"));
    let (_, shuffled) = estimate(true, |setup| {
        let (from, to) = (
            "= environment_choose(bits, normal);",
            "= environment_choose(vec2u(mix32(bits.x), mix32(bits.y)), normal);",
        );
        setup.sampler("sobol").patched(ENVIRONMENT, from, to)
    });
    println!("independent {independent:?}, Sobol {sobol:?}, shuffled {shuffled:e}");
    assert_same_mean(independent, sobol);
    assert!(sobol.1 * SOBOL_GAIN < independent.1);
    assert!(shuffled * SOBOL_GAIN > independent.1);
}

/// The cosine at the surface varies within a block of cells alone, and so does the variance of a table for the normal.
#[test]
fn a_normal_leaves_little_variance() {
    let both_sides = estimate(true, |setup| setup);
    let normal = estimate(false, |setup| setup);
    println!("from both sides {both_sides:?}, for a normal {normal:?}");
    assert_same_mean(both_sides, normal);
    assert!(normal.1 * NORMAL_GAIN < both_sides.1);
}
