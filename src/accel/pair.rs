//! Pairs of triangles that share an edge: the leaves of the tree.
//!
//! Two tests that share an edge share most of their work and of the memory that they read. A pair
//! is a fan of four vertices `a, b, c, d`: the triangles `(a, b, c)` and `(a, c, d)`, so both wind
//! the same way. Pairs are looked for among triangles that are near each other in the input, which
//! in files made by tools is nearly all of them; a triangle without a partner is a pair of one.

use crate::geometry::Aabb;
use glam::Vec3;
use rayon::prelude::*;
use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::hash::{BuildHasherDefault, Hasher};

/// Triangles within which partners are looked for.
const CHUNK: usize = 1 << 14;

/// A pair's box may have this many times the surface of both triangles' boxes together, no more.
const MAX_GROWTH: f64 = 1.0;

/// A triangle of the input, its vertices turned so that the one named comes first.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Turned {
    /// Index of the triangle in the input.
    pub triangle: u32,
    /// Which of its vertices, 0 to 2, comes first.
    pub first: u8,
}

impl Turned {
    /// Its three corners in the new order.
    pub fn corners<T: Copy>(self, [a, b, c]: [T; 3]) -> [T; 3] {
        match self.first {
            0 => [a, b, c],
            1 => [b, c, a],
            _ => [c, a, b],
        }
    }
}

/// One triangle, or two that share the edge from the first vertex to the third of the first one,
/// which is the edge from the first vertex to the second of the second one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Pair {
    /// The first triangle.
    pub first: Turned,
    /// The second, if there is one.
    pub second: Option<Turned>,
}

impl Pair {
    /// The fan's vertices; without a second triangle the fourth is the first again.
    pub fn vertices(&self, triangles: &[[Vec3; 3]]) -> [Vec3; 4] {
        let at = |t: Turned| t.corners(triangles[t.triangle as usize]);
        let [a, b, c] = at(self.first);
        let d = self.second.map_or(a, |second| at(second)[2]);
        [a, b, c, d]
    }
}

/// Puts every triangle in one pair. Parallel; the same input gives the same pairs.
pub fn pairs(triangles: &[[Vec3; 3]]) -> Vec<Pair> {
    let chunks = triangles.par_chunks(CHUNK).enumerate();
    let found: Vec<Vec<Pair>> = chunks
        .map(|(i, chunk)| pairs_of_chunk(chunk, (i * CHUNK) as u32))
        .collect();
    found.concat()
}

fn pairs_of_chunk(triangles: &[[Vec3; 3]], offset: u32) -> Vec<Pair> {
    let mut search = Search {
        waiting: HashMap::with_capacity_and_hasher(2 * triangles.len(), BuildHasherDefault::new()),
        partner: vec![None; triangles.len()],
        triangles,
    };
    (0..triangles.len()).for_each(|i| search.add(i));
    let partner = &search.partner;
    let turned = |i: usize, first: u8| Turned {
        triangle: offset + i as u32,
        first,
    };
    let pair = |i: usize| match partner[i] {
        None => Some(Pair {
            first: turned(i, 0),
            second: None,
        }),
        // Listed where its later triangle is.
        Some(p) if p.other < i => Some(Pair {
            first: turned(i, (p.edge + 1) % 3),
            second: Some(turned(p.other, p.other_edge)),
        }),
        Some(_) => None,
    };
    (0..triangles.len()).filter_map(pair).collect()
}

/// Edge k of a triangle goes from its vertex k to the next.
#[derive(Debug, Clone, Copy)]
struct Partner {
    other: usize,
    edge: u8,
    other_edge: u8,
}

struct Search<'a> {
    triangles: &'a [[Vec3; 3]],
    /// Directed edges of triangles without a partner.
    waiting: HashMap<[u32; 6], (usize, u8), BuildHasherDefault<EdgeHasher>>,
    partner: Vec<Option<Partner>>,
}

