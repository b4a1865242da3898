//! The bounding volume hierarchy: a binary tree whose nodes hold the boxes of both children.
//!
//! [`Bvh::build`] makes it (binned SAH, in parallel), [`Bvh::validate`] proves its structure,
//! [`Bvh::sah_cost`] rates it, and [`Bvh::intersect`] and [`Bvh::occluded`] are the oracle of
//! `shaders/accel/bvh.wgsl`, which does the same operations in the same order.

pub mod binary;
mod bins;
mod build;
mod cost;
mod node;
mod primitive;
mod traverse;
mod validate;

pub use binary::Preset;
pub use node::BvhNode;
pub use primitive::Primitive;
pub use traverse::{FAR_SLACK, Hit};
pub use validate::{BvhError, Side};

/// Most stack entries that any tree of [`Bvh::build`] makes a traversal use.
pub const MAX_DEPTH: u32 = 64;

/// Most triangles in a leaf: the shader's stack keeps a leaf's count in 4 bits.
pub const MAX_LEAF_SIZE: u32 = 15;

/// Most triangles in a tree: the shader's stack keeps a leaf's first triangle in 27 bits.
pub const MAX_TRIANGLES: usize = (1 << 27) - 1;

/// What [`Bvh::build`] may be told.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct BuildOptions {
    /// How much time the build may take for a better tree.
    pub preset: Preset,
    /// Most triangles in a leaf, 1 to [`MAX_LEAF_SIZE`]; others are taken as the nearest of these.
    pub max_leaf_size: u32,
    /// Bins an axis, 2 to 32; others are taken as the nearest of these.
    pub bins: usize,
}

impl Default for BuildOptions {
    fn default() -> BuildOptions {
        BuildOptions {
            preset: Preset::default(),
            max_leaf_size: 4,
            bins: 16,
        }
    }
}

/// A bounding volume hierarchy over triangles.
#[derive(Debug, Clone, PartialEq)]
pub struct Bvh {
    /// Node 0 is the root, a node comes before its children. There is always a root.
    pub nodes: Vec<BvhNode>,
    /// Position in the order of the leaves -> index of the triangle given to [`Bvh::build`].
    pub order: Vec<u32>,
    /// Stack entries that a traversal needs: the nodes on the longest way down.
    pub depth: u32,
}

impl Bvh {
    /// Copies a per-triangle array into the order of the leaves, which traversal expects.
    ///
    /// `items` has an entry for each triangle that the tree was built of.
    pub fn reorder<T: Copy>(&self, items: &[T]) -> Vec<T> {
        self.order.iter().map(|&i| items[i as usize]).collect()
    }
}
