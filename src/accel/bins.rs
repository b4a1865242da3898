//! Where to split: the surface area heuristic over bins of centroids (Wald, *On fast Construction
//! of SAH-based Bounding Volume Hierarchies*, 2007), on all three axes.

use super::primitive::{Primitive, fold_slices};
use crate::geometry::Aabb;
use std::cmp::Ordering;

/// Most bins an axis.
pub(super) const MAX_BINS: usize = 32;

#[derive(Debug, Clone, Copy)]
struct Bin {
    bounds: Aabb,
    count: u32,
}

impl Bin {
    const EMPTY: Bin = Bin {
        bounds: Aabb::EMPTY,
        count: 0,
    };

    fn merge(self, other: Bin) -> Bin {
        Bin {
            bounds: self.bounds.union(other.bounds),
            count: self.count + other.count,
        }
    }
}

/// Maps centroids to bins: monotone in each coordinate.
#[derive(Debug, Clone, Copy)]
pub(super) struct Binning {
    origin: [f64; 3],
    scale: [f64; 3],
    bins: usize,
}

impl Binning {
    /// Bins over the bounds of the centroids. In f64, where neither the extent of any two f32 nor
    /// its reciprocal overflows.
    pub fn new(centroids: &Aabb, bins: usize) -> Binning {
        let bins = bins.clamp(2, MAX_BINS);
        let origin = centroids.min.as_dvec3();
        let extent = centroids.max.as_dvec3() - origin;
        let scale = extent
            .to_array()
            .map(|e| if e > 0.0 { bins as f64 / e } else { 0.0 });
        Binning {
            origin: origin.to_array(),
            scale,
            bins,
        }
    }

    /// Whether all centroids share a bin on each axis, being equal.
    fn is_trivial(&self) -> bool {
        self.scale == [0.0; 3]
    }

    /// The bin of a primitive on an axis.
    pub fn bin(&self, primitive: &Primitive, axis: usize) -> usize {
        let x = f64::from(primitive.centroid()[axis]);
        let bin = (x - self.origin[axis]) * self.scale[axis];
        (bin as usize).min(self.bins - 1)
    }
}

type Histogram = [[Bin; MAX_BINS]; 3];

/// A way to split: primitives in bins below `bin` go left; neither side is empty.
#[derive(Debug, Clone, Copy)]
pub(super) struct Split {
    /// 0 to 2.
    pub axis: usize,
    /// First bin of the right side.
    pub bin: usize,
    /// Σ half area · triangles over both sides, m².
    pub cost: f64,
    /// Exact bounds of the left and the right side.
    pub bounds: [Aabb; 2],
    imbalance: u32,
}

/// The best of all splits between bins, or None where all centroids share a bin on each axis.
pub(super) fn best_split(primitives: &[Primitive], binning: &Binning) -> Option<Split> {
    if binning.is_trivial() {
        return None;
    }
    let histogram = histogram(primitives, binning);
    (0..3)
        .filter_map(|axis| best_on_axis(&histogram[axis][..binning.bins], axis))
        .min_by(compare)
}

fn histogram(primitives: &[Primitive], binning: &Binning) -> Histogram {
    let add = |histogram: &mut Histogram, p: &Primitive| add_to_bins(histogram, binning, p);
    let merge = |mut a: Histogram, b: Histogram| {
        for (x, y) in a.as_flattened_mut().iter_mut().zip(b.as_flattened()) {
            *x = x.merge(*y);
        }
        a
    };
    fold_slices(primitives, || [[Bin::EMPTY; MAX_BINS]; 3], add, merge)
}

fn add_to_bins(histogram: &mut Histogram, binning: &Binning, primitive: &Primitive) {
    for (axis, bins) in histogram.iter_mut().enumerate() {
        let bin = &mut bins[binning.bin(primitive, axis)];
        bin.bounds = bin.bounds.union(primitive.bounds);
        bin.count += 1;
    }
}

/// Sweeps from the right to know all right sides, then from the left.
fn best_on_axis(bins: &[Bin], axis: usize) -> Option<Split> {
    let mut right_sides = [Bin::EMPTY; MAX_BINS];
    let mut right = Bin::EMPTY;
    for i in (1..bins.len()).rev() {
        right = bins[i].merge(right);
        right_sides[i] = right;
    }
    let mut left = Bin::EMPTY;
    let mut best: Option<Split> = None;
    for i in 1..bins.len() {
        left = left.merge(bins[i - 1]);
        let right = right_sides[i];
        if left.count == 0 || right.count == 0 {
            continue;
        }
        let split = candidate(axis, i, left, right);
        if best.is_none_or(|b| compare(&split, &b) == Ordering::Less) {
            best = Some(split);
        }
    }
    best
}

fn candidate(axis: usize, bin: usize, left: Bin, right: Bin) -> Split {
    let cost = |side: Bin| side.bounds.half_area() * f64::from(side.count);
    Split {
        axis,
        bin,
        cost: cost(left) + cost(right),
        bounds: [left.bounds, right.bounds],
        imbalance: left.count.abs_diff(right.count),
    }
}

/// Lower cost first; at equal cost (all 0 for triangles on a line) the more even split.
fn compare(a: &Split, b: &Split) -> Ordering {
    a.cost
        .total_cmp(&b.cost)
        .then(a.imbalance.cmp(&b.imbalance))
}