impl Search<'_> {
    /// Gives a triangle the best partner that waits, or makes it wait.
    fn add(&mut self, i: usize) {
        let triangle = self.triangles[i];
        let mut best: Option<(f64, Partner)> = None;
        for edge in 0..3 {
            let key = edge_key(triangle[(edge + 1) % 3], triangle[edge]);
            let Some(&(other, other_edge)) = self.waiting.get(&key) else {
                continue;
            };
            if self.partner[other].is_some() {
                continue;
            }
            let growth = growth(&triangle, &self.triangles[other]);
            if growth <= best.map_or(MAX_GROWTH, |b| b.0) {
                let edge = edge as u8;
                let partner = Partner {
                    other,
                    edge,
                    other_edge,
                };
                best = Some((growth, partner));
            }
        }
        match best {
            Some((_, partner)) => self.join(i, partner),
            None => self.wait(i),
        }
    }

    fn join(&mut self, i: usize, partner: Partner) {
        self.partner[i] = Some(partner);
        self.partner[partner.other] = Some(Partner {
            other: i,
            edge: partner.other_edge,
            other_edge: partner.edge,
        });
    }

    fn wait(&mut self, i: usize) {
        let triangle = self.triangles[i];
        for edge in 0..3 {
            let key = edge_key(triangle[edge], triangle[(edge + 1) % 3]);
            match self.waiting.entry(key) {
                Entry::Vacant(place) => {
                    place.insert((i, edge as u8));
                }
                // The one that waited has found a partner.
                Entry::Occupied(mut place) if self.partner[place.get().0].is_some() => {
                    place.insert((i, edge as u8));
                }
                Entry::Occupied(_) => {}
            }
        }
    }
}

/// Surface of the box around both over that of their boxes together; 0 for boxes without surface.
fn growth(a: &[Vec3; 3], b: &[Vec3; 3]) -> f64 {
    let (a, b) = (Aabb::from_points(a), Aabb::from_points(b));
    let separate = a.half_area() + b.half_area();
    let together = a.union(b).half_area();
    if together > 0.0 {
        together / separate
    } else {
        0.0
    }
}

/// The bits of both ends; -0 counts as 0.
fn edge_key(from: Vec3, to: Vec3) -> [u32; 6] {
    let (a, b) = (from + Vec3::ZERO, to + Vec3::ZERO);
    [a.x, a.y, a.z, b.x, b.y, b.z].map(f32::to_bits)
}

/// Multiplies and folds: quick, and good enough for coordinates.
#[derive(Default)]
struct EdgeHasher(u64);

impl Hasher for EdgeHasher {
    fn write(&mut self, bytes: &[u8]) {
        for word in bytes.chunks(8) {
            let mut padded = [0; 8];
            padded[..word.len()].copy_from_slice(word);
            let mixed = (self.0 ^ u64::from_le_bytes(padded)).wrapping_mul(0x9e37_79b9_7f4a_7c15);
            self.0 = mixed ^ (mixed >> 32);
        }
    }

    fn write_usize(&mut self, _: usize) {}

