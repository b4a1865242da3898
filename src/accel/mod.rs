//! The acceleration structure: pairs of triangles, below nodes of up to eight children or, where there
//! are few of them, in a plain list.
//!
//! [`Bvh::build`] matches triangles into pairs ([`pair`]), builds a binary tree over them
//! ([`binary`]) and collapses it into wide nodes with boxes of 8 bits a coordinate ([`element`]).
//! [`Bvh::validate`] proves its structure, [`Bvh::sah_cost`] rates it, and [`Bvh::intersect`] and
//! [`Bvh::occluded`] are the oracle of `shaders/accel/bvh.wgsl` and `shaders/accel/list.wgsl`, which
//! do the same operations in the same order.

pub mod binary;
mod cost;
pub mod element;
mod list;
pub mod pair;
mod primitive;
mod traverse;
mod validate;
mod wide;

pub use binary::Preset;
pub use element::Element;
pub use primitive::Primitive;
pub use traverse::{FAR_SLACK, Hit, Steps};
pub use validate::BvhError;

/// Most stack entries that any tree of [`Bvh::build`] makes a traversal use.
pub const MAX_DEPTH: u32 = binary::MAX_BINARY_DEPTH + 1;

/// Most triangles in a tree: with no two of them in a pair, and a node for every pair at worst, its
/// elements can still be counted ([`element::MAX_ELEMENTS`]).
pub const MAX_TRIANGLES: usize = (1 << 27) - 1;

/// Most pairs of a scene that is a list by default. A list costs a ray the test of every pair, but
/// all lanes test the same one: no boxes, no stack, and one load for all.
pub const LIST_LIMIT: usize = 32;

/// What [`Bvh::build`] may be told.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct BuildOptions {
    /// How much time to take for a better tree.
    pub preset: Preset,
    /// Up to so many pairs are a list, more are a tree: with 0 it is always a tree. No triangles at
    /// all are a list in any case.
    pub list_limit: usize,
}

impl BuildOptions {
    /// A preset, and what is usual for all else.
    pub fn of(preset: Preset) -> Self {
        Self {
            preset,
            ..Self::default()
        }
    }
}

impl Default for BuildOptions {
    fn default() -> Self {
        Self {
            preset: Preset::default(),
            list_limit: LIST_LIMIT,
        }
    }
}

/// A bounding volume hierarchy over triangles, or a list of them.
#[derive(Debug, Clone, PartialEq)]
pub struct Bvh {
    /// A tree's nodes and pairs; element 0 is the root, a node; a node comes before its children.
    pub elements: Vec<Element>,
    /// The triangles in the order of the tree.
    pub order: Vec<Placed>,
    /// Stack entries that a traversal needs: the nodes on the longest way down. 0 for a list: all
    /// elements are pairs, each to be tested by every ray.
    pub depth: u32,
}

/// A triangle of the input and its place in the tree.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Placed {
    /// Its index in the input, and which of its vertices comes first in the tree.
    pub turned: pair::Turned,
    /// [`Hit::triangle`] of a hit on it.
    pub id: u32,
}

impl Placed {
    /// Fills room that is written to later.
    const VOID: Placed = Placed {
        turned: pair::Turned {
            triangle: 0,
            first: 0,
        },
        id: 0,
    };
}

impl Bvh {
    /// Whether all elements are pairs, each to be tested by every ray.
    pub fn is_list(&self) -> bool {
        self.depth == 0
    }

    /// Position in [`Bvh::order`] of the triangle of a hit.
    pub fn position(&self, id: u32) -> usize {
        self.elements[id as usize / 2].first_triangle() as usize + (id & 1) as usize
    }
}
