//! Sorts keys by their high bits.

use rayon::prelude::*;

/// Bits a pass.
const DIGIT: u32 = 9;
const BUCKETS: usize = 1 << DIGIT;

/// Fewer keys than this are not worth a thread of their own.
const SHORTEST_PART: usize = 1 << 15;

/// Stable sort by the bits from `low` to `high`. The bits above must be 0, and equal keys in order of
/// all of their bits already, so that the result is sorted by all bits.
pub(super) fn sort(mut keys: Vec<u64>, low: u32, high: u32) -> Vec<u64> {
    let threads = rayon::current_num_threads();
    let part = keys.len().div_ceil(threads).max(SHORTEST_PART);
    let mut other = keys.clone();
    let parts = keys.par_chunks_mut(part).zip(other.par_chunks_mut(part));
    parts.for_each(|(keys, other)| sort_part(keys, other, low, high));
    let mut sorted = part;
    while sorted < keys.len() {
        let pairs = keys
            .par_chunks(2 * sorted)
            .zip(other.par_chunks_mut(2 * sorted));
        pairs.for_each(|(keys, out)| {
            let (a, b) = keys.split_at(sorted.min(keys.len()));
            merge(a, b, out);
        });
        std::mem::swap(&mut keys, &mut other);
        sorted *= 2;
    }
    keys
}

/// From the lowest digit to the highest, back and forth.
fn sort_part(keys: &mut [u64], other: &mut [u64], low: u32, high: u32) {
    let mut is_in_other = false;
    for shift in (low..high).step_by(DIGIT as usize) {
        let moved = match is_in_other {
            false => pass(keys, other, shift),
            true => pass(other, keys, shift),
        };
        is_in_other ^= moved;
    }
    if is_in_other {
        keys.copy_from_slice(other);
    }
}

/// Whether it had to move anything.
fn pass(keys: &[u64], out: &mut [u64], shift: u32) -> bool {
    let digit = |key: u64| (key >> shift) as usize & (BUCKETS - 1);
    let mut counts = [0u32; BUCKETS];
    for &key in keys {
        counts[digit(key)] += 1;
    }
    if counts.iter().any(|&count| count as usize == keys.len()) {
        return false;
    }
    let mut first = 0;
    for count in &mut counts {
        first += std::mem::replace(count, first);
    }
    for &key in keys {
        let place = &mut counts[digit(key)];
        out[*place as usize] = key;
        *place += 1;
    }
    true
}

/// Merges sorted runs; halves the work until it is small enough for a thread.
fn merge(a: &[u64], b: &[u64], out: &mut [u64]) {
    if a.len() < b.len() {
        return merge(b, a, out);
    }
    if out.len() <= SHORTEST_PART || b.is_empty() {
        return merge_part(a, b, out);
    }
    let i = a.len() / 2;
    let j = b.partition_point(|key| *key < a[i]);
    let (left, right) = out.split_at_mut(i + j);
    rayon::join(
        || merge(&a[..i], &b[..j], left),
        || merge(&a[i..], &b[j..], right),
    );
}

fn merge_part(a: &[u64], b: &[u64], out: &mut [u64]) {
    let (mut i, mut j) = (0, 0);
    for out in out {
        // Without branches: which run is next is as good as random.
        let (x, y) = (a.get(i).copied(), b.get(j).copied());
        let from_a = y.is_none_or(|y| x.is_some_and(|x| x < y));
        *out = if from_a { x } else { y }.unwrap_or_default();
        i += usize::from(from_a);
        j += usize::from(!from_a);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn agrees_with_the_standard_sort() {
        for n in [0, 1, 2, 1000, 70_000, 300_001] {
            let mix = |i: u64| (i + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 28 << 28;
            let keys: Vec<u64> = (0..n).map(|i| mix(i % 50_000) | i).collect();
            let mut expected = keys.clone();
            expected.sort_unstable();
            for threads in [1, 2, 3, 7] {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
                let sorted = pool
                    .expect("threads")
                    .install(|| sort(keys.clone(), 28, 64));
                assert!(sorted == expected, "{n} keys, {threads} threads");
            }
        }
    }
}
