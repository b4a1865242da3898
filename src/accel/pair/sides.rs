//! Which sides of triangles meet: those that join the same two points in opposite directions.

use glam::Vec3;
use rayon::prelude::*;
use std::sync::atomic::{AtomicU32, Ordering};

/// Triangles whose sides one task puts into bins.
const CHUNK: usize = 1 << 15;

/// Sides in a bin: their sort stays in a near cache.
const BIN: usize = 1 << 14;

/// Most bins, as a power of two.
const MAX_BIN_BITS: u32 = 12;

/// The lowest bits of a record hold the side's number: there are fewer than 3 · 2²⁷.
const NUMBER_BITS: u32 = 29;

/// The bit that tells both directions of a side apart.
const DIRECTION: u64 = 1 << NUMBER_BITS;

/// Above it: the hash of the side's ends, without their order.
const HASH_SHIFT: u32 = NUMBER_BITS + 1;

/// For each side the one that seems to meet it. Side k of triangle t, from its vertex k to the next,
/// has the number 3 t + k.
pub(super) struct Neighbours(Vec<AtomicU32>);

impl Neighbours {
    /// Where more than two sides meet, they go together by twos in the order of their numbers.
    pub fn new(triangles: &[[Vec3; 3]]) -> Neighbours {
        let sides = 3 * triangles.len();
        let bits = (sides / BIN).max(1).ilog2().min(MAX_BIN_BITS);
        let chunks = triangles.par_chunks(CHUNK).enumerate();
        let chunks: Vec<Binned> = chunks
            .map_init(Vec::new, |scratch, (i, chunk)| {
                Binned::new(chunk, i * CHUNK, bits, scratch)
            })
            .collect();
        // Filled by all threads, since the first touch of memory takes time.
        let none = |_| AtomicU32::new(NONE);
        let neighbours = Neighbours((0..sides).into_par_iter().map(none).collect());
        let bins = (0..1 << bits).into_par_iter();
        bins.for_each_init(Vec::new, |records, bin| {
            records.clear();
            chunks
                .iter()
                .for_each(|chunk| records.extend_from_slice(chunk.bin(bin)));
            // A sort takes little longer where many sides are the same, as a hash table would.
            records.sort_unstable();
            neighbours.link(records);
        });
        neighbours
    }

    /// The side with the same hash as a given one, in the opposite direction. Whether they really
    /// meet is still to be seen.
    pub fn of(&self, side: u32) -> Option<u32> {
        let other = self.0[side as usize].load(Ordering::Relaxed);
        (other != NONE).then_some(other)
    }

    /// Sets the neighbours of sorted records, which are all that there are with their hashes.
    fn link(&self, records: &[u64]) {
        for equal in records.chunk_by(|a, b| a >> HASH_SHIFT == b >> HASH_SHIFT) {
            let middle = equal.partition_point(|record| record & DIRECTION == 0);
            let (forward, backward) = equal.split_at(middle);
            for (a, b) in forward.iter().zip(backward) {
                let [a, b] = [a, b].map(|record| (record & (DIRECTION - 1)) as u32);
                if a / 3 != b / 3 {
                    self.0[a as usize].store(b, Ordering::Relaxed);
                    self.0[b as usize].store(a, Ordering::Relaxed);
                }
            }
        }
    }
}

/// Marks a side without a neighbour.
const NONE: u32 = u32::MAX;

/// Records of sides, in order of their bins: the highest bits of their hashes.
struct Binned {
    records: Vec<u64>,
    /// Where each bin begins; last, where all end.
    starts: Vec<u32>,
}

impl Binned {
    /// Records of triangles of which the first has the number `first`; `scratch` is only there to be
    /// used again.
    fn new(triangles: &[[Vec3; 3]], first: usize, bits: u32, scratch: &mut Vec<u64>) -> Binned {
        scratch.clear();
        let numbers = (3 * first as u64..).step_by(3);
        let sides = numbers.zip(triangles).flat_map(|(n, t)| records(n, t));
        scratch.extend(sides.flatten());
        // In two steps, since a shift by all 64 bits is none.
        let bin = |record: u64| (record >> 1 >> (63 - bits)) as usize;
        let mut starts = vec![0; (1 << bits) + 1];
        for &record in scratch.iter() {
            starts[bin(record) + 1] += 1;
        }
        for i in 1..starts.len() {
            starts[i] += starts[i - 1];
        }
        let mut next = starts.clone();
        let mut records = vec![0; scratch.len()];
        for &record in scratch.iter() {
            let place = &mut next[bin(record)];
            records[*place as usize] = record;
            *place += 1;
        }
        Binned { records, starts }
    }

    fn bin(&self, bin: usize) -> &[u64] {
        &self.records[self.starts[bin] as usize..self.starts[bin + 1] as usize]
    }
}

/// The sides of a triangle, of which the first has a given number; none for a side without length.
fn records(number: u64, triangle: &[Vec3; 3]) -> [Option<u64>; 3] {
    let hashes = triangle.map(hash);
    [0, 1, 2].map(|k| {
        let [from, to] = [hashes[k], hashes[(k + 1) % 3]];
        let both = from.wrapping_add(to).wrapping_mul(0xd6e8_feb8_6659_fd93);
        let direction = if from > to { DIRECTION } else { 0 };
        (from != to).then_some(both >> HASH_SHIFT << HASH_SHIFT | direction | (number + k as u64))
    })
}

/// Multiplies and folds: quick, and good enough for coordinates. -0 counts as 0.
fn hash(point: Vec3) -> u64 {
    let [x, y, z] = (point + Vec3::ZERO)
        .to_array()
        .map(|c| u64::from(c.to_bits()));
    let mixed = (x | y << 32).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    let mixed = (mixed ^ mixed >> 32 ^ z << 16).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    mixed ^ mixed >> 31
}
