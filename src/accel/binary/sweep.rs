//! Few boxes: every split along each axis is tried, or, of up to four, every split at all.

use super::boxes::{Box4, Node4};

/// Most boxes that are swept; with more, bins take less time.
pub(super) const MAX_SWEEP: usize = 8;

/// The best way to divide 2 to [`MAX_SWEEP`] boxes: reorders them; gives the number that goes left
/// and the bounds of both sides.
pub(super) fn divide(items: &mut [Node4]) -> (usize, [Box4; 2]) {
    match items {
        [a, b] => (1, [a.0, b.0]),
        [_, _, _] => divide_three(items),
        [_, _, _, _] => divide_four(items),
        _ => divide_more(items),
    }
}

/// Two and one.
fn divide_three(items: &mut [Node4]) -> (usize, [Box4; 2]) {
    let [a, b, c] = [items[0].0, items[1].0, items[2].0];
    let cost = |pair: Box4, single: Box4| 2.0 * pair.area() + single.area();
    let candidates = [(a.union(b), c), (a.union(c), b), (b.union(c), a)];
    let best = least(candidates.map(|(pair, single)| cost(pair, single)));
    items.swap(2 - best, 2);
    let (pair, single) = candidates[best];
    (2, [pair, single])
}

/// Two and two, or three and one.
fn divide_four(items: &mut [Node4]) -> (usize, [Box4; 2]) {
    let [a, b, c, d] = [items[0].0, items[1].0, items[2].0, items[3].0];
    let [ab, cd] = [a.union(b), c.union(d)];
    let candidates = [
        (ab, cd),
        (a.union(c), b.union(d)),
        (a.union(d), b.union(c)),
        (ab.union(c), d),
        (ab.union(d), c),
        (cd.union(a), b),
        (cd.union(b), a),
    ];
    let mut costs = candidates.map(|(left, right)| 2.0 * (left.area() + right.area()));
    for (cost, (left, right)) in costs[3..].iter_mut().zip(&candidates[3..]) {
        *cost = 3.0 * left.area() + right.area();
    }
    let best = least(costs);
    let (left, right) = candidates[best];
    match best {
        0..3 => items.swap(1, 1 + best),
        _ => items.swap(6 - best, 3),
    }
    (if best < 3 { 2 } else { 3 }, [left, right])
}

/// The place of the first of the smallest.
fn least<const N: usize>(costs: [f32; N]) -> usize {
    let mut best = 0;
    for i in 1..N {
        best = if costs[i] < costs[best] { i } else { best };
    }
    best
}

fn divide_more(items: &mut [Node4]) -> (usize, [Box4; 2]) {
    let n = items.len();
    let mut sorted = [Node4::VOID; MAX_SWEEP];
    let mut best_key = (f32::INFINITY, usize::MAX);
    let mut best = (1, [Box4::EMPTY; 2], [Node4::VOID; MAX_SWEEP]);
    for axis in 0..3 {
        sort(items, axis, &mut sorted[..n]);
        let mut right_sides = [Box4::EMPTY; MAX_SWEEP];
        let mut right = Box4::EMPTY;
        for i in (1..n).rev() {
            right = right.union(sorted[i].0);
            right_sides[i] = right;
        }
        let mut left = Box4::EMPTY;
        let before = best_key;
        for i in 1..n {
            left = left.union(sorted[i - 1].0);
            let right = right_sides[i];
            let cost = left.area() * i as f32 + right.area() * (n - i) as f32;
            let key = (cost, i.abs_diff(n - i));
            if key < best_key {
                best_key = key;
                (best.0, best.1) = (i, [left, right]);
            }
        }
        if best_key < before {
            best.2 = sorted;
        }
    }
    items.copy_from_slice(&best.2[..n]);
    (best.0, best.1)
}

/// By centroid, equal ones in their order. Counts for each item those before it: no branch depends
/// on the data.
fn sort(items: &[Node4], axis: usize, sorted: &mut [Node4]) {
    let mut keys = [f32::INFINITY; MAX_SWEEP];
    for (key, item) in keys.iter_mut().zip(items) {
        *key = item.centroid()[axis];
    }
    for (i, item) in items.iter().enumerate() {
        let before = |j: usize| u32::from((keys[j] < keys[i]) | ((keys[j] == keys[i]) & (j < i)));
        let place: u32 = (0..MAX_SWEEP).map(before).sum();
        sorted[place as usize] = *item;
    }
}
