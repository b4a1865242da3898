//! Boxes in SIMD registers, which the builders work on.

use super::super::primitive::{Primitive, fold_slices};
use super::BinaryNode;
use crate::geometry::Aabb;
use glam::Vec4;
use rayon::prelude::*;

/// A box in two registers; the fourth components mean nothing here.
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

    /// Half the sides: they cannot overflow.
    pub fn half_size(self) -> Vec4 {
        self.hi * 0.5 - self.lo * 0.5
    }

    /// A number proportional to the surface; `scale` from [`Box4::area_scale`] of a box around it.
    pub fn scaled_area(self, scale: f32) -> f32 {
        let [x, y, z, _] = (self.half_size() * scale).to_array();
        x * y + y * z + z * x
    }

    /// What brings the longest side near 1, so that areas of boxes within do not overflow.
    pub fn area_scale(self) -> f32 {
        let [x, y, z, _] = self.half_size().to_array();
        (1.0 / x.max(y).max(z)).min(f32::MAX)
    }

    pub fn aabb(self) -> Aabb {
        Aabb {
            min: self.lo.truncate(),
            max: self.hi.truncate(),
        }
    }
}

/// A primitive in two registers: the fourth component of `lo` holds the bits of its index.
#[derive(Debug, Clone, Copy)]
pub(super) struct Item(pub Box4);

impl Item {
    pub fn new(primitive: &Primitive) -> Item {
        // Adding 0 turns -0 into +0, so that no minimum depends on the order of its arguments.
        let bounds = primitive.bounds;
        let mut lo = bounds.min.extend(0.0) + 0.0;
        lo.w = f32::from_bits(primitive.index);
        let hi = bounds.max.extend(0.0) + 0.0;
        Item(Box4 { lo, hi })
    }

    pub fn index(&self) -> u32 {
        self.0.lo.w.to_bits()
    }

    /// The middle; the fourth component means nothing.
    pub fn centroid(&self) -> Vec4 {
        self.0.lo * 0.5 + self.0.hi * 0.5
    }

    pub fn leaf(&self) -> BinaryNode {
        BinaryNode {
            bounds: self.0.aabb(),
            index: self.index(),
            leaves: 1,
        }
    }
}

/// In the order of the input.
pub(super) fn items(primitives: &[Primitive]) -> Vec<Item> {
    primitives.par_iter().map(Item::new).collect()
}

/// The bounds of all boxes, and of all centroids.
pub(super) fn bounds(items: &[Item]) -> [Box4; 2] {
    let add = |sum: &mut [Box4; 2], item: &Item| {
        let centroid = item.centroid();
        sum[0] = sum[0].union(item.0);
        sum[1].lo = sum[1].lo.min(centroid);
        sum[1].hi = sum[1].hi.max(centroid);
    };
    let merge = |a: [Box4; 2], b: [Box4; 2]| [a[0].union(b[0]), a[1].union(b[1])];
    fold_slices(items, || [Box4::EMPTY; 2], add, merge)
}
