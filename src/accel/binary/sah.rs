//! Top-down: the surface area heuristic over bins of centroids on all three axes (Wald, *On fast
//! Construction of SAH-based Bounding Volume Hierarchies*, 2007), exact where few boxes are left.

use super::super::primitive::fold_slices;
use super::MAX_BINARY_DEPTH;
use super::boxes::{Box4, Node4, bounds, void};
use super::ploc::levels_of_even_splits;
use super::sweep::{self, MAX_SWEEP};
use glam::Vec4;

/// Most bins an axis.
const BINS: usize = 16;

/// Fewer boxes than this get [`FEW_BINS`].
const FEW: usize = 32;
const FEW_BINS: usize = 8;

/// Fewer boxes than this are built by one thread.
const PARALLEL_LIMIT: usize = 2048;

/// 2²³: the sum with a number from 0 to 2²² holds that number, rounded, in its low bits.
const TO_INTEGER: f32 = 8_388_608.0;

pub(super) fn build(mut items: Vec<Node4>) -> Vec<Node4> {
    let mut nodes = void(2 * items.len() - 1);
    let (root, below) = nodes.split_at_mut(1);
    let [bounds, _] = bounds(&items);
    let task = Task {
        items: &mut items,
        bounds,
        below,
        first: 1,
        level: 0,
    };
    task.build(&mut root[0]);
    nodes
}

/// A subtree to build.
struct Task<'a> {
    /// What it holds, at least one.
    items: &'a mut [Node4],
    /// Their bounds.
    bounds: Box4,
    /// Room for the nodes below its root: 2 (n - 1).
    below: &'a mut [Node4],
    /// Index of the first of these.
    first: u32,
    /// Inner nodes above its root.
    level: u32,
}

impl Task<'_> {
    /// Writes its root and what is below; gives the inner nodes on the longest way to a leaf,
    /// from the root of all.
    fn build(self, root: &mut Node4) {
        let n = self.items.len();
        if n == 1 {
            *root = self.items[0];
            return;
        }
        *root = Node4::new(self.bounds, self.first, n as u32);
        let (middle, bounds) = divide(self.items, self.level);
        let (left_items, right_items) = self.items.split_at_mut(middle);
        let (roots, below) = self.below.split_at_mut(2);
        let (left_root, right_root) = roots.split_at_mut(1);
        let (left_below, right_below) = below.split_at_mut(2 * (middle - 1));
        let left = Task {
            items: left_items,
            bounds: bounds[0],
            below: left_below,
            first: self.first + 2,
            level: self.level + 1,
        };
        let right = Task {
            items: right_items,
            bounds: bounds[1],
            below: right_below,
            first: self.first + 2 * middle as u32,
            level: self.level + 1,
        };
        if n > PARALLEL_LIMIT {
            rayon::join(
                || left.build(&mut left_root[0]),
                || right.build(&mut right_root[0]),
            );
        } else {
            left.build(&mut left_root[0]);
            right.build(&mut right_root[0]);
        }
    }
}

/// Reorders at least two items; gives the number that goes left, and the bounds of both sides.
fn divide(items: &mut [Node4], level: u32) -> (usize, [Box4; 2]) {
    let is_too_deep = level + levels_of_even_splits(items.len()) >= MAX_BINARY_DEPTH;
    if items.len() <= MAX_SWEEP && !is_too_deep {
        return sweep::divide(items);
    }
    let [_, centroids] = bounds(items);
    let bins = if items.len() < FEW { FEW_BINS } else { BINS };
    let binning = Binning::new(centroids, bins);
    let split = best_split(items, &binning).filter(|_| !is_too_deep);
    let Some(split) = split else {
        return divide_evenly(items, centroids);
    };
    let middle = partition(items, |item| {
        binning.bins_of(item)[split.axis] < split.bin as u32
    });
    (middle, split.bounds)
}

/// Maps centroids to bins: monotone in each coordinate.
struct Binning {
    scale: Vec4,
    offset: Vec4,
    bins: usize,
}

impl Binning {
    fn new(centroids: Box4, bins: usize) -> Binning {
        let scale = |size: f32| {
            if size > 0.0 {
                (bins as f32 / size).min(f32::MAX)
            } else {
                0.0
            }
        };
        let [x, y, z, _] = centroids.size().to_array();
        let scale = Vec4::new(scale(x), scale(y), scale(z), 0.0);
        Binning {
            scale,
            // Half less, since the conversion to an integer rounds.
            offset: centroids.lo * scale + 0.5,
            bins,
        }
    }

