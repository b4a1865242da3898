//! Grouping lights by the surface area orientation heuristic, in bins, from the root down.

use glam::DVec3;

use super::bounds::LightBounds;
use super::node::{LEAF, pack};
use super::{LightTree, MAX_DEPTH};
use crate::render::layout::LightNode;

/// Bins of an axis (Conty Estevez and Kulla 2018 and Pharr, Jakob and Humphreys 2023 have 12).
const BINS: usize = 12;
/// Groups that are split by one thread.
const SMALL: usize = 1 << 10;

/// A light on its way to its leaf.
#[derive(Clone, Copy)]
struct Item {
    bounds: LightBounds,
    light: u32,
    trail: u32,
}

pub(super) fn build(lights: &[LightBounds]) -> LightTree {
    let item = |(i, bounds): (usize, &LightBounds)| Item {
        bounds: *bounds,
        light: i as u32,
        trail: 0,
    };
    let mut items: Vec<Item> = lights.iter().enumerate().map(item).collect();
    let total: f64 = lights.iter().map(|l| l.intensity).sum();
    let mut nodes = vec![LightNode::default(); 2 * lights.len()];
    let (head, rest) = nodes.split_at_mut(2);
    let place = Place {
        first: 2,
        depth: 0,
        trail: 0,
        total,
    };
    head[0] = place.fill(&mut items, rest).1;
    let mut trails = vec![0; lights.len()];
    for item in &items {
        trails[item.light as usize] = item.trail;
    }
    LightTree { nodes, trails }
}

/// Where a group stands in the tree.
#[derive(Clone, Copy)]
struct Place {
    /// Index of the first node below it.
    first: u32,
    /// Decisions that led here, and which.
    depth: u32,
    trail: u32,
    /// Intensity of the whole tree.
    total: f64,
}

impl Place {
    /// Builds the tree of a group, and gives its bounds and its node. The 2n − 2 nodes below are its
    /// children, all that is below the first, and all that is below the second.
    fn fill(self, items: &mut [Item], nodes: &mut [LightNode]) -> (LightBounds, LightNode) {
        if let [item] = items {
            item.trail = self.trail;
            let node = pack(&item.bounds, self.total, LEAF | item.light);
            return (item.bounds, node);
        }
        let middle = split(items, self.depth);
        let is_small = items.len() <= SMALL;
        let (low, high) = items.split_at_mut(middle);
        let (pair, below) = nodes.split_at_mut(2);
        let (below_low, below_high) = below.split_at_mut(2 * low.len() - 2);
        let child = |second: bool, first: u32| Place {
            first,
            depth: self.depth + 1,
            trail: self.trail | u32::from(second) << self.depth,
            ..self
        };
        let first = child(false, self.first + 2);
        let second = child(true, self.first + 2 + below_low.len() as u32);
        let (a, b) = if is_small {
            (first.fill(low, below_low), second.fill(high, below_high))
        } else {
            rayon::join(
                || first.fill(low, below_low),
                || second.fill(high, below_high),
            )
        };
        (pair[0], pair[1]) = (a.1, b.1);
        let bounds = a.0.union(&b.0);
        (bounds, pack(&bounds, self.total, self.first))
    }
}

/// Reorders a group of two or more in two parts, neither empty; gives the size of the first.
fn split(items: &mut [Item], depth: u32) -> usize {
    if items.len() == 2 {
        return 1;
    }
    let extent = centers(items);
    let levels = items.len().next_power_of_two().ilog2();
    // An uneven split may leave one level less than halving would need.
    let is_free = depth + 1 + levels <= MAX_DEPTH;
    let best = is_free.then(|| best_split(items, &extent)).flatten();
    if let Some((axis, bin)) = best {
        let middle = partition(items, |item| extent.bin(item, axis) <= bin);
        if middle > 0 && middle < items.len() {
            return middle;
        }
    }
    // All centres in one place, or the tree is too deep for more than halving.
    let middle = items.len() / 2;
    let axis = extent.longest();
    let key = |item: &Item| item.bounds.doubled_center()[axis];
    items.select_nth_unstable_by(middle, |a, b| {
        let order = key(a).total_cmp(&key(b));
        order.then(a.light.cmp(&b.light))
    });
    middle
}

/// The box of the (doubled) centres of a group.
struct Extent {
    low: DVec3,
    size: DVec3,
}

fn centers(items: &[Item]) -> Extent {
    let mut low = DVec3::INFINITY;
    let mut high = DVec3::NEG_INFINITY;
    for item in items {
        let center = item.bounds.doubled_center();
        (low, high) = (low.min(center), high.max(center));
    }
    let size = high - low;
    Extent { low, size }
}

impl Extent {
    fn bin(&self, item: &Item, axis: usize) -> usize {
        let share = (item.bounds.doubled_center()[axis] - self.low[axis]) / self.size[axis];
        ((share * BINS as f64) as usize).min(BINS - 1)
    }

    fn longest(&self) -> usize {
        let longer = |a: usize, b: usize| if self.size[b] > self.size[a] { b } else { a };
        longer(longer(0, 1), 2)
    }
}

/// The axis and the last bin of the first part with the least cost; `None` if all centres are one.
fn best_split(items: &[Item], extent: &Extent) -> Option<(usize, usize)> {
    let longest = extent.size.max_element();
    let mut best = None;
    let mut least = f64::INFINITY;
    for axis in (0..3).filter(|&axis| extent.size[axis] > 0.0) {
        // Long thin groups are avoided (Conty Estevez and Kulla 2018, k_r).
        let thinness = longest / extent.size[axis];
        for (bin, cost) in split_costs(&bins(items, extent, axis)) {
            if thinness * cost < least {
                least = thinness * cost;
                best = Some((axis, bin));
            }
        }
    }
    best
}

type Bins = [Option<LightBounds>; BINS];

fn bins(items: &[Item], extent: &Extent, axis: usize) -> Bins {
    let mut bins: Bins = [None; BINS];
    for item in items {
        let bin = &mut bins[extent.bin(item, axis)];
        *bin = joined(bin.as_ref(), Some(&item.bounds));
    }
    bins
}

fn joined(a: Option<&LightBounds>, b: Option<&LightBounds>) -> Option<LightBounds> {
    match (a, b) {
        (Some(a), Some(b)) => Some(a.union(b)),
        (one, other) => one.or(other).copied(),
    }
}

/// The cost of splitting after each bin, where both parts hold something.
fn split_costs(bins: &Bins) -> Vec<(usize, f64)> {
    let mut after: Bins = [None; BINS];
    for i in (0..BINS - 1).rev() {
        after[i] = joined(after[i + 1].as_ref(), bins[i + 1].as_ref());
    }
    let mut before = None;
    let mut costs = Vec::new();
    for i in 0..BINS - 1 {
        before = joined(before.as_ref(), bins[i].as_ref());
        if let (Some(a), Some(b)) = (&before, &after[i]) {
            costs.push((i, a.cost() + b.cost()));
        }
    }
    costs
}

/// Moves the items that are `first` to the front; gives their number.
fn partition(items: &mut [Item], first: impl Fn(&Item) -> bool) -> usize {
    let mut count = 0;
    for i in 0..items.len() {
        if first(&items[i]) {
            items.swap(i, count);
            count += 1;
        }
    }
    count
}
