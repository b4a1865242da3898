//! Takes subtrees out and puts them where they fit better (Meister and Bittner, *Parallel Reinsertion
//! for Bounding Volume Hierarchy Optimization*, 2018). The cost of the tree never rises.

use super::super::primitive::fold_slices;
use super::Preset;
use super::boxes::Node4;
use super::place_search::{Move, pair, search, sibling};
use rayon::prelude::*;

/// Rounds of moves among the largest nodes. They take smaller and smaller shares of the first, 1/3,
/// 1/5 and so on: most is to be gained near the root, where moves stand in each other's way most.
const ROUNDS: usize = 8;

/// At least so many nodes take part, where there are as many.
const FEWEST: usize = 64;

/// Most rounds of moves among all nodes.
const FULL_ROUNDS: usize = 8;

/// A round among all nodes that gains less than this share of the cost is the last.
const LEAST_GAIN: f64 = 1e-3;

/// Improves a tree, of which node 0 is the root and siblings are neighbours.
pub(super) fn improve(nodes: &mut [Node4], preset: Preset) {
    // One node in so many takes part in the first round.
    let divisor = match preset {
        Preset::Fast => 100,
        Preset::Balanced | Preset::Best => 20,
    };
    let count = nodes.len() / divisor;
    let mut optimizer = Optimizer::new(nodes);
    let mut candidates = optimizer.largest(count.max(FEWEST));
    for round in 0..ROUNDS {
        optimizer.sort(&mut candidates);
        let share = candidates.len() / (2 * round + 1);
        optimizer.batch(&candidates[..share]);
    }
    if preset == Preset::Best {
        let all = optimizer.largest(usize::MAX);
        for _ in 0..FULL_ROUNDS {
            if optimizer.batch(&all) <= LEAST_GAIN * optimizer.cost() {
                break;
            }
        }
    }
}

/// A tree in which nodes may move.
struct Optimizer<'a> {
    /// Node 0 is the root, siblings are neighbours.
    nodes: &'a mut [Node4],
    /// The parent of nodes 2 i + 1 and 2 i + 2.
    parents: Vec<u32>,
    /// Whether a node was replaced by another one in this batch.
    is_stale: Vec<bool>,
}

