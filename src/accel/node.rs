//! The node, as the device reads it.

use crate::geometry::Aabb;
use bytemuck::{Pod, Zeroable};
use glam::Vec3;

/// An inner node: the boxes of its two children and where they are. 64 bytes.
///
/// A child is a node (`count` 0, `left` or `right` its index), a leaf (`count` > 0, `left` or
/// `right` its first triangle in the tree's order), or absent (both 0, and an inverted box, which
/// no ray hits). Boxes are padded, see [`Aabb::padded`].
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct BvhNode {
    /// Box of the left child, metres.
    pub left_min: [f32; 3],
    /// Node index or first triangle of the left child.
    pub left: u32,
    /// Box of the left child, metres.
    pub left_max: [f32; 3],
    /// Triangles in the left child if it is a leaf, else 0.
    pub left_count: u32,
    /// Box of the right child, metres.
    pub right_min: [f32; 3],
    /// Node index or first triangle of the right child.
    pub right: u32,
    /// Box of the right child, metres.
    pub right_max: [f32; 3],
    /// Triangles in the right child if it is a leaf, else 0.
    pub right_count: u32,
}

/// One side of a node, unpacked.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Child {
    /// Padded box in a node; exact box while building.
    pub bounds: Aabb,
    /// Node index or first triangle.
    pub index: u32,
    /// Triangles of a leaf, else 0.
    pub count: u32,
}

impl Child {
    /// No child.
    pub const ABSENT: Child = Child {
        bounds: Aabb::EMPTY,
        index: 0,
        count: 0,
    };

    /// The root cannot be a child, so index 0 is free to mean that there is none.
    pub fn is_absent(&self) -> bool {
        self.count == 0 && self.index == 0
    }

    /// Whether it is a node.
    pub fn is_inner(&self) -> bool {
        self.count == 0 && self.index != 0
    }

    /// The index of the node that it is.
    pub fn inner_index(&self) -> Option<usize> {
        self.is_inner().then_some(self.index as usize)
    }
}

impl BvhNode {
    /// A node without children.
    pub(super) fn empty() -> BvhNode {
        BvhNode::new(Child::ABSENT, Child::ABSENT)
    }

    /// Puts two children with exact boxes together; pads the boxes.
    pub(super) fn new(left: Child, right: Child) -> BvhNode {
        let (a, b) = (left.bounds.padded(), right.bounds.padded());
        BvhNode {
            left_min: a.min.to_array(),
            left: left.index,
            left_max: a.max.to_array(),
            left_count: left.count,
            right_min: b.min.to_array(),
            right: right.index,
            right_max: b.max.to_array(),
            right_count: right.count,
        }
    }

    /// Left, right.
    pub(super) fn children(&self) -> [Child; 2] {
        [
            Child {
                bounds: bounds(self.left_min, self.left_max),
                index: self.left,
                count: self.left_count,
            },
            Child {
                bounds: bounds(self.right_min, self.right_max),
                index: self.right,
                count: self.right_count,
            },
        ]
    }
}

fn bounds(min: [f32; 3], max: [f32; 3]) -> Aabb {
    Aabb {
        min: Vec3::from_array(min),
        max: Vec3::from_array(max),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn is_64_bytes_without_padding() {
        assert_eq!(size_of::<BvhNode>(), 64);
        assert_eq!(std::mem::offset_of!(BvhNode, right_min), 32);
    }

    #[test]
    fn absent_children_have_the_agreed_form() {
        let node = BvhNode::empty();
        assert_eq!(node.left_min, [f32::MAX; 3]);
        assert_eq!(node.right_max, [f32::MIN; 3]);
        assert!(node.children().iter().all(Child::is_absent));
    }
}
