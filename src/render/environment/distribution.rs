//! How the device chooses a cell of an environment: first a block of cells, by a table for the normal of the surface
//! that the light is for, then a row of the block, then a cell of the row.

use std::ops::Range;

use rayon::prelude::*;

use super::normals;
use super::row_weights;
use crate::render::cdf::{fixed_point_cdf, guide, guide_length, probabilities};
use crate::scene::EnvironmentImage;

/// Binary logarithms of the most columns of blocks, and of the rows (not counting what the poles add).
const BLOCK_COLUMNS: u32 = 5;
const BLOCK_ROWS: u32 = 4;

/// The columns or the rows of cells. They stand in runs of a power of two, the last of which may be shorter, since
/// lavapipe divides integers lane by lane.
#[derive(Debug, Clone, Copy)]
pub struct Axis {
    /// Cells.
    pub count: usize,
    /// Binary logarithm of the cells of a run.
    shift: u32,
}

impl Axis {
    /// The runs of which there are as many as blocks, for so many texels.
    fn blocks(count: usize, texels: usize, log2_blocks: u32) -> Self {
        let shift = texels
            .next_power_of_two()
            .ilog2()
            .saturating_sub(log2_blocks);
        Self { count, shift }
    }

    /// Runs of half the length, unless it is 1.
    pub fn halves(self) -> Self {
        let shift = self.shift.saturating_sub(1);
        Self { shift, ..self }
    }

    /// Number of runs.
    pub fn runs(self) -> usize {
        self.count.div_ceil(1 << self.shift)
    }

    /// The cells of a run.
    pub fn cells_of(self, run: usize) -> Range<usize> {
        let end = (run + 1) << self.shift;
        run << self.shift..end.min(self.count)
    }

    /// The run of a cell.
    pub fn run_of(self, cell: usize) -> usize {
        cell >> self.shift
    }

    /// The cells of each run.
    fn all(self) -> impl Iterator<Item = Range<usize>> {
        (0..self.runs()).map(move |run| self.cells_of(run))
    }

    /// The guides of the distributions of each run.
    fn guides(self, ends: &[u32]) -> Vec<u32> {
        let length = guide_length(1 << self.shift);
        let mut guides = vec![0; length * self.runs()];
        for (guide_of, cells) in guides.chunks_mut(length).zip(self.all()) {
            guide(&ends[cells], guide_of);
        }
        guides
    }
}

/// The cells of an environment, and what its words in [`super::EnvironmentTable::cdf`] are. One after the other:
///
/// - for each row of cells, for each block that it meets, the distribution of the block's cells in this row;
/// - for each column of blocks, for each of its blocks, the distribution of the block's rows;
/// - the guides of the former, then of the latter;
/// - for each normal a table: the distribution of the rows of blocks, that of the blocks in each row, and the
///   blocks' probabilities as f32.
///
/// A distribution is the lower ends of its intervals, in 2⁻³¹.
#[derive(Debug, Clone, Copy)]
pub struct Grid {
    /// Columns of cells, in runs as long as a block.
    pub columns: Axis,
    /// Rows of cells, in runs as long as a block.
    pub rows: Axis,
}

impl Grid {
    pub fn new(image: &EnvironmentImage) -> Self {
        Self {
            columns: Axis::blocks(image.width, image.width, BLOCK_COLUMNS),
            rows: Axis::blocks(image.height + 1, image.height, BLOCK_ROWS),
        }
    }

    pub fn blocks(self) -> usize {
        self.columns.runs() * self.rows.runs()
    }

    /// Words of a normal's table.
    pub fn table_length(self) -> usize {
        self.rows.runs() + 2 * self.blocks()
    }

    /// Probability of a row of cells, once one of the blocks that it meets is chosen; 0 if that never is.
    pub fn row_probability(self, cdf: &[u32], block_column: usize, row: usize) -> f64 {
        let block = self.rows.run_of(row);
        let chances = &cdf[cdf.len() - self.blocks()..];
        if chances[block * self.columns.runs() + block_column] == 0 {
            return 0.0;
        }
        let rows = self.rows.cells_of(block);
        let first = self.columns.count * self.rows.count + block_column * self.rows.count;
        let ends = &cdf[first..][rows.clone()];
        probabilities(ends).nth(row - rows.start).unwrap_or(0.0)
    }
}

/// The words of [`Grid`]; none if no texel sheds light.
pub fn distribution(image: &EnvironmentImage) -> Vec<u32> {
    let grid = Grid::new(image);
    let mut cells = vec![0; grid.columns.count * grid.rows.count];
    // For each row, the weights of the halves of its blocks.
    let halves: Vec<Vec<f64>> = cells
        .par_chunks_mut(grid.columns.count)
        .enumerate()
        .map(|(row, ends)| row_distribution(grid, &row_weights(image, row), ends))
        .collect();
    if halves.iter().flatten().all(|weight| *weight == 0.0) {
        return Vec::new();
    }
    let rows: Vec<u32> = (0..grid.columns.runs())
        .flat_map(|block_column| rows_distribution(grid, block_column, &halves))
        .collect();
    let each_row = cells.par_chunks(grid.columns.count);
    let cell_guides: Vec<u32> = each_row
        .flat_map_iter(|ends| grid.columns.guides(ends))
        .collect();
    let each_column = rows.chunks(grid.rows.count);
    let row_guides: Vec<u32> = each_column
        .flat_map(|ends| grid.rows.guides(ends))
        .collect();
    let tables = normals::tables(grid, &halves);
    [cells, rows, cell_guides, row_guides, tables].concat()
}

fn row_distribution(grid: Grid, weights: &[f64], ends: &mut [u32]) -> Vec<f64> {
    for cells in grid.columns.all() {
        fixed_point_cdf(&weights[cells.clone()], &mut ends[cells]);
    }
    let halves = grid.columns.halves().all();
    halves.map(|cells| weights[cells].iter().sum()).collect()
}

fn rows_distribution(grid: Grid, block_column: usize, halves: &[Vec<f64>]) -> Vec<u32> {
    let cells = grid.columns.cells_of(block_column);
    let of_halves = grid.columns.halves();
    let of_block = of_halves.run_of(cells.start)..=of_halves.run_of(cells.end - 1);
    let weights: Vec<f64> = halves
        .iter()
        .map(|row| row[of_block.clone()].iter().sum())
        .collect();
    let mut ends = vec![0; weights.len()];
    for rows in grid.rows.all() {
        fixed_point_cdf(&weights[rows.clone()], &mut ends[rows]);
    }
    ends
}
