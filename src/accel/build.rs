//! The builder: recursive binned SAH in place, in parallel, the same tree whatever the threads.

use super::bins::{Binning, MAX_BINS, best_split};
use super::node::{BvhNode, Child};
use super::primitive::{self, Primitive, centroid_bounds, primitives};
use super::{BuildOptions, Bvh, MAX_DEPTH, MAX_LEAF_SIZE, Preset};
use crate::geometry::Aabb;
use glam::Vec3;

/// Cost of a node step (two boxes), relative to a triangle test: both wait for one gather.
pub(super) const NODE_COST: f64 = 1.0;

/// Fewer primitives than this are built by one thread.
const PARALLEL_LIMIT: usize = 2048;

impl Bvh {
    /// Builds the tree over triangles whose vertices are all finite, in any number up to
    /// [`super::MAX_TRIANGLES`] (which the caller checks). Same input, same tree, bit for bit,
    /// whatever the number of threads.
    ///
    /// Time O(n log n); where the heuristic would peel off single triangles O(64 n), since a
    /// branch that gets too deep for [`MAX_DEPTH`] is split evenly from there on.
    pub fn build(triangles: &[[Vec3; 3]], options: &BuildOptions) -> Bvh {
        let mut primitives = primitives(triangles);
        let bounds = primitive::bounds(&primitives);
        // A tree of n leaves has n - 1 nodes; each task writes to its own part of them.
        let mut slots = vec![BvhNode::empty(); primitives.len().max(1)];
        let builder = Builder {
            max_leaf_size: options.max_leaf_size.clamp(1, MAX_LEAF_SIZE) as usize,
            bins: match options.preset {
                Preset::Fast => 8,
                Preset::Balanced => options.bins.clamp(2, MAX_BINS),
                Preset::Best => MAX_BINS,
            },
        };
        let task = Task {
            primitives: &mut primitives,
            bounds,
            slots: &mut slots,
            slot: 0,
            first: 0,
            level: 1,
        };
        let built = builder.root(task);
        Bvh {
            nodes: compact(slots),
            order: primitives.iter().map(|p| p.index).collect(),
            depth: built,
        }
    }
}

struct Builder {
    max_leaf_size: usize,
    bins: usize,
}

/// A subtree to build.
struct Task<'a> {
    /// Its triangles, a slice of all.
    primitives: &'a mut [Primitive],
    /// Their exact bounds.
    bounds: Aabb,
    /// Room for its nodes, at least one less than its triangles.
    slots: &'a mut [BvhNode],
    /// Position of `slots` in all slots.
    slot: usize,
    /// Position of `primitives` in all primitives.
    first: usize,
    /// Nodes on the way from the root to its root, both counted.
    level: u32,
}

/// How to divide a task: the number of triangles that go left, and the bounds of both sides.
struct Division {
    middle: usize,
    bounds: [Aabb; 2],
}

impl Builder {
    /// Fills slot 0 in any case and returns the depth of the tree.
    fn root(&self, task: Task) -> u32 {
        match self.divide(&mut *task.primitives, &task.bounds, 1) {
            Some(division) => self.node(task, division),
            None => {
                let leaf = leaf(&task);
                task.slots[0] = BvhNode::new(leaf, Child::ABSENT);
                1
            }
        }
    }

    /// Builds a child; returns it with the levels of nodes in it.
    fn child(&self, task: Task) -> (Child, u32) {
        let Some(division) = self.divide(&mut *task.primitives, &task.bounds, task.level) else {
            return (leaf(&task), 0);
        };
        let child = Child {
            bounds: task.bounds,
            index: task.slot as u32,
            count: 0,
        };
        (child, self.node(task, division))
    }

    /// Builds both sides and the node above them; returns the levels of nodes.
    fn node(&self, task: Task, division: Division) -> u32 {
        let parallel = task.primitives.len() > PARALLEL_LIMIT;
        let Division { middle, bounds } = division;
        let (left_primitives, right_primitives) = task.primitives.split_at_mut(middle);
        let (own, rest) = task.slots.split_at_mut(1);
        let (left_slots, right_slots) = rest.split_at_mut(middle - 1);
        let left = Task {
            primitives: left_primitives,
            bounds: bounds[0],
            slots: left_slots,
            slot: task.slot + 1,
            first: task.first,
            level: task.level + 1,
        };
        let right = Task {
            primitives: right_primitives,
            bounds: bounds[1],
            slots: right_slots,
            slot: task.slot + middle,
            first: task.first + middle,
            level: task.level + 1,
        };
        let ((left, a), (right, b)) = if parallel {
            rayon::join(|| self.child(left), || self.child(right))
        } else {
            (self.child(left), self.child(right))
        };
        own[0] = BvhNode::new(left, right);
        1 + a.max(b)
    }