    /// The bins of an item on all axes.
    fn bins_of(&self, item: &Node4) -> [u32; 3] {
        let x = item.centroid() * self.scale - self.offset;
        let x = x.max(Vec4::ZERO).min(Vec4::splat((self.bins - 1) as f32));
        let [x, y, z, _] = (x + TO_INTEGER).to_array();
        // The mask lets the compiler see that it is within the arrays.
        [x, y, z].map(|x| x.to_bits() & (BINS as u32 - 1))
    }
}

#[derive(Clone, Copy)]
struct Bin {
    bounds: Box4,
    count: u32,
}

impl Bin {
    const EMPTY: Bin = Bin {
        bounds: Box4::EMPTY,
        count: 0,
    };

    fn merge(self, other: Bin) -> Bin {
        Bin {
            bounds: self.bounds.union(other.bounds),
            count: self.count + other.count,
        }
    }
}

type Histogram = [[Bin; BINS]; 3];

/// Node4s in bins below `bin` go left.
struct Split {
    axis: usize,
    bin: usize,
    bounds: [Box4; 2],
    /// Cost, then imbalance, which decides where all costs are 0.
    key: (f32, u32),
}

/// None where all centroids share a bin on each axis.
fn best_split(items: &[Node4], binning: &Binning) -> Option<Split> {
    let add = |histogram: &mut Histogram, item: &Node4| {
        let bins = binning.bins_of(item);
        for (bin, side) in bins.into_iter().zip(histogram) {
            let bin = &mut side[bin as usize];
            bin.bounds = bin.bounds.union(item.0);
            bin.count += 1;
        }
    };
    let merge = |mut a: Histogram, b: Histogram| {
        for (x, y) in a.as_flattened_mut().iter_mut().zip(b.as_flattened()) {
            *x = x.merge(*y);
        }
        a
    };
    let histogram = fold_slices(items, || [[Bin::EMPTY; BINS]; 3], add, merge);
    let mut best = None;
    for (axis, bins) in histogram.iter().enumerate() {
        if binning.scale[axis] > 0.0 {
            sweep_bins(&bins[..binning.bins], axis, &mut best);
        }
    }
    best
}

/// From the right to know all right sides, then from the left.
fn sweep_bins(bins: &[Bin], axis: usize, best: &mut Option<Split>) {
    let mut right_sides = [Bin::EMPTY; BINS];
    let mut right = Bin::EMPTY;
    for i in (1..bins.len()).rev() {
        right = bins[i].merge(right);
        right_sides[i] = right;
    }
    let mut left = Bin::EMPTY;
    for i in 1..bins.len() {
        left = left.merge(bins[i - 1]);
        let right = right_sides[i];
        if left.count == 0 || right.count == 0 {
            continue;
        }
        let cost = |side: Bin| side.bounds.area() * side.count as f32;
        let key = (cost(left) + cost(right), left.count.abs_diff(right.count));
        if best.as_ref().is_none_or(|best| key < best.key) {
            let bounds = [left.bounds, right.bounds];
            let bin = i;
            *best = Some(Split {
                axis,
                bin,
                bounds,
                key,
            });
        }
    }
}

/// Halves the items about the median on the longest axis of their centroids; equal centroids are
/// told apart by index, so a million coincident boxes are halved too.
fn divide_evenly(items: &mut [Node4], centroids: Box4) -> (usize, [Box4; 2]) {
    let axis = centroids.size().truncate().max_position();
    let middle = items.len() / 2;
    items.select_nth_unstable_by(middle, |a, b| {
        let (x, y) = (a.centroid()[axis], b.centroid()[axis]);
        x.total_cmp(&y).then(a.index().cmp(&b.index()))
    });
    let (left, right) = items.split_at(middle);
    (middle, [bounds(left)[0], bounds(right)[0]])
}

/// Moves the items that belong left to the front, in place; gives their number. No branch depends on
/// the data.
fn partition(items: &mut [Node4], is_left: impl Fn(&Node4) -> bool) -> usize {
    let mut middle = 0;
    for i in 0..items.len() {
        items.swap(i, middle);
        middle += usize::from(is_left(&items[middle]));
    }
    middle
}
