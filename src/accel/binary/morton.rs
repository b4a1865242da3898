//! Along a space-filling curve: neighbours on it are near each other in space (Morton 1966).

use super::super::primitive::{Primitive, fold_slices};
use super::boxes::{Box4, Node4, bounds};
use super::radix;
use glam::Vec4;
use rayon::prelude::*;

/// Bits of a code an axis.
const BITS: u32 = 12;

/// The low bits of a key hold a position, the high ones the code.
const POSITION_BITS: u32 = 28;

/// Runs of more equal codes than this are sorted by finer ones.
const LONGEST_RUN: usize = 4;

/// Leaves over primitives, multiplied by a factor, in the order of the Morton codes of their
/// centroids.
pub(super) fn sorted_leaves(primitives: &[Primitive], scale: f32) -> Vec<Node4> {
    let leaf = |primitive: &Primitive| Node4::scaled(primitive, scale);
    let add =
        |sum: &mut Box4, primitive: &Primitive| *sum = sum.with_point(leaf(primitive).centroid());
    let grid = Grid::new(fold_slices(primitives, || Box4::EMPTY, add, Box4::union));
    let key = |(i, primitive)| grid.key(&leaf(primitive), i);
    let keys: Vec<u64> = primitives.par_iter().enumerate().map(key).collect();
    let keys = radix::sort(keys, POSITION_BITS, POSITION_BITS + 3 * BITS);
    let sorted = keys.par_iter().map(|&key| leaf(&primitives[position(key)]));
    let mut sorted: Vec<Node4> = sorted.collect();
    refine(&keys, &mut sorted);
    sorted
}

/// Sorts runs of equal codes by codes on a grid of their own, as deep as it takes.
fn refine(keys: &[u64], sorted: &mut [Node4]) {
    let mut first = 0;
    for run in keys.chunk_by(|a, b| a >> POSITION_BITS == b >> POSITION_BITS) {
        if run.len() > LONGEST_RUN {
            sort_run(&mut sorted[first..first + run.len()]);
        }
        first += run.len();
    }
}

fn sort_run(nodes: &mut [Node4]) {
    let grid = Grid::new(bounds(nodes)[1]);
    if grid.scale == 0.0 {
        return;
    }
    let copy = nodes.to_vec();
    let keyed = copy.iter().enumerate().map(|(i, node)| grid.key(node, i));
    let mut keys: Vec<u64> = keyed.collect();
    keys.sort_unstable();
    for (node, &key) in nodes.iter_mut().zip(&keys) {
        *node = copy[position(key)];
    }
    // At least two codes differ, since both ends of the grid are taken: each run is shorter.
    refine(&keys, nodes);
}

fn position(key: u64) -> usize {
    (key & ((1 << POSITION_BITS) - 1)) as usize
}

/// Cubes around all centroids.
struct Grid {
    origin: Vec4,
    /// Cubes a metre; 0 if all centroids are equal.
    scale: f32,
}

impl Grid {
    fn new(centroids: Box4) -> Grid {
        let longest = centroids.size().truncate().max_element();
        let cubes = (1u32 << BITS) as f32;
        // Too small to tell apart counts as equal: runs of equal codes would not get shorter.
        let scale = cubes / longest;
        let scale = if scale.is_finite() { scale } else { 0.0 };
        Grid {
            origin: centroids.lo,
            scale,
        }
    }

    fn key(&self, node: &Node4, position: usize) -> u64 {
        let cell = (node.centroid() - self.origin) * self.scale;
        let most = (1u32 << BITS) - 1;
        let [x, y, z, _] = cell.to_array().map(|x| u64::from((x as u32).min(most)));
        let code = spread(x) << 2 | spread(y) << 1 | spread(z);
        code << POSITION_BITS | position as u64
    }
}

/// Moves bit i, of 12, to 3 i.
fn spread(x: u64) -> u64 {
    let x = (x | x << 16) & 0xff00_00ff;
    let x = (x | x << 8) & 0xf0_0f00_f00f;
    let x = (x | x << 4) & 0xc30_c30c_30c3;
    (x | x << 2) & 0x2492_4924_9249
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bits_are_spread_by_three() {
        for i in 0..BITS {
            assert_eq!(spread(1 << i), 1 << (3 * i), "bit {i}");
        }
        assert_eq!(spread(0xfff), 0x2_4924_9249);
    }
}
