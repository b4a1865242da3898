//! The cells that numbers choose.

use std::ops::Range;

use glam::Vec3;

use super::{COLUMNS, ROWS, hot_environment, picture, sunny};
use crate::accel_common::Random;
use crate::common::lights::Bench;

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
    fn block_of(&self, axis: usize, cell: usize) -> (usize, Range<usize>) {
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
