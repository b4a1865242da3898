//! From the binary tree to nodes of up to eight children: which nodes to leave out, so that the
//! surface area heuristic is least. Dynamic programming after Ylitie, Karras and Laine, *Efficient
//! Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs*, 2017, section 3, without its
//! choice of leaves, since a leaf here is one box in any case.

use super::{BinaryNode, BinaryTree};
use rayon::prelude::*;

/// Most children of a wide node.
pub const WIDTH: usize = 8;

/// Smaller subtrees than this, in leaves, are worked on by one thread.
const PARALLEL_LIMIT: u32 = 4096;

/// Subtrees of no more leaves than this are emitted as one piece.
const EMIT_LIMIT: u32 = 1 << 13;

/// Which nodes of a binary tree become the children of which wide node.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct WideTopology {
    /// Node 0 is the root; a node comes before its children. There is always a root.
    pub nodes: Vec<WideChildren>,
    /// Wide nodes on the longest way down.
    pub depth: u32,
}

/// The children of a wide node.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct WideChildren {
    /// Their indices in [`BinaryTree::nodes`]; the first `count` count.
    children: [u32; WIDTH],
    /// 1 to 8; 0 in the root of an empty tree.
    count: u32,
    /// Those among the children that are not leaves are the wide nodes `first_inner`,
    /// `first_inner + 1` and so on, in their order.
    pub first_inner: u32,
}

impl WideChildren {
    /// Indices in [`BinaryTree::nodes`], at most [`WIDTH`].
    pub fn children(&self) -> &[u32] {
        &self.children[..self.count as usize]
    }
}

impl BinaryTree {
    /// Chooses the wide nodes so that the sum of their areas is least.
    pub fn collapse(&self) -> WideTopology {
        // Filled by all threads, since the first touch of memory takes time.
        let mut choices: Vec<Choices> =
            rayon::iter::repeat_n(Choices(0), self.nodes.len()).collect();
        if let [root, ..] = &self.nodes[..] {
            let scale = area_scale(root);
            let (own, below) = choices.split_at_mut(1);
            Subtree {
                nodes: &self.nodes,
                node: 0,
                own: &mut own[0],
                below,
                scale,
            }
            .solve();
        }
        emit(self, &choices)
    }
}

/// Brings areas into the range of f32: the root's is 1.
fn area_scale(root: &BinaryNode) -> f64 {
    let area = root.bounds.half_area();
    if area > 0.0 { 1.0 / area } else { 0.0 }
}

/// How the roots that a subtree may have are shared out between its children: in bits 3 j to
/// 3 j + 2, for at most j + 2 roots, the number for the left child; 0 says that one root less is
/// better.
#[derive(Debug, Clone, Copy)]
struct Choices(u32);

impl Choices {
    const ONE_EACH: Choices = Choices(0o1_111_111);

    fn set(&mut self, roots: usize, left: usize) {
        self.0 |= (left as u32) << (3 * (roots - 2));
    }

    fn clear(&mut self, roots: usize) {
        self.0 &= !(7 << (3 * (roots - 2)));
    }

    fn left(self, roots: usize) -> usize {
        (self.0 >> (3 * (roots - 2)) & 7) as usize
    }
}

/// Costs with at most 1 to 7 roots.
type Costs = [f32; WIDTH - 1];

struct Subtree<'a> {
    nodes: &'a [BinaryNode],
    /// Its root.
    node: usize,
    /// The choices of its root.
    own: &'a mut Choices,
    /// Those of the nodes below, which are neighbours of each other.
    below: &'a mut [Choices],
    scale: f64,
}

impl Subtree<'_> {
    fn solve(self) -> Costs {
        let node = &self.nodes[self.node];
        if node.is_leaf() {
            return [0.0; WIDTH - 1];
        }
        let area = (node.bounds.half_area() * self.scale) as f32;
        if node.leaves == 2 {
            // One leaf to each child, unless it has to be a wide node of its own.
            *self.own = Choices::ONE_EACH;
            let mut costs = [0.0; WIDTH - 1];
            costs[0] = area;
            return costs;
        }
        let first = node.index as usize;
        let (children, below) = self.below.split_at_mut(2);
        let (left_own, right_own) = children.split_at_mut(1);
        let left_leaves = self.nodes[first].leaves as usize;
        let (left_below, right_below) = below.split_at_mut(2 * (left_leaves - 1));
        let (nodes, scale) = (self.nodes, self.scale);
        let subtree = |node, own, below| Subtree {
            nodes,
            node,
            own,
            below,
            scale,
        };
        let left = subtree(first, &mut left_own[0], left_below);
        let right = subtree(first + 1, &mut right_own[0], right_below);
        let (left, right) = if node.leaves > PARALLEL_LIMIT {
            rayon::join(|| left.solve(), || right.solve())
        } else {
            (left.solve(), right.solve())
        };
        combine(area, &[left, right], self.own)
    }
}

