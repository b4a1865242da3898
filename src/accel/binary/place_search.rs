//! Where in a tree a subtree fits best: branch and bound from its place up to the root.

use super::boxes::{Box4, Node4};

/// A subtree and the node beside which it is to be.
#[derive(Debug, Clone, Copy)]
pub(super) struct Move {
    /// By how much the half areas of all inner nodes shrink.
    pub gain: f32,
    pub node: u32,
    pub target: u32,
}

/// Which pair of siblings a node belongs to: nodes 1 and 2 are the first.
pub(super) fn pair(node: u32) -> usize {
    (node as usize - 1) / 2
}

pub(super) fn sibling(node: u32) -> u32 {
    ((node - 1) ^ 1) + 1
}

/// The best move of a node other than the root; None if it stands best where it is. `parents` are
/// those of the pairs; `stack` is only there to be used again.
pub(super) fn search(
    nodes: &[Node4],
    parents: &[u32],
    node: u32,
    stack: &mut Vec<(f32, u32)>,
) -> Option<Move> {
    let bounds = |i: u32| nodes[i as usize].0;
    let parent = |i: u32| parents[pair(i)];
    let mut search = Search {
        nodes,
        own: bounds(node),
        own_area: bounds(node).area(),
        best: Move {
            gain: 0.0,
            node,
            target: 0,
        },
        stack,
    };
    // Without the node its sibling takes the parent's place, and the boxes above shrink.
    let mut shrunk = bounds(sibling(node));
    let mut pivot = parent(node);
    let mut gained = bounds(pivot).area();
    search.below(sibling(node), gained);
    search.run();
    while pivot != 0 {
        search.beside(sibling(pivot), gained);
        search.run();
        shrunk = shrunk.union(bounds(sibling(pivot)));
        pivot = parent(pivot);
        gained += bounds(pivot).area() - shrunk.area();
    }
    (search.best.target != 0).then_some(search.best)
}

struct Search<'a> {
    nodes: &'a [Node4],
    own: Box4,
    own_area: f32,
    best: Move,
    /// Pairs of siblings to look at, given by the first, each with what is gained if the node goes
    /// below their parent, but for the area of its own new parent.
    stack: &'a mut Vec<(f32, u32)>,
}

impl Search<'_> {
    fn run(&mut self) {
        while let Some((gained, first)) = self.stack.pop() {
            // The new parent's box will be no smaller than the node's.
            if gained - self.own_area > self.best.gain {
                self.beside(first, gained);
                self.beside(first + 1, gained);
            }
        }
    }

    /// Weighs the place beside a node, and keeps those below it in mind if they may be better.
    #[inline]
    fn beside(&mut self, place: u32, gained: f32) {
        let node = &self.nodes[place as usize];
        let gain = gained - node.0.union(self.own).area();
        if gain > self.best.gain {
            self.best.gain = gain;
            self.best.target = place;
        }
        let gained = gain + node.0.area();
        if gained - self.own_area > self.best.gain && !node.is_leaf() {
            self.stack.push((gained, node.index()));
        }
    }

    /// Keeps the places below a node in mind.
    fn below(&mut self, place: u32, gained: f32) {
        let node = &self.nodes[place as usize];
        if !node.is_leaf() {
            let grown = node.0.union(self.own).area() - node.0.area();
            self.stack.push((gained - grown, node.index()));
        }
    }
}
