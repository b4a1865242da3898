//! The order of nodes that a [`BinaryTree`] promises, and its depth.

use super::boxes::{Box4, Node4};
use super::ploc::levels_of_even_splits;
use super::{BinaryNode, BinaryTree, MAX_BINARY_DEPTH};
use rayon::prelude::*;

/// Smaller subtrees, in leaves, are placed by one thread.
const PARALLEL_LIMIT: u32 = 4096;

/// Puts the nodes of a tree, of which the first is the root and siblings are neighbours, in order.
/// Where a way down is too long for the depth that is allowed, the subtree is split evenly instead.
pub(super) fn place(nodes: &[Node4]) -> BinaryTree {
    // Filled by all threads, since the first touch of memory takes time.
    let mut placed: Vec<BinaryNode> =
        rayon::iter::repeat_n(BinaryNode::VOID, nodes.len()).collect();
    let Some((own, below)) = placed.split_first_mut() else {
        return BinaryTree {
            nodes: placed,
            depth: 0,
        };
    };
    let subtree = Subtree {
        root: nodes[0],
        own,
        below,
        first: 1,
        level: 0,
    };
    let depth = subtree.place(nodes);
    BinaryTree {
        nodes: placed,
        depth,
    }
}

struct Subtree<'a> {
    root: Node4,
    /// Room for its root.
    own: &'a mut BinaryNode,
    /// Room for the nodes below it.
    below: &'a mut [BinaryNode],
    /// Index of the first of these.
    first: u32,
    /// Inner nodes above the root.
    level: u32,
}

impl<'a> Subtree<'a> {
    /// Gives the inner nodes on the longest way down from the root of all.
    fn place(self, nodes: &[Node4]) -> u32 {
        if self.root.is_leaf() {
            *self.own = self.root.node();
            return self.level;
        }
        let first = self.root.index() as usize;
        let children = [nodes[first], nodes[first + 1]];
        let needed =
            |child: &Node4| self.level + 1 + levels_of_even_splits(child.leaves() as usize);
        if children
            .iter()
            .any(|child| needed(child) > MAX_BINARY_DEPTH)
        {
            return self.place_evenly(nodes);
        }
        let root = self.root;
        let [left, right] = self.split(root.0, children);
        let (a, b) = if root.leaves() > PARALLEL_LIMIT {
            rayon::join(|| left.place(nodes), || right.place(nodes))
        } else {
            (left.place(nodes), right.place(nodes))
        };
        a.max(b)
    }

    /// Writes the root and shares out the room below.
    fn split(self, bounds: Box4, [left, right]: [Node4; 2]) -> [Subtree<'a>; 2] {
        *self.own = Node4::new(bounds, self.first, left.leaves() + right.leaves()).node();
        let (own, below) = self.below.split_at_mut(2);
        let (left_own, right_own) = own.split_at_mut(1);
        let (left_below, right_below) = below.split_at_mut(2 * (left.leaves() as usize - 1));
        let level = self.level + 1;
        [
            Subtree {
                root: left,
                own: &mut left_own[0],
                below: left_below,
                first: self.first + 2,
                level,
            },
            Subtree {
                root: right,
                own: &mut right_own[0],
                below: right_below,
                first: self.first + 2 * left.leaves(),
                level,
            },
        ]
    }

    fn place_evenly(self, nodes: &[Node4]) -> u32 {
        let mut leaves = Vec::with_capacity(self.root.leaves() as usize);
        let mut stack = vec![self.root];
        while let Some(node) = stack.pop() {
            if node.is_leaf() {
                leaves.push(node);
            } else {
                let first = node.index() as usize;
                stack.extend([nodes[first + 1], nodes[first]]);
            }
        }
        self.halve(&leaves)
    }

    fn halve(self, leaves: &[Node4]) -> u32 {
        if let [leaf] = leaves {
            *self.own = leaf.node();
            return self.level;
        }
        let (left, right) = leaves.split_at(leaves.len() / 2);
        let whole = |leaves: &[Node4]| {
            let bounds = leaves
                .iter()
                .fold(Box4::EMPTY, |sum, leaf| sum.union(leaf.0));
            Node4::new(bounds, 0, leaves.len() as u32)
        };
        let children = [whole(left), whole(right)];
        let [a, b] = self.split(children[0].0.union(children[1].0), children);
        a.halve(left).max(b.halve(right))
    }
}
