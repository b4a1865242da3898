//! How the device chooses a cell of an environment: first a block of cells, by a table for the normal of the surface
//! that the light is for, then a row of the block, then a cell of the row.

use std::ops::Range;

use rayon::prelude::*;

use super::normals::{self, SUBDIVISION};
use super::row_weights;
use crate::render::cdf::{fixed_point_cdf, guide, guide_length, probabilities};
use crate::scene::EnvironmentImage;

/// Most blocks in a row and in a column; an environment of fewer cells has fewer.
const BLOCK_COLUMNS: usize = 32;
const BLOCK_ROWS: usize = 16;

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
    /// Columns of cells.
    pub width: usize,
    /// Rows of cells.
    pub rows: usize,
}

impl Grid {
    pub fn new(image: &EnvironmentImage) -> Self {
        let (width, rows) = (image.width, image.height + 1);
        Self { width, rows }
    }

    pub fn block_columns(self) -> usize {
        BLOCK_COLUMNS.min(self.width)
    }

    pub fn block_rows(self) -> usize {
        BLOCK_ROWS.min(self.rows)
    }

    pub fn columns_of(self, block: usize) -> Range<usize> {
        span(block, self.block_columns(), self.width)
    }

    pub fn rows_of(self, block: usize) -> Range<usize> {
        span(block, self.block_rows(), self.rows)
    }

    fn first_row_end(self) -> usize {
        self.width * self.rows
    }

    /// Values of a guide to the cells, and to the rows, of a block.
    fn guide_lengths(self) -> (usize, usize) {
        let cells = guide_length(self.width.div_ceil(self.block_columns()));
        (cells, guide_length(self.rows.div_ceil(self.block_rows())))
    }

    /// Probability of a row of cells, once one of the blocks that it meets is chosen; 0 if that never is.
    pub fn row_probability(self, cdf: &[u32], block_column: usize, row: usize) -> f64 {
        // The last row at which a block begins, as cells are given to blocks by the device.
        let block = ((row + 1) * self.block_rows() - 1) / self.rows;
        let (rows, columns) = (self.rows_of(block), self.block_columns());
        let chances = &cdf[cdf.len() - columns * self.block_rows()..];
        if chances[block * columns + block_column] == 0 {
            return 0.0;
        }
        let first = rows.start;
        let ends = &cdf[self.first_row_end() + block_column * self.rows..][rows];
        probabilities(ends).nth(row - first).unwrap_or(0.0)
    }
}

/// The part that one of several has of a count.
pub fn span(part: usize, parts: usize, count: usize) -> Range<usize> {
    part * count / parts..(part + 1) * count / parts
}

/// The words of [`Grid`]; none if no texel sheds light.
pub fn distribution(image: &EnvironmentImage) -> Vec<u32> {
    let grid = Grid::new(image);
    let mut cells = vec![0; grid.width * grid.rows];
    // For each row, the weights of parts of blocks.
    let parts: Vec<Vec<f64>> = cells
        .par_chunks_mut(grid.width)
        .enumerate()
        .map(|(row, ends)| row_distribution(grid, &row_weights(image, row), ends))
        .collect();
    if parts.iter().flatten().all(|weight| *weight == 0.0) {
        return Vec::new();
    }
    let rows = rows_distribution(grid, &parts);
    let (of_cells, of_rows) = grid.guide_lengths();
    let cell_chunks = |row: &[u32]| -> Vec<u32> {
        let blocks = (0..grid.block_columns()).map(|b| grid.columns_of(b));
        blocks.flat_map(|b| guide_of(&row[b], of_cells)).collect()
    };
    let cell_guides: Vec<u32> = cells.par_chunks(grid.width).flat_map(cell_chunks).collect();
    let row_guides = rows.chunks(grid.rows).flat_map(|column| {
        let blocks = (0..grid.block_rows()).map(|b| grid.rows_of(b));
        blocks
            .flat_map(|b| guide_of(&column[b], of_rows))
            .collect::<Vec<u32>>()
    });
    let row_guides: Vec<u32> = row_guides.collect();
    let tables = normals::tables(grid, &parts);
    [cells, rows, cell_guides, row_guides, tables].concat()
}

fn guide_of(ends: &[u32], length: usize) -> Vec<u32> {
    let mut values = vec![0; length];
    guide(ends, &mut values);
    values
}

fn row_distribution(grid: Grid, weights: &[f64], ends: &mut [u32]) -> Vec<f64> {
    for block in 0..grid.block_columns() {
        let columns = grid.columns_of(block);
        fixed_point_cdf(&weights[columns.clone()], &mut ends[columns]);
    }
    let parts = SUBDIVISION * grid.block_columns();
    let sum = |part| weights[span(part, parts, grid.width)].iter().sum();
    (0..parts).map(sum).collect()
}

fn rows_distribution(grid: Grid, parts: &[Vec<f64>]) -> Vec<u32> {
    let mut ends = vec![0; grid.block_columns() * grid.rows];
    for (column, ends) in ends.chunks_mut(grid.rows).enumerate() {
        let parts_of = SUBDIVISION * column..SUBDIVISION * (column + 1);
        let weights: Vec<f64> = parts
            .iter()
            .map(|row| row[parts_of.clone()].iter().sum())
            .collect();
        for block in 0..grid.block_rows() {
            let rows = grid.rows_of(block);
            fixed_point_cdf(&weights[rows.clone()], &mut ends[rows]);
        }
    }
    ends
}