    /// Decides between a leaf (None) and a division, for which it reorders the primitives.
    fn divide(&self, primitives: &mut [Primitive], bounds: &Aabb, level: u32) -> Option<Division> {
        let n = primitives.len();
        if n <= 1 {
            return None;
        }
        let centroids = centroid_bounds(primitives);
        let may_be_leaf = n <= self.max_leaf_size;
        // Few primitives do not need many bins.
        let binning = Binning::new(&centroids, self.bins.min(n.max(4)));
        let is_too_deep = level + levels_of_even_splits(n) > MAX_DEPTH;
        let split = best_split(primitives, &binning).filter(|_| !is_too_deep);
        let Some(split) = split else {
            return (!may_be_leaf).then(|| even_division(primitives, &centroids));
        };
        let leaf_cost = bounds.half_area() * n as f64;
        if may_be_leaf && leaf_cost <= bounds.half_area() * NODE_COST + split.cost {
            return None;
        }
        let middle = partition(primitives, |p| binning.bin(p, split.axis) < split.bin);
        let bounds = split.bounds;
        Some(Division { middle, bounds })
    }
}

fn leaf(task: &Task) -> Child {
    if task.primitives.is_empty() {
        return Child::ABSENT;
    }
    Child {
        bounds: task.bounds,
        index: task.first as u32,
        count: task.primitives.len() as u32,
    }
}

/// Levels that n primitives need when each node halves them: ⌈log₂ n⌉.
fn levels_of_even_splits(n: usize) -> u32 {
    usize::BITS - (n - 1).leading_zeros()
}

/// Halves the primitives about the median on the longest axis of their centroids; equal centroids
/// are told apart by index, so a million coincident triangles are halved too.
fn even_division(primitives: &mut [Primitive], centroids: &Aabb) -> Division {
    let size = centroids.max.as_dvec3() - centroids.min.as_dvec3();
    let axis = size.max_position();
    let middle = primitives.len() / 2;
    primitives.select_nth_unstable_by(middle, |a, b| {
        let (x, y) = (a.centroid()[axis], b.centroid()[axis]);
        x.total_cmp(&y).then(a.index.cmp(&b.index))
    });
    let (left, right) = primitives.split_at(middle);
    Division {
        middle,
        bounds: [primitive::bounds(left), primitive::bounds(right)],
    }
}

/// Moves the primitives that belong left to the front, in place; returns their number.
fn partition(primitives: &mut [Primitive], is_left: impl Fn(&Primitive) -> bool) -> usize {
    let (mut i, mut j) = (0, primitives.len());
    while i < j {
        if is_left(&primitives[i]) {
            i += 1;
        } else {
            j -= 1;
            primitives.swap(i, j);
        }
    }
    i
}

/// Drops the slots that no node took; the others keep their order, so indices change by a count.
fn compact(mut slots: Vec<BvhNode>) -> Vec<BvhNode> {
    let is_used = |i: usize, node: &BvhNode| i == 0 || *node != BvhNode::empty();
    let mut used = 0;
    let mut new_index = Vec::with_capacity(slots.len());
    for (i, node) in slots.iter().enumerate() {
        new_index.push(used);
        used += u32::from(is_used(i, node));
    }
    for i in 0..slots.len() {
        if is_used(i, &slots[i]) {
            slots[new_index[i] as usize] = renumber(slots[i], &new_index);
        }
    }
    slots.truncate(used as usize);
    slots.shrink_to_fit();
    slots
}

fn renumber(mut node: BvhNode, new_index: &[u32]) -> BvhNode {
    let [left, right] = node.children();
    if let Some(i) = left.inner_index() {
        node.left = new_index[i];
    }
    if let Some(i) = right.inner_index() {
        node.right = new_index[i];
    }
    node
}
