//! Nodes in SIMD registers, which the builders work on.

use super::super::primitive::{Primitive, fold_slices};
use super::BinaryNode;
use crate::geometry::Aabb;
use glam::Vec4;
use rayon::prelude::*;

/// A box in two registers; what the fourth components mean is up to its owner.
#[derive(Debug, Clone, Copy)]
pub(super) struct Box4 {
    pub lo: Vec4,
    pub hi: Vec4,
}

impl Box4 {
    pub const EMPTY: Box4 = Box4 {
        lo: Vec4::MAX,
        hi: Vec4::MIN,
    };

    pub fn union(self, other: Box4) -> Box4 {
        Box4 {
            lo: self.lo.min(other.lo),
            hi: self.hi.max(other.hi),
        }
    }

    pub fn with_point(self, point: Vec4) -> Box4 {
        Box4 {
            lo: self.lo.min(point),
            hi: self.hi.max(point),
        }
    }

    pub fn size(self) -> Vec4 {
        self.hi - self.lo
    }

    /// Half the surface. It overflows for the largest boxes, which [`super::range`] keeps away.
    pub fn area(self) -> f32 {
        let [x, y, z, _] = self.size().to_array();
        x * y + (y + x) * z
    }

    pub fn aabb(self) -> Aabb {
        Aabb {
            min: self.lo.truncate(),
            max: self.hi.truncate(),
        }
    }
}

/// Set in the numbers that ride in fourth components: arithmetic on these runs along, and it would
/// be slow if they looked like subnormal floats. The numbers stay below 2²⁹, far from the tag.
const TAG: u32 = 0x4000_0000;

/// A [`BinaryNode`] in two registers: the fourth components hold its index and its leaves.
#[derive(Debug, Clone, Copy)]
pub(super) struct Node4(pub Box4);

impl Node4 {
    /// Fills room that is written to later.
    pub const VOID: Node4 = Node4(Box4::EMPTY);

    pub fn new(bounds: Box4, index: u32, leaves: u32) -> Node4 {
        let Box4 { mut lo, mut hi } = bounds;
        lo.w = f32::from_bits(index | TAG);
        hi.w = f32::from_bits(leaves | TAG);
        Node4(Box4 { lo, hi })
    }

    /// A leaf whose box is multiplied by a factor.
    pub fn scaled(primitive: &Primitive, scale: f32) -> Node4 {
        // Adding 0 turns -0 into +0, so that no minimum depends on the order of its arguments.
        let Aabb { min, max } = primitive.bounds;
        let lo = min.extend(0.0) * scale + 0.0;
        let hi = max.extend(0.0) * scale + 0.0;
        Node4::new(Box4 { lo, hi }, primitive.index, 1)
    }

    /// As [`BinaryNode::index`].
    pub fn index(&self) -> u32 {
        self.0.lo.w.to_bits() & !TAG
    }

    /// As [`BinaryNode::leaves`].
    pub fn leaves(&self) -> u32 {
        self.0.hi.w.to_bits() & !TAG
    }

    pub fn is_leaf(&self) -> bool {
        self.leaves() == 1
    }

    /// Twice the middle; the fourth component means nothing.
    pub fn centroid(&self) -> Vec4 {
        self.0.lo + self.0.hi
    }

    pub fn node(&self) -> BinaryNode {
        BinaryNode {
            bounds: self.0.aabb(),
            index: self.index(),
            leaves: self.leaves(),
        }
    }
}

/// Filled by all threads, since the first touch of memory takes time.
pub(super) fn void(n: usize) -> Vec<Node4> {
    rayon::iter::repeat_n(Node4::VOID, n).collect()
}

/// The bounds of all boxes, and of all centroids.
pub(super) fn bounds(nodes: &[Node4]) -> [Box4; 2] {
    let add = |sum: &mut [Box4; 2], node: &Node4| {
        sum[0] = sum[0].union(node.0);
        sum[1] = sum[1].with_point(node.centroid());
    };
    let merge = |a: [Box4; 2], b: [Box4; 2]| [a[0].union(b[0]), a[1].union(b[1])];
    fold_slices(nodes, || [Box4::EMPTY; 2], add, merge)
}
