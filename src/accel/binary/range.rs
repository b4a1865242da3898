//! Boxes of any finite size, brought to where areas are ordinary f32 numbers.

use super::super::primitive::{Primitive, bounds};
use super::boxes::Node4;
use super::{BinaryNode, BinaryTree};
use rayon::prelude::*;

/// A power of two by which all boxes are multiplied before, so that neither sums of coordinates
/// nor products of areas and counts overflow, and areas of parts of the scene do not vanish.
/// Nearly always 1.
pub(super) fn scale(primitives: &[Primitive]) -> f32 {
    let all = bounds(primitives);
    let largest = all.min.abs().max(all.max.abs()).max_element();
    let size = (all.max * 0.5 - all.min * 0.5).max_element();
    if largest > 2f32.powi(40) {
        2f32.powi(40 - exponent(largest))
    } else if size < 2f32.powi(-20) && size > 0.0 {
        // Not so far that a scene far away from the origin gets too large.
        2f32.powi(
            (-20 - exponent(size))
                .min(40 - exponent(largest))
                .clamp(0, 120),
        )
    } else {
        1.0
    }
}

fn exponent(x: f32) -> i32 {
    x.log2().ceil() as i32
}

/// Leaves over the scaled boxes, in the order of the input.
pub(super) fn leaves(primitives: &[Primitive], scale: f32) -> Vec<Node4> {
    let leaf = |primitive| Node4::scaled(primitive, scale);
    primitives.par_iter().map(leaf).collect()
}

/// Puts exact bounds in place of scaled ones, which may have lost bits.
pub(super) fn restore(tree: &mut BinaryTree, primitives: &[Primitive]) {
    let largest = primitives.iter().map(|p| p.index as usize).max();
    let mut boxes = vec![None; largest.map_or(0, |i| i + 1)];
    for p in primitives {
        boxes[p.index as usize] = Some(p.bounds);
    }
    // Children come after their parents.
    for i in (0..tree.nodes.len()).rev() {
        let BinaryNode { bounds, index, .. } = tree.nodes[i];
        let first = index as usize;
        tree.nodes[i].bounds = if tree.nodes[i].is_leaf() {
            boxes[first].unwrap_or(bounds)
        } else {
            tree.nodes[first].bounds.union(tree.nodes[first + 1].bounds)
        };
    }
}
