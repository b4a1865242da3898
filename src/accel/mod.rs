//! The acceleration structure: pairs of triangles, below nodes of up to eight children or, where there
//! are few of them, in a plain list.
//!
//! [`Bvh::build`] matches triangles into pairs ([`pair`]), builds a binary tree over them
//! ([`binary`]) and collapses it into wide nodes with boxes of 8 bits a coordinate ([`element`]).
//! [`Bvh::validate`] proves its structure, [`Bvh::sah_cost`] rates it, and [`Bvh::intersect`] and
//! [`Bvh::occluded`] are the oracle of `shaders/accel/bvh.wgsl` and `shaders/accel/list.wgsl`, which
//! do the same operations in the same order.
//!
//! Where instances share geometry, [`Bvh::build_two_level`] puts trees in spaces of their own below a tree over the
//! world ([`Placement`], [`TwoLevel`]); `shaders/accel/instances.wgsl` traverses it.

pub mod binary;
mod cost;
pub mod element;
mod instance;
mod list;
pub mod pair;
mod primitive;
mod traverse;
mod two_level;
mod validate;
mod validate_two_level;
mod wide;

pub use binary::Preset;
pub use element::Element;
pub use instance::{INSTANCE_FLAG, Instance, Placement, Tree};
pub use primitive::Primitive;
pub use traverse::{FAR_SLACK, Hit, Steps};
pub use two_level::{TooManyNumbers, TwoLevel};
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
    /// Which meshes' instances share geometry; for whoever decides what [`Bvh::build_two_level`] is given.
    pub instancing: Instancing,
}

/// Which meshes' instances share geometry.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Instancing {
    /// Those for which it saves much memory.
    #[default]
    Auto,
    /// None: each instance has its own copy.
    Never,
    /// All that can: for tests and measurements.
    Always,
}

impl Instancing {
    /// Its name: `auto`, `never` or `always`.
    pub fn name(self) -> &'static str {
        match self {
            Instancing::Auto => "auto",
            Instancing::Never => "never",
            Instancing::Always => "always",
        }
    }
}

impl std::fmt::Display for Instancing {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        f.write_str(self.name())
    }
}

impl std::str::FromStr for Instancing {
    type Err = String;

    fn from_str(name: &str) -> Result<Instancing, String> {
        let all = [Instancing::Auto, Instancing::Never, Instancing::Always];
        crate::host::names::find(&all, Instancing::name, name)
    }
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
            instancing: Instancing::default(),
        }
    }
}

/// A bounding volume hierarchy over triangles, or a list of them.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Bvh {
    /// A tree's nodes and pairs; element 0 is the root, a node; a node comes before its children.
    pub elements: Vec<Element>,
    /// The triangles in the order of the tree; of two levels, those of the world, then those of each tree.
    pub order: Vec<Placed>,
    /// Stack entries that a traversal needs: the nodes on the longest way down. 0 for a list: all
    /// elements are pairs, each to be tested by every ray.
    pub depth: u32,
    /// Trees that instances share; none unless the structure has two levels.
    pub trees: Vec<Tree>,
    /// The instances, in the order of their numbers.
    pub instances: Vec<Instance>,
    /// With instances: rays start no farther from the world's origin than √3 times this, metres.
    pub reach: f32,
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

    /// Whether instances share trees.
    pub fn has_instances(&self) -> bool {
        !self.instances.is_empty()
    }

    /// Position in [`Bvh::order`] of the triangle of a hit.
    pub fn position(&self, id: u32) -> usize {
        let (element, _) = self.resolve(id);
        self.elements[element as usize].first_triangle() as usize + (id & 1) as usize
    }
}
