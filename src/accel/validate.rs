//! The proof that a structure is one that a traversal may trust: the device checks nothing.

use super::element::Node;
use super::two_level::HEADER;
use super::{Bvh, MAX_DEPTH, MAX_TRIANGLES, Placed};
use crate::geometry::Aabb;
use glam::Vec3;
use thiserror::Error;

/// What is wrong with a tree; `node` is an index into [`Bvh::elements`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
#[allow(missing_docs)] // The messages say what the fields are.
pub enum BvhError {
    #[error("the tree has no root node")]
    NoRoot,
    #[error("the tree orders {order} triangles, but there are {triangles}")]
    OrderLength { order: usize, triangles: usize },
    #[error("the tree holds {triangles} triangles, more than {MAX_TRIANGLES}")]
    TooManyTriangles { triangles: usize },
    #[error(
        "position {position} of the order names triangle {triangle}, which is out of range or named before"
    )]
    Order { position: usize, triangle: u32 },
    #[error(
        "position {position} of the order names triangle {id} of the pairs, which is out of range, named before, or not that pair's"
    )]
    Place { position: usize, id: u32 },
    #[error("node {node}: its children are elements {first} to {last}, but there are {elements}")]
    Children {
        node: usize,
        first: u64,
        last: u64,
        elements: usize,
    },
    #[error("node {node}: {inner} of its {children} children are said to be nodes")]
    InnerCount {
        node: usize,
        inner: u32,
        children: u32,
    },
    #[error(
        "node {node}: its child {child} is also another's (a cycle, or a shared child), or the root"
    )]
    SharedChild { node: usize, child: u32 },
    #[error("element {element} cannot be reached from the root")]
    Unreachable { element: usize },
    #[error("pair {pair}: its vertices are not those of its triangles")]
    Vertices { pair: u32 },
    #[error(
        "node {node}: the box of its child {child} does not contain all of its triangles with the margins that a traversal needs"
    )]
    Box { node: usize, child: u32 },
    #[error(
        "the tree says that a traversal needs {depth} stack entries, but it needs {needed} (at most {MAX_DEPTH} are allowed)"
    )]
    Depth { depth: u32, needed: u32 },
    #[error("the upper level, the trees and the records of instances do not follow each other")]
    Sections,
    #[error(
        "instance {instance}: its leaf, its record, its number or its box does not fit its placement"
    )]
    Instance { instance: usize },
    #[error("the upper level has {leaves} instances, but there are {instances}")]
    InstanceCount { leaves: usize, instances: usize },
}

/// Nodes, each after its parent, with their levels.
type Way = Vec<(usize, u32)>;

/// What is known of an element.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Found {
    No,
    Node,
    Pair,
    Instance,
    Header,
}

impl Bvh {
    /// Checks everything that a traversal relies on, in O(n): indices in range, no cycles, every
    /// triangle in exactly one pair, every box around the padded bounds of its triangles with a margin,
    /// the depth; with instances each once, its box around its tree. `triangles` are those that it was built of, in
    /// their own order.
    pub fn validate(&self, triangles: &[[Vec3; 3]]) -> Result<(), BvhError> {
        match self.has_instances() {
            true => self.validate_two_level(triangles),
            false => self.validate_level(triangles),
        }
    }

    /// The same for a structure of one level, or for the upper one of two alone.
    pub(super) fn validate_level(&self, triangles: &[[Vec3; 3]]) -> Result<(), BvhError> {
        self.check_order(triangles)?;
        if self.is_list() {
            return self.check_list(triangles);
        }
        if self.elements.is_empty() {
            return Err(BvhError::NoRoot);
        }
        let (way, found) = self.walk()?;
        self.check_places(&found)?;
        self.check_depth(&way)?;
        self.check_instance_count(&found)?;
        self.check_boxes(&way, &found, triangles)
    }

    fn check_instance_count(&self, found: &[Found]) -> Result<(), BvhError> {
        let leaves = (0..found.len()).filter(|&leaf| found[leaf] == Found::Instance);
        let mut named: Vec<u32> = leaves.map(|leaf| self.elements[leaf].words[15]).collect();
        named.sort_unstable();
        named.dedup();
        let (leaves, instances) = (named.len(), self.instances.len());
        match leaves == instances {
            true => Ok(()),
            false => Err(BvhError::InstanceCount { leaves, instances }),
        }
    }

    fn check_list(&self, triangles: &[[Vec3; 3]]) -> Result<(), BvhError> {
        self.check_places(&vec![Found::Pair; self.elements.len()])?;
        let check = |pair| self.pair_bounds(pair as u32, triangles).map(|_| ());
        (0..self.elements.len()).try_for_each(check)
    }

    fn check_order(&self, triangles: &[[Vec3; 3]]) -> Result<(), BvhError> {
        let (order, triangles) = (self.order.len(), triangles.len());
        if order != triangles {
            return Err(BvhError::OrderLength { order, triangles });
        }
        if triangles > MAX_TRIANGLES {
            return Err(BvhError::TooManyTriangles { triangles });
        }
        let mut seen = vec![false; triangles];
        for (position, placed) in self.order.iter().enumerate() {
            let triangle = placed.turned.triangle;
            match seen.get_mut(triangle as usize) {
                Some(seen) if !*seen && placed.turned.first < 3 => *seen = true,
                _ => return Err(BvhError::Order { position, triangle }),
            }
        }
        Ok(())
    }

