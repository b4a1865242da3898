//! Few boxes: every split along each axis is tried, instead of bins.

use super::boxes::{Box4, Item};

/// Most boxes that are swept; with more, bins take less time.
pub(super) const MAX_SWEEP: usize = 8;

/// The best way to divide 2 to [`MAX_SWEEP`] boxes: reorders them; gives the number that goes left
/// and the bounds of both sides.
pub(super) fn divide(items: &mut [Item], bounds: Box4) -> (usize, [Box4; 2]) {
    if let [a, b] = items {
        return (1, [a.0, b.0]);
    }
    let scale = bounds.area_scale();
    let mut best: Option<(f32, u32)> = None;
    let mut chosen = (0, 1, [Box4::EMPTY; 2]);
    let n = items.len();
    for axis in 0..3 {
        sort(items, axis);
        let mut right_sides = [Box4::EMPTY; MAX_SWEEP];
        let mut right = Box4::EMPTY;
        for i in (1..n).rev() {
            right = right.union(items[i].0);
            right_sides[i] = right;
        }
        let mut left = Box4::EMPTY;
        for i in 1..n {
            left = left.union(items[i - 1].0);
            let right = right_sides[i];
            let cost =
                left.scaled_area(scale) * i as f32 + right.scaled_area(scale) * (n - i) as f32;
            let key = (cost, i.abs_diff(n - i) as u32);
            if best.is_none_or(|best| key < best) {
                best = Some(key);
                chosen = (axis, i, [left, right]);
            }
        }
    }
    let (axis, middle, sides) = chosen;
    if axis < 2 {
        sort(items, axis);
    }
    (middle, sides)
}

/// By centroid; insertion suits few items, most of them in order from their last sort.
fn sort(items: &mut [Item], axis: usize) {
    let key = |item: &Item| (item.centroid()[axis], item.index());
    for i in 1..items.len() {
        let mut j = i;
        while j > 0 && key(&items[j]) < key(&items[j - 1]) {
            items.swap(j, j - 1);
            j -= 1;
        }
    }
}
