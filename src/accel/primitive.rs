//! What trees are built over.

use crate::geometry::Aabb;
use rayon::prelude::*;

/// A box to build a tree over, such as a triangle's exact bounds, and its index in the input.
#[derive(Debug, Clone, Copy)]
pub struct Primitive {
    /// Exact bounds, metres.
    pub bounds: Aabb,
    /// Index in the input.
    pub index: u32,
}

/// The bounds of all boxes.
pub(super) fn bounds(primitives: &[Primitive]) -> Aabb {
    let add = |acc: &mut Aabb, p: &Primitive| *acc = acc.union(p.bounds);
    fold_slices(primitives, || Aabb::EMPTY, add, Aabb::union)
}

/// Primitives that one task folds; more of them are spread over threads.
const CHUNK: usize = 1 << 15;

/// Folds over primitives, in parallel where there are many. `merge` must be commutative and
/// associative bit for bit, as minima, maxima and integer sums are: the threads are not ordered.
pub(super) fn fold_slices<I: Sync, T: Send>(
    items: &[I],
    empty: impl Fn() -> T + Sync + Send,
    add: impl Fn(&mut T, &I) + Sync + Send,
    merge: impl Fn(T, T) -> T + Sync + Send,
) -> T {
    let fold = |chunk: &[I]| {
        let mut sum = empty();
        chunk.iter().for_each(|item| add(&mut sum, item));
        sum
    };
    if items.len() <= CHUNK {
        return fold(items);
    }
    let chunks = items.par_chunks(CHUNK);
    chunks.map(fold).reduce(&empty, merge)
}
