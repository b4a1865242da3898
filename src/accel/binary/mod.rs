//! A binary tree over boxes, one box a leaf: what the builders make and the wide tree is made of.

mod boxes;
mod check;
mod collapse;
mod layout;
mod morton;
mod place_search;
mod ploc;
mod radix;
mod range;
mod reinsert;
mod sah;
mod sweep;

pub use check::BinaryError;
pub use collapse::{WIDTH, WideChildren, WideTopology};

use super::primitive::Primitive;
use crate::geometry::Aabb;
use crate::host::names;
use std::fmt;
use std::str::FromStr;

/// Most inner nodes on a way from the root to a leaf, in any tree of [`BinaryTree::build`].
pub const MAX_BINARY_DEPTH: u32 = 64;

/// How much time a build may take for a better tree.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Preset {
    /// The shortest build: neighbours along a space-filling curve are merged, and the largest
    /// subtrees are reinserted where they fit better.
    Fast,
    /// A better tree in about twice the time: the surface area heuristic over bins instead.
    #[default]
    Balanced,
    /// The best tree in about ten times as long: starts from that of [`Preset::Balanced`], which it
    /// only improves, and reinserts all subtrees until that gains little.
    Best,
}

impl Preset {
    /// All of them, the fastest first.
    pub const ALL: [Preset; 3] = [Preset::Fast, Preset::Balanced, Preset::Best];

    /// Its name: `fast`, `balanced` or `best`.
    pub fn name(self) -> &'static str {
        match self {
            Preset::Fast => "fast",
            Preset::Balanced => "balanced",
            Preset::Best => "best",
        }
    }
}

impl fmt::Display for Preset {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for Preset {
    type Err = String;

    fn from_str(name: &str) -> Result<Preset, String> {
        names::find(&Preset::ALL, Preset::name, name)
    }
}

/// A node of a [`BinaryTree`]. 32 bytes.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BinaryNode {
    /// Exact, not padded, metres.
    pub bounds: Aabb,
    /// Inner node: its children are the nodes `index` and `index + 1`. Leaf: its box's
    /// [`Primitive::index`].
    pub index: u32,
    /// Leaves below; 1 says that it is a leaf itself.
    pub leaves: u32,
}

impl BinaryNode {
    /// Fills room that is written to later.
    const VOID: BinaryNode = BinaryNode {
        bounds: Aabb::EMPTY,
        index: 0,
        leaves: 0,
    };

    /// Whether it holds a box instead of children.
    pub fn is_leaf(&self) -> bool {
        self.leaves == 1
    }
}

/// A binary tree over boxes, one box a leaf.
#[derive(Debug, Clone, PartialEq)]
pub struct BinaryTree {
    /// Node 0 is the root; then come its two children, then all nodes below the left one, then all
    /// below the right one, and so on down: siblings are neighbours, and the nodes below any node
    /// are. 2n - 1 nodes for n boxes; none for none.
    pub nodes: Vec<BinaryNode>,
    /// Inner nodes on the longest way from the root to a leaf, at most [`MAX_BINARY_DEPTH`].
    pub depth: u32,
}

impl BinaryTree {
    /// Builds a tree over boxes that are finite and not empty; at most [`super::MAX_TRIANGLES`],
    /// which the caller checks, and no index is larger than that.
    ///
    /// Parallel. The same boxes in the same order give the same tree, bit for bit, whatever the
    /// number of threads.
    pub fn build(primitives: &[Primitive], preset: Preset) -> BinaryTree {
        if primitives.is_empty() {
            return BinaryTree {
                nodes: vec![],
                depth: 0,
            };
        }
        let scale = range::scale(primitives);
        let mut nodes = match preset {
            Preset::Fast => ploc::build(morton::sorted_leaves(primitives, scale)),
            Preset::Balanced | Preset::Best => sah::build(range::leaves(primitives, scale)),
        };
        reinsert::improve(&mut nodes, preset);
        let mut tree = layout::place(&nodes);
        if scale != 1.0 {
            range::restore(&mut tree, primitives);
        }
        tree
    }

    /// Σ of the half areas of all inner nodes over that of the root: the inner nodes that a random
    /// long line through the root's box is expected to meet, the surface area heuristic. Leaves add
    /// the same to any tree over the same boxes. 0 for a root without area.
    pub fn cost(&self) -> f64 {
        let Some(root) = self.nodes.first() else {
            return 0.0;
        };
        let area = root.bounds.half_area();
        let inner = self.nodes.iter().filter(|node| !node.is_leaf());
        let sum: f64 = inner.map(|node| node.bounds.half_area()).sum();
        if area > 0.0 { sum / area } else { 0.0 }
    }
}