/// The costs of a node from those of its children, and how to reach them.
fn combine(area: f32, [left, right]: &[Costs; 2], choices: &mut Choices) -> Costs {
    let mut costs = [0.0; WIDTH - 1];
    for roots in 2..=WIDTH {
        let mut best = (f32::INFINITY, 0);
        for k in 1..roots {
            let cost = left[k - 1] + right[roots - k - 1];
            best = if cost < best.0 { (cost, k) } else { best };
        }
        if roots == WIDTH {
            // As a wide node of its own.
            costs[0] = area + best.0;
        } else {
            costs[roots - 1] = best.0;
        }
        choices.set(roots, best.1);
    }
    for roots in 2..WIDTH {
        if costs[roots - 2] < costs[roots - 1] {
            costs[roots - 1] = costs[roots - 2];
            choices.clear(roots);
        }
    }
    costs
}

/// A wide node that is to be filled.
#[derive(Debug, Clone, Copy)]
struct Unfilled {
    /// Its index among the wide nodes.
    wide: u32,
    /// The binary node that it stands for.
    root: u32,
    /// Wide nodes from the root down to it.
    level: u32,
}

/// Follows the choices down from the root: first to subtrees that are small enough, then all of
/// these in parallel, each into a list of its own.
fn emit(tree: &BinaryTree, choices: &[Choices]) -> WideTopology {
    let mut top = Emission::new();
    if !tree.nodes.is_empty() {
        top.fill(tree, choices, Unfilled::ROOT, EMIT_LIMIT);
    }
    let below = |root: &Unfilled| {
        let mut emission = Emission::new();
        let root = Unfilled { wide: 0, ..*root };
        emission.fill(tree, choices, root, u32::MAX);
        emission
    };
    let subtrees: Vec<Emission> = top.unfilled.par_iter().map(below).collect();
    join(top, subtrees)
}

/// Puts the nodes of the subtrees behind those at the top, but for their roots, which have a place there.
fn join(top: Emission, subtrees: Vec<Emission>) -> WideTopology {
    let depths = subtrees.iter().map(|subtree| subtree.depth);
    let depth = depths.fold(top.depth, u32::max);
    let count: usize = subtrees.iter().map(|subtree| subtree.nodes.len() - 1).sum();
    let mut nodes = top.nodes;
    nodes.reserve_exact(count);
    for (root, subtree) in top.unfilled.iter().zip(subtrees) {
        // Its node 1 comes next.
        let offset = nodes.len() as u32 - 1;
        let mut moved = subtree.nodes.into_iter().map(|node| WideChildren {
            first_inner: node.first_inner + offset,
            ..node
        });
        let place = &mut nodes[root.wide as usize];
        *place = moved.next().unwrap_or(*place);
        nodes.extend(moved);
    }
    WideTopology { nodes, depth }
}

/// Wide nodes of a tree or a part of it.
struct Emission {
    /// The first is the root.
    nodes: Vec<WideChildren>,
    depth: u32,
    /// Those that were left to be filled, in order.
    unfilled: Vec<Unfilled>,
}

impl Unfilled {
    const ROOT: Unfilled = Unfilled {
        wide: 0,
        root: 0,
        level: 1,
    };
}

impl Emission {
    fn new() -> Emission {
        let root = WideChildren {
            children: [0; WIDTH],
            count: 0,
            first_inner: 1,
        };
        Emission {
            nodes: vec![root],
            depth: 1,
            unfilled: vec![],
        }
    }

    /// Fills a root and what is below it, or leaves that out where there are no more leaves than `limit`;
    /// with a limit of [`u32::MAX`] nothing is left out.
    fn fill(&mut self, tree: &BinaryTree, choices: &[Choices], root: Unfilled, limit: u32) {
        let mut stack = vec![root];
        while let Some(next) = stack.pop() {
            if limit != u32::MAX && tree.nodes[next.root as usize].leaves <= limit {
                self.unfilled.push(next);
                continue;
            }
            self.depth = self.depth.max(next.level);
            let mut children = WideChildren {
                children: [0; WIDTH],
                count: 0,
                first_inner: self.nodes.len() as u32,
            };
            open(tree, choices, next.root, &mut children);
            self.nodes[next.wide as usize] = children;
            for &child in children.children() {
                if !tree.nodes[child as usize].is_leaf() {
                    stack.push(Unfilled {
                        wide: self.nodes.len() as u32,
                        root: child,
                        level: next.level + 1,
                    });
                    self.nodes.push(children);
                }
            }
        }
    }
}

/// Lists the children of the wide node that stands for a binary node.
fn open(tree: &BinaryTree, choices: &[Choices], root: u32, children: &mut WideChildren) {
    // Roots of subtrees, each with the number of roots that it may have.
    let mut stack = [(0, 0); WIDTH];
    stack[0] = (root, WIDTH);
    let mut size = 1;
    while size > 0 {
        size -= 1;
        let (node, mut roots) = stack[size];
        let BinaryNode { index, leaves, .. } = tree.nodes[node as usize];
        roots = roots.min(leaves as usize);
        while roots >= 2 && choices[node as usize].left(roots) == 0 {
            roots -= 1;
        }
        if roots == 1 {
            children.children[children.count as usize] = node;
            children.count += 1;
            continue;
        }
        let left = choices[node as usize].left(roots);
        stack[size] = (index + 1, roots - left);
        stack[size + 1] = (index, left);
        size += 2;
    }
}
