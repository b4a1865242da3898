//! The proof that a binary tree is one.

use super::super::primitive::Primitive;
use super::{BinaryNode, BinaryTree, MAX_BINARY_DEPTH};
use crate::geometry::Aabb;
use thiserror::Error;

/// What is wrong with a tree; `node` is an index into [`BinaryTree::nodes`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
#[allow(missing_docs)] // The messages say what the fields are.
pub enum BinaryError {
    #[error("the tree has {nodes} nodes over {boxes} boxes")]
    Nodes { nodes: usize, boxes: usize },
    #[error("node {node}: its children, {index} and the next, are not where they belong")]
    Children { node: usize, index: u32 },
    #[error("node {node}: it counts {leaves} leaves, but its children do not")]
    Leaves { node: usize, leaves: u32 },
    #[error("node {node}: no box has the index {index}, or another leaf holds it")]
    Box { node: usize, index: u32 },
    #[error("node {node}: its bounds are not those of what is below")]
    Bounds { node: usize },
    #[error(
        "the tree says that it is {depth} deep, but it is {found} (at most {MAX_BINARY_DEPTH})"
    )]
    Depth { depth: u32, found: u32 },
}

impl BinaryTree {
    /// Checks all that is said of a tree, in O(n). `primitives` are those that it was built of;
    /// their indices are below their number.
    ///
    /// # Errors
    /// The first thing that is wrong.
    pub fn validate(&self, primitives: &[Primitive]) -> Result<(), BinaryError> {
        let (nodes, boxes) = (self.nodes.len(), primitives.len());
        if nodes != (2 * boxes).saturating_sub(1) {
            return Err(BinaryError::Nodes { nodes, boxes });
        }
        let levels = self.levels()?;
        let found = levels.iter().copied().max().unwrap_or(0);
        if found != self.depth || found > MAX_BINARY_DEPTH {
            let depth = self.depth;
            return Err(BinaryError::Depth { depth, found });
        }
        self.check_leaves(primitives)?;
        for (i, node) in self.nodes.iter().enumerate() {
            self.check_inner(i, node)?;
        }
        Ok(())
    }

    /// Inner nodes above each node; proves that the nodes stand in the promised order, and so that
    /// each is a child once.
    fn levels(&self) -> Result<Vec<u32>, BinaryError> {
        let mut levels = vec![0; self.nodes.len()];
        // The index that the children of a node must have: known from its parent on.
        let mut first_below = vec![1; self.nodes.len()];
        for (node, inner) in self.nodes.iter().enumerate() {
            let &BinaryNode { index, leaves, .. } = inner;
            if inner.is_leaf() {
                continue;
            }
            let first = index as usize;
            let fits = first == first_below[node] && first + 1 < self.nodes.len();
            if !fits || leaves == 0 {
                return Err(BinaryError::Children { node, index });
            }
            let left_leaves = self.nodes[first].leaves as usize;
            first_below[first] = first + 2;
            first_below[first + 1] = first + 2 * left_leaves;
            let level = levels[node] + 1;
            levels[first..first + 2].fill(level);
        }
        Ok(levels)
    }

    fn check_leaves(&self, primitives: &[Primitive]) -> Result<(), BinaryError> {
        let mut boxes = vec![None; primitives.len()];
        for p in primitives {
            boxes[p.index as usize] = Some(p.bounds);
        }
        let leaves = self.nodes.iter().enumerate().filter(|(_, n)| n.is_leaf());
        for (node, &BinaryNode { bounds, index, .. }) in leaves {
            match boxes.get_mut(index as usize).and_then(Option::take) {
                None => return Err(BinaryError::Box { node, index }),
                Some(own) if own != bounds => return Err(BinaryError::Bounds { node }),
                Some(_) => {}
            }
        }
        Ok(())
    }

    fn check_inner(&self, node: usize, inner: &BinaryNode) -> Result<(), BinaryError> {
        if inner.is_leaf() {
            return Ok(());
        }
        let first = inner.index as usize;
        let [a, b] = [self.nodes[first], self.nodes[first + 1]];
        let leaves = inner.leaves;
        if u64::from(leaves) != u64::from(a.leaves) + u64::from(b.leaves) {
            return Err(BinaryError::Leaves { node, leaves });
        }
        let bounds: Aabb = a.bounds.union(b.bounds);
        if bounds != inner.bounds {
            return Err(BinaryError::Bounds { node });
        }
        Ok(())
    }
}
