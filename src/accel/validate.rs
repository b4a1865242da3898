//! The proof that a tree is one that a traversal may trust: the device checks nothing.

use super::node::{BvhNode, Child};
use super::{Bvh, MAX_DEPTH, MAX_LEAF_SIZE, MAX_TRIANGLES};
use crate::geometry::Aabb;
use glam::Vec3;
use std::fmt;
use thiserror::Error;

/// Which child of a node.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// The first.
    Left,
    /// The second.
    Right,
}

impl fmt::Display for Side {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(match self {
            Side::Left => "left",
            Side::Right => "right",
        })
    }
}

/// What is wrong with a tree; `node` is an index into [`Bvh::nodes`].
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
    #[error("node {node}: its {side} child is node {child}, but there are {nodes}")]
    NodeIndex {
        node: usize,
        side: Side,
        child: u32,
        nodes: usize,
    },
    #[error(
        "node {node}: its {side} child is node {child}, which another way leads to as well (a cycle, or a shared child)"
    )]
    SharedNode { node: usize, side: Side, child: u32 },
    #[error("node {node} cannot be reached from the root")]
    Unreachable { node: usize },
    #[error("node {node}: its {side} child is absent, but its box is not the inverted one")]
    AbsentBox { node: usize, side: Side },
    #[error(
        "node {node}: its {side} leaf has triangles {first} to {first} + {count}, beyond the last, {triangles}"
    )]
    LeafRange {
        node: usize,
        side: Side,
        first: u32,
        count: u32,
        triangles: usize,
    },
    #[error("node {node}: its {side} leaf has {count} triangles, more than {MAX_LEAF_SIZE}")]
    LeafSize { node: usize, side: Side, count: u32 },
    #[error(
        "node {node}: its {side} leaf has the triangle at position {position}, which another leaf has too"
    )]
    TriangleTwice {
        node: usize,
        side: Side,
        position: u32,
    },
    #[error("no leaf has the triangle at position {position}")]
    TriangleMissing { position: usize },
    #[error("node {node}: the box of its {side} child does not contain all of its triangles")]
    Box { node: usize, side: Side },
    #[error(
        "the tree says that a traversal needs {depth} stack entries, but it needs {needed} (at most {MAX_DEPTH} are allowed)"
    )]
    Depth { depth: u32, needed: u32 },
}

const SIDES: [Side; 2] = [Side::Left, Side::Right];

/// The two children with their names.
fn sides(node: &BvhNode) -> impl Iterator<Item = (Side, Child)> {
    SIDES.into_iter().zip(node.children())
}

impl Bvh {
    /// Checks everything that a traversal relies on, in O(n): indices in range, no cycles, every
    /// triangle in exactly one leaf, every box around the exact bounds of its triangles, the depth.
    /// `triangles` are those that the tree was built of, in their own order.
    pub fn validate(&self, triangles: &[[Vec3; 3]]) -> Result<(), BvhError> {
        if self.nodes.is_empty() {
            return Err(BvhError::NoRoot);
        }
        self.check_order(triangles.len())?;
        self.check_leaves()?;
        let way = self.walk()?;
        self.check_depth(&way)?;
        self.check_boxes(&way, triangles)
    }

    fn check_order(&self, triangles: usize) -> Result<(), BvhError> {
        let order = self.order.len();
        if order != triangles {
            return Err(BvhError::OrderLength { order, triangles });
        }
        if triangles > MAX_TRIANGLES {
            return Err(BvhError::TooManyTriangles { triangles });
        }
        let mut seen = vec![false; triangles];
        for (position, &triangle) in self.order.iter().enumerate() {
            match seen.get_mut(triangle as usize) {
                Some(seen) if !*seen => *seen = true,
                _ => return Err(BvhError::Order { position, triangle }),
            }
        }
        Ok(())
    }

    fn check_leaves(&self) -> Result<(), BvhError> {
        let mut seen = vec![false; self.order.len()];
        for (node, children) in self.nodes.iter().map(sides).enumerate() {
            for (side, child) in children.filter(|(_, child)| child.count > 0) {
                mark_leaf(&mut seen, node, side, &child)?;
            }
        }
        match seen.iter().position(|seen| !seen) {
            Some(position) => Err(BvhError::TriangleMissing { position }),
            None => Ok(()),
        }
    }

    /// All nodes, each after its parent, with their level (the root's is 1).
    fn walk(&self) -> Result<Vec<(usize, u32)>, BvhError> {
        let nodes = self.nodes.len();
        let mut seen = vec![false; nodes];
        seen[0] = true;
        let mut way = vec![(0, 1)];
        let mut next = 0;
        while let Some(&(node, level)) = way.get(next) {
            next += 1;
            for (side, child) in sides(&self.nodes[node]).filter(|(_, c)| c.is_inner()) {
                let child = child.index;
                match seen.get_mut(child as usize) {
                    None => {
                        return Err(BvhError::NodeIndex {
                            node,
                            side,
                            child,
                            nodes,
                        });
                    }
                    Some(true) => return Err(BvhError::SharedNode { node, side, child }),
                    Some(seen) => *seen = true,
                }
                way.push((child as usize, level + 1));
            }
        }
        match seen.iter().position(|seen| !seen) {
            Some(node) => Err(BvhError::Unreachable { node }),
            None => Ok(way),
        }
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
    fn check_boxes(&self, way: &[(usize, u32)], triangles: &[[Vec3; 3]]) -> Result<(), BvhError> {
        let mut exact = vec![Aabb::EMPTY; self.nodes.len()];
        for &(node, _) in way.iter().rev() {
            for (side, child) in sides(&self.nodes[node]) {
                let bounds = match child.inner_index() {
                    Some(index) => exact[index],
                    None => self.leaf_bounds(&child, triangles),
                };
                if child.is_absent() && child.bounds != Aabb::EMPTY {
                    return Err(BvhError::AbsentBox { node, side });
                }
                if !child.bounds.contains(&bounds) {
                    return Err(BvhError::Box { node, side });
                }
                exact[node] = exact[node].union(bounds);
            }
        }
        Ok(())
    }

    fn leaf_bounds(&self, leaf: &Child, triangles: &[[Vec3; 3]]) -> Aabb {
        let first = leaf.index as usize;
        let order = &self.order[first..first + leaf.count as usize];
        order.iter().fold(Aabb::EMPTY, |bounds, &triangle| {
            bounds.union(Aabb::from_points(&triangles[triangle as usize]))
        })
    }
}

fn mark_leaf(seen: &mut [bool], node: usize, side: Side, leaf: &Child) -> Result<(), BvhError> {
    let (first, count, triangles) = (leaf.index, leaf.count, seen.len());
    if count > MAX_LEAF_SIZE {
        return Err(BvhError::LeafSize { node, side, count });
    }
    for i in u64::from(first)..u64::from(first) + u64::from(count) {
        match seen.get_mut(i as usize) {
            None => {
                return Err(BvhError::LeafRange {
                    node,
                    side,
                    first,
                    count,
                    triangles,
                });
            }
            Some(true) => {
                let position = i as u32;
                return Err(BvhError::TriangleTwice {
                    node,
                    side,
                    position,
                });
            }
            Some(seen) => *seen = true,
        }
    }
    Ok(())
}