    fn finish(&self) -> u64 {
        self.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Checks that every triangle is in one pair and each pair is a fan that winds as its triangles
    /// do; gives the number of pairs of two.
    fn check(triangles: &[[Vec3; 3]]) -> usize {
        let pairs = pairs(triangles);
        let mut seen = vec![false; triangles.len()];
        for pair in &pairs {
            let [a, b, c, d] = pair.vertices(triangles);
            let turned = [
                Some((pair.first, [a, b, c])),
                pair.second.map(|t| (t, [a, c, d])),
            ];
            for (t, expected) in turned.into_iter().flatten() {
                let index = t.triangle as usize;
                assert!(!seen[index], "triangle {index} is in two pairs");
                seen[index] = true;
                // Turned, not mirrored.
                assert_eq!(t.corners(triangles[index]), expected);
            }
            if pair.second.is_none() {
                assert_eq!(d, a);
            }
        }
        assert!(seen.iter().all(|&seen| seen));
        assert_eq!(pairs, super::pairs(triangles));
        pairs.iter().filter(|pair| pair.second.is_some()).count()
    }

    fn grid(n: usize) -> Vec<[Vec3; 3]> {
        let vertex = |i: usize, j: usize| Vec3::new(i as f32, j as f32, (i * j) as f32 * 0.01);
        let cell = |k: usize| {
            let (i, j) = (k / n, k % n);
            let (a, c) = (vertex(i, j), vertex(i + 1, j + 1));
            [[a, vertex(i + 1, j), c], [a, c, vertex(i, j + 1)]]
        };
        (0..n * n).flat_map(cell).collect()
    }

    #[test]
    fn a_grid_pairs_completely() {
        assert_eq!(check(&grid(1)), 1);
        assert_eq!(check(&grid(20)), 400);
        // More than one chunk.
        assert_eq!(check(&grid(100)), 10_000);
    }

    #[test]
    fn whichever_vertex_comes_first_an_edge_is_found() {
        let [first, second] = [grid(1)[0], grid(1)[1]];
        let turn = |[a, b, c]: [Vec3; 3], n: usize| [[a, b, c], [b, c, a], [c, a, b]][n];
        for i in 0..3 {
            for j in 0..3 {
                let (first, second) = (turn(first, i), turn(second, j));
                assert_eq!(check(&[first, second]), 1);
                assert_eq!(check(&[second, first]), 1);
            }
        }
    }

    #[test]
    fn triangles_that_wind_differently_are_no_fan() {
        let [first, [a, b, c]] = [grid(1)[0], grid(1)[1]];
        assert_eq!(check(&[first, [a, c, b]]), 0);
        // Nor are those that touch in a vertex, or nowhere.
        assert_eq!(check(&[first, first.map(|v| v - 10.0)]), 0);
        assert_eq!(check(&[first, first.map(|v| first[0] * 2.0 - v)]), 0);
    }

    #[test]
    fn zeros_of_both_signs_are_one_vertex() {
        let triangle = [Vec3::ZERO, Vec3::X, Vec3::Y];
        let other = [-Vec3::ZERO, Vec3::new(-0.0, 1.0, -0.0), -Vec3::X];
        assert_eq!(check(&[triangle, other]), 1);
    }

    #[test]
    fn degenerate_and_equal_triangles_are_each_in_one_pair() {
        check(&[]);
        let triangle = [Vec3::ZERO, Vec3::X, Vec3::Y];
        // Equal triangles run along an edge the same way.
        assert_eq!(check(&[triangle; 5]), 0);
        check(&[[Vec3::ONE; 3]; 5]);
        check(&[[Vec3::ZERO, Vec3::X, Vec3::X]; 4]);
        check(&[
            triangle,
            [Vec3::X, Vec3::ZERO, Vec3::X],
            [Vec3::ZERO, Vec3::X, Vec3::ZERO],
        ]);
        let [a, b, c] = triangle;
        check(&[triangle, [a, c, b], triangle, [b, a, c], triangle]);
    }

    /// Long diagonal neighbours would make boxes that rays rarely miss.
    #[test]
    fn a_pair_s_box_is_no_larger_than_both_boxes() {
        let flat = [
            Vec3::ZERO,
            Vec3::new(100.0, 0.1, 0.0),
            Vec3::new(0.0, 0.1, 0.0),
        ];
        let steep = [flat[1], flat[0], Vec3::new(0.0, 0.0, 100.0)];
        assert_eq!(
            check(&[flat, steep]),
            usize::from(growth(&flat, &steep) <= MAX_GROWTH)
        );
        for pair in pairs(&grid(20)) {
            let second = pair.second.expect("a pair of two");
            let at = |t: Turned| grid(20)[t.triangle as usize];
            assert!(growth(&at(pair.first), &at(second)) <= MAX_GROWTH);
        }
    }
}