impl<'a> Optimizer<'a> {
    fn new(nodes: &'a mut [Node4]) -> Optimizer<'a> {
        let mut parents = vec![0; nodes.len() / 2];
        for (i, node) in nodes.iter().enumerate() {
            if !node.is_leaf() {
                parents[pair(node.index())] = i as u32;
            }
        }
        let is_stale = vec![false; nodes.len()];
        Optimizer {
            nodes,
            parents,
            is_stale,
        }
    }

    /// Tries to move each of these nodes; gives what it gained, as a difference of summed half areas.
    fn batch(&mut self, candidates: &[u32]) -> f64 {
        let search =
            |stack: &mut Vec<_>, &node: &u32| search(self.nodes, &self.parents, node, stack);
        let found = candidates
            .par_iter()
            .with_min_len(64)
            .map_init(Vec::new, search);
        let mut moves: Vec<Move> = found.flatten().collect();
        moves.par_sort_unstable_by(|a, b| b.gain.total_cmp(&a.gain).then(a.node.cmp(&b.node)));
        self.is_stale.fill(false);
        moves.into_iter().map(|m| self.apply(m)).sum()
    }

    /// The `count` nodes with the largest boxes, but for the root; the largest first.
    fn largest(&self, count: usize) -> Vec<u32> {
        let all = 1..self.nodes.len() as u32;
        let mut list: Vec<u32> = if count >= all.len() {
            all.collect()
        } else {
            let least = self.least_area(count);
            all.into_par_iter()
                .filter(|&i| self.area(i) >= least)
                .collect()
        };
        self.sort(&mut list);
        list.truncate(count);
        list
    }

    /// Puts the nodes with the largest boxes first.
    fn sort(&self, list: &mut [u32]) {
        // The order of floats that are not negative is that of their bits; those come first, then
        // the index. Compared often, read from the tree once.
        let key = |&i: &u32| u64::from(!self.area(i).to_bits()) << 32 | u64::from(i);
        let mut keys: Vec<u64> = list.par_iter().map(key).collect();
        keys.par_sort_unstable();
        list.par_iter_mut()
            .zip(keys)
            .for_each(|(i, key)| *i = key as u32);
    }

    /// An area that at least `count` nodes have, and not many more.
    fn least_area(&self, count: usize) -> f32 {
        // The order of floats that are not negative is that of their bits: a histogram of the high ones.
        let add = |counts: &mut Vec<u32>, node: &Node4| {
            counts[(node.0.area().to_bits() >> 16) as usize] += 1
        };
        let merge = |mut a: Vec<u32>, b: Vec<u32>| {
            a.iter_mut().zip(b).for_each(|(a, b)| *a += b);
            a
        };
        let counts = fold_slices(&self.nodes[1..], || vec![0u32; 1 << 15], add, merge);
        let mut sum = 0;
        for (bits, &here) in counts.iter().enumerate().rev() {
            sum += here as usize;
            if sum >= count {
                return f32::from_bits((bits as u32) << 16);
            }
        }
        0.0
    }

    /// Σ of the half areas of all inner nodes.
    fn cost(&self) -> f64 {
        let inner = self.nodes.iter().filter(|node| !node.is_leaf());
        inner.map(area).sum()
    }

    fn area(&self, node: u32) -> f32 {
        self.nodes[node as usize].0.area()
    }

    fn parent(&self, node: u32) -> u32 {
        self.parents[pair(node)]
    }

    /// Carries out a move unless earlier ones of the batch spoilt it; gives what it gained.
    fn apply(&mut self, Move { node, target, .. }: Move) -> f64 {
        let is_stale = |i: u32| self.is_stale[i as usize];
        if is_stale(node) || is_stale(target) || !self.is_possible(node, target) {
            return 0.0;
        }
        let (parent, brother) = (self.parent(node), sibling(node));
        let gained = self.detach(node) + self.attach(node, target);
        if gained <= 0.0 {
            self.detach(node);
            self.attach(node, parent);
            return 0.0;
        }
        for i in [parent, brother, target] {
            self.is_stale[i as usize] = true;
        }
        gained
    }

    /// Whether the target is neither where the node is nor below it.
    fn is_possible(&self, node: u32, target: u32) -> bool {
        if target == sibling(node) || target == self.parent(node) {
            return false;
        }
        let mut above = target;
        while above != 0 && above != node {
            above = self.parent(above);
        }
        above == 0
    }

    /// Puts the sibling into the parent's place; the node keeps its own, beside a free one.
    fn detach(&mut self, node: u32) -> f64 {
        let parent = self.parent(node);
        let gained = area(&self.nodes[parent as usize]);
        self.copy(sibling(node), parent);
        gained + self.refit_above(parent)
    }

    /// Puts the target beside the node, and a new parent of both into the target's place.
    fn attach(&mut self, node: u32, target: u32) -> f64 {
        self.copy(target, sibling(node));
        self.parents[pair(node)] = target;
        let first = node.min(sibling(node));
        self.nodes[target as usize] = self.parent_of(first);
        self.refit_above(target) - area(&self.nodes[target as usize])
    }

    fn copy(&mut self, from: u32, to: u32) {
        let node = self.nodes[from as usize];
        self.nodes[to as usize] = node;
        if !node.is_leaf() {
            self.parents[pair(node.index())] = to;
        }
    }

    fn parent_of(&self, first: u32) -> Node4 {
        let [a, b] = [self.nodes[first as usize], self.nodes[first as usize + 1]];
        Node4::new(a.0.union(b.0), first, a.leaves() + b.leaves())
    }

    /// Brings the nodes above one up to date; gives what their areas lost.
    fn refit_above(&mut self, mut node: u32) -> f64 {
        let mut gained = 0.0;
        while node != 0 {
            node = self.parent(node);
            let old = self.nodes[node as usize];
            let new = self.parent_of(old.index());
            gained += area(&old) - area(&new);
            self.nodes[node as usize] = new;
        }
        gained
    }
}

/// In f64: a sum of differences says truly whether the cost fell.
fn area(node: &Node4) -> f64 {
    node.0.aabb().half_area()
}

#[cfg(test)]
mod tests {
    use super::super::{boxes::Node4, morton, ploc, sah};
    use super::*;
    use crate::accel::Primitive;
    use crate::geometry::Aabb;
    use glam::Vec3;

    /// Boxes of very different sizes at scattered places.
    fn boxes(n: u32) -> Vec<Primitive> {
        let random = |i: u32, k: u32| {
            let bits = (i * 8 + k).wrapping_mul(0x9e37_79b9);
            (bits ^ (bits >> 15)).wrapping_mul(0x85eb_ca6b) as f32 / u32::MAX as f32
        };
        let primitive = |index| {
            let at = |k| Vec3::new(random(index, k), random(index, k + 1), random(index, k + 2));
            let size = at(3) * random(index, 6).powi(4) * 0.5;
            let bounds = Aabb::from_points(&[at(0) - size, at(0) + size]);
            Primitive { bounds, index }
        };
        (0..n).map(primitive).collect()
    }

    #[test]
    fn every_batch_lowers_the_cost_by_what_it_says() {
        for n in [2, 3, 10, 1000, 20_000] {
            let leaves = morton::sorted_leaves(&boxes(n), 1.0);
            let trees = [ploc::build(leaves.clone()), sah::build(leaves)];
            for mut nodes in trees {
                let mut optimizer = Optimizer::new(&mut nodes);
                let all = optimizer.largest(usize::MAX);
                let first = optimizer.cost();
                for _ in 0..4 {
                    let before = optimizer.cost();
                    let gained = optimizer.batch(&all);
                    let after = optimizer.cost();
                    assert!(gained >= 0.0);
                    assert!((before - after - gained).abs() <= 1e-9 * before);
                }
                let share = optimizer.cost() / first;
                println!("{n}: {share}");
                assert!(n < 1000 || share < 0.99, "nothing moved: {share}");
            }
        }
    }

    #[test]
    fn the_largest_are_the_largest() {
        let mut nodes: Vec<Node4> = ploc::build(morton::sorted_leaves(&boxes(3000), 1.0));
        let optimizer = Optimizer::new(&mut nodes);
        let mut all: Vec<u32> = (1..5999).collect();
        optimizer.sort(&mut all);
        for count in [1, 10, 500, 5998, 10_000] {
            assert_eq!(optimizer.largest(count), all[..count.min(all.len())]);
        }
    }
}