    /// All nodes, each after its parent, with their level (the root's is 1), and what each element is.
    fn walk(&self) -> Result<(Way, Vec<Found>), BvhError> {
        let elements = self.elements.len();
        let mut found = vec![Found::No; elements];
        found[0] = Found::Node;
        if self.has_instances() {
            found[HEADER] = Found::Header;
        }
        let mut way = vec![(0, 1)];
        let mut next = 0;
        while let Some(&(node, level)) = way.get(next) {
            next += 1;
            let decoded = self.elements[node].decode();
            check_children(node, &decoded, elements)?;
            for slot in 0..decoded.children {
                let child = decoded.first + slot;
                let kind = &mut found[child as usize];
                if *kind != Found::No {
                    return Err(BvhError::SharedChild { node, child });
                }
                let is_instance =
                    self.has_instances() && self.elements[child as usize].is_instance();
                *kind = if is_instance {
                    Found::Instance
                } else {
                    Found::Pair
                };
                if slot < decoded.inner {
                    *kind = Found::Node;
                    way.push((child as usize, level + 1));
                }
            }
        }
        match found.iter().position(|&kind| kind == Found::No) {
            Some(element) => Err(BvhError::Unreachable { element }),
            None => Ok((way, found)),
        }
    }

    /// Every triangle's number leads to a pair, which leads back.
    fn check_places(&self, found: &[Found]) -> Result<(), BvhError> {
        for (position, &Placed { id, .. }) in self.order.iter().enumerate() {
            let is_pair = found.get(id as usize / 2) == Some(&Found::Pair);
            if !is_pair || self.position(id) != position {
                return Err(BvhError::Place { position, id });
            }
        }
        Ok(())
    }

    fn check_depth(&self, way: &[(usize, u32)]) -> Result<(), BvhError> {
        let needed = way.iter().map(|&(_, level)| level).max().unwrap_or(0);
        let depth = self.depth;
        if depth != needed || needed > MAX_DEPTH {
            return Err(BvhError::Depth { depth, needed });
        }
        Ok(())
    }

    /// Goes up from the leaves: children come after their parents on the way.
    fn check_boxes(
        &self,
        way: &[(usize, u32)],
        found: &[Found],
        triangles: &[[Vec3; 3]],
    ) -> Result<(), BvhError> {
        let mut exact = vec![Aabb::EMPTY; self.elements.len()];
        for &(node, _) in way.iter().rev() {
            let decoded = self.elements[node].decode();
            for slot in 0..decoded.children {
                let child = decoded.first + slot;
                if slot >= decoded.inner {
                    exact[child as usize] = match found[child as usize] {
                        Found::Instance => self.instance_bounds(child as usize)?,
                        _ => self.pair_bounds(child, triangles)?,
                    };
                }
                let bounds = exact[child as usize];
                if !decoded.holds(slot as usize, &bounds.padded()) {
                    return Err(BvhError::Box { node, child });
                }
                exact[node] = exact[node].union(bounds);
            }
        }
        Ok(())
    }

    /// The exact bounds of a pair's triangles, whose vertices must be those of the input.
    fn pair_bounds(&self, pair: u32, triangles: &[[Vec3; 3]]) -> Result<Aabb, BvhError> {
        let element = &self.elements[pair as usize];
        let mut bounds = Aabb::EMPTY;
        for (slot, held) in element.triangles().into_iter().enumerate() {
            let is_right = match self.placed(pair, slot) {
                Some(Placed { turned, .. }) => {
                    held == turned.corners(triangles[turned.triangle as usize])
                }
                // Where no second triangle is, nothing that a ray can hit may be.
                None => slot == 1 && held[2] == held[0],
            };
            if !is_right {
                return Err(BvhError::Vertices { pair });
            }
            bounds = bounds.union(Aabb::from_points(&held));
        }
        Ok(bounds)
    }

    /// The triangle that is said to be in a pair's first or second place.
    fn placed(&self, pair: u32, slot: usize) -> Option<&Placed> {
        let first = self.elements[pair as usize].first_triangle() as usize;
        let placed = self.order.get(first + slot);
        placed.filter(|placed| placed.id as usize == 2 * pair as usize + slot)
    }
}

fn check_children(node: usize, decoded: &Node, elements: usize) -> Result<(), BvhError> {
    let Node {
        children,
        inner,
        first,
        ..
    } = *decoded;
    if inner > children {
        return Err(BvhError::InnerCount {
            node,
            inner,
            children,
        });
    }
    let last = u64::from(first) + u64::from(children) - 1;
    if last >= elements as u64 {
        return Err(BvhError::Children {
            node,
            first: u64::from(first),
            last,
            elements,
        });
    }
    Ok(())
}
