// Choosing a cell of an environment's picture: first a block of cells, in proportion to the light that comes from it
// times the cosine at the surface, then one of the block's rows, then a cell of the row (Pharr, Jakob and Humphreys
// 2023, section A.5.2). src/render/environment builds the distributions.

#include "bindings.wgsl"
#include "math/sampling.wgsl"
#include "steps.wgsl"

// Binary logarithms of the most columns and rows of blocks.
const ENVIRONMENT_BLOCKS: vec2i = vec2i(5, 4);
// Side of the square of normals that have a table each.
const ENVIRONMENT_NORMALS: u32 = 16u;

// A point of a cell between the centres of four texels. The first row of cells begins half a cell
// above the picture, the last ends half a cell below it, the last column ends in the first texel's.
struct EnvironmentPoint {
    // Column and row.
    cell: vec2u,
    // Where in the cell, from 0 to 1.
    inside: vec2f,
}

// The picture's cells and blocks (columns and rows), and where the words about them begin.
struct EnvironmentGrid {
    cells: vec2u,
    // Binary logarithms of a block's cells: lavapipe divides integers lane by lane.
    shift: vec2u,
    blocks: vec2u,
    // Of the guides to a block's columns and rows.
    guide_bits: vec2u,
    row_ends: u32,
    cell_guides: u32,
    row_guides: u32,
    tables: u32,
}

fn environment_grid() -> EnvironmentGrid {
    let size = vec2u(frame.environment_width, frame.environment_height);
    let cells = size + vec2u(0u, 1u);
    // Least powers of two that hold the size, over those of the blocks.
    let shift = vec2u(max(vec2i(firstLeadingBit(size - 1u)) + 1 - ENVIRONMENT_BLOCKS, vec2i(0)));
    let blocks = (cells + (vec2u(1u) << shift) - 1u) >> shift;
    // A guide has 2^this values, and one more, for so many intervals (src/render/cdf.rs).
    let guide_bits = max(shift, vec2u(2u)) - 2u;
    let guide_lengths = environment_guide_lengths(guide_bits);
    let row_ends = cells.x * cells.y;
    let cell_guides = row_ends + blocks.x * cells.y;
    let row_guides = cell_guides + blocks.x * cells.y * guide_lengths.x;
    let tables = row_guides + blocks.x * blocks.y * guide_lengths.y;
    return EnvironmentGrid(cells, shift, blocks, guide_bits, row_ends, cell_guides, row_guides, tables);
}

fn environment_guide_lengths(bits: vec2u) -> vec2u {
    return (vec2u(1u) << bits) + 1u;
}

// The table of a normal, or that for light from all sides if it is null.
fn environment_table(grid: EnvironmentGrid, normal: vec3f) -> u32 {
    var index = ENVIRONMENT_NORMALS * ENVIRONMENT_NORMALS;
    if (any(normal != vec3f(0.0))) {
        // Octahedral map.
        let n = environment_from_world(normal);
        let above = n.xy / (abs(n.x) + abs(n.y) + abs(n.z));
        let below = (1.0 - abs(above.yx)) * select(vec2f(-1.0), vec2f(1.0), above >= vec2f(0.0));
        let p = 0.5 + 0.5 * select(above, below, n.z < 0.0);
        let cell = min(vec2u(max(p * f32(ENVIRONMENT_NORMALS), vec2f(0.0))), vec2u(ENVIRONMENT_NORMALS - 1u));
        index = cell.y * ENVIRONMENT_NORMALS + cell.x;
    }
    return grid.tables + index * (grid.blocks.y + 2u * grid.blocks.x * grid.blocks.y);
}

// The probability with which environment_choose, for a normal, chooses the block that a cell is in.
fn environment_block_probability(cell: vec2u, normal: vec3f) -> f32 {
    let grid = environment_grid();
    let block = cell >> grid.shift;
    let first = environment_table(grid, normal) + grid.blocks.y + grid.blocks.x * grid.blocks.y;
    return bitcast<f32>(load_environment_cdf(first + block.y * grid.blocks.x + block.x));
}

// A cell for a surface with a normal, or for light from all sides if it is null. Columns and rows rise with the
// numbers that choose them, so that well-spread points stay so.
fn environment_choose(bits: vec2u, normal: vec3f) -> EnvironmentPoint {
    let grid = environment_grid();
    // Fills in what a rare block, row or column lacks.
    var more = bits.yx * 747796405u;
    let table = environment_table(grid, normal);
    let block_row = environment_invert(table, grid.blocks.y, vec2u(0u, grid.blocks.y - 1u), bits.y, more.y);
    let blocks = table + grid.blocks.y + block_row.index * grid.blocks.x;
    let block_column = environment_invert(blocks, grid.blocks.x, vec2u(0u, grid.blocks.x - 1u), bits.x, more.x);
    let block = vec2u(block_column.index, block_row.index);
    let first = block << grid.shift;
    let count = min(vec2u(1u) << grid.shift, grid.cells - first);

    more = more * 747796405u + 2891336453u;
    let lengths = environment_guide_lengths(grid.guide_bits);
    let row_guide = grid.row_guides + (block.x * grid.blocks.y + block.y) * lengths.y;
    let row_range = environment_guided(row_guide, grid.guide_bits.y, block_row.number);
    let rows = grid.row_ends + block.x * grid.cells.y + first.y;
    let row = environment_invert(rows, count.y, row_range, block_row.number, more.y);

    let y = first.y + row.index;
    let cell_guide = grid.cell_guides + (y * grid.blocks.x + block.x) * lengths.x;
    let cell_range = environment_guided(cell_guide, grid.guide_bits.x, block_column.number);
    let cells = y * grid.cells.x + first.x;
    let column = environment_invert(cells, count.x, cell_range, block_column.number, more.x);
    let inside = vec2f(unit_float(column.number), unit_float(row.number));
    return EnvironmentPoint(vec2u(first.x + column.index, y), inside);
}

struct EnvironmentInterval {
    index: u32,
    // Where in the interval, as a number of 32 bits.
    number: u32,
}

// The first and the last interval that may hold a number, by a guide.
fn environment_guided(guide: u32, bits: u32, number: u32) -> vec2u {
    let entry = guide + ((number >> 1u) >> (31u - bits));
    return vec2u(load_environment_cdf(entry), load_environment_cdf(entry + 1u));
}

// Inverts a cumulative distribution of `count` intervals, whose lower ends are the words from `first` on, in 2^-31:
// finds the one that holds a number of 32 bits, in a range of them. An empty one is never found.
fn environment_invert(first: u32, count: u32, range: vec2u, number: u32, more: u32) -> EnvironmentInterval {
    let half = number >> 1u;
    var index = range.x;
    var last = range.y;
    while (index < last) {
        if (count_step()) {
            break;
        }
        let middle = (index + last + 1u) / 2u;
        let above = load_environment_cdf(first + middle) <= half;
        index = select(index, middle, above);
        last = select(middle - 1u, last, above);
    }
    let lower = load_environment_cdf(first + index);
    var upper = 0x80000000u;
    if (index + 1u < count) {
        upper = load_environment_cdf(first + index + 1u);
    }
    return EnvironmentInterval(index, renewed(half, lower, upper - lower, more));
}
