//! Pairs of triangles that share an edge: the leaves of the tree.
//!
//! Two tests that share an edge share most of their work and of the memory that they read. A pair
//! is a fan of four vertices `a, b, c, d`: the triangles `(a, b, c)` and `(a, c, d)`, so both wind
//! the same way. A triangle without a partner is a pair of one.

mod matching;
mod sides;
#[cfg(test)]
mod tests;

use glam::Vec3;
use matching::Matching;
use rayon::prelude::*;

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
    /// Its one or two triangles.
    pub fn triangles(&self) -> impl Iterator<Item = Turned> + use<> {
        [Some(self.first), self.second].into_iter().flatten()
    }

    /// The fan's vertices; without a second triangle the fourth is the first again.
    pub fn vertices(&self, triangles: &[[Vec3; 3]]) -> [Vec3; 4] {
        let at = |t: Turned| t.corners(triangles[t.triangle as usize]);
        let [a, b, c] = at(self.first);
        let d = self.second.map_or(a, |second| at(second)[2]);
        [a, b, c, d]
    }
}

/// Puts every triangle in one pair, wherever in the input its partner is. Parallel; the same input
/// gives the same pairs. At most [`super::MAX_TRIANGLES`], which the caller checks.
pub fn pairs(triangles: &[[Vec3; 3]]) -> Vec<Pair> {
    let matching = Matching::new(triangles);
    let turned = |triangle, first| Turned { triangle, first };
    let pair = |triangle: u32| match matching.shared_sides(triangle) {
        None => Some(Pair {
            first: turned(triangle, 0),
            second: None,
        }),
        // Listed where its first triangle is.
        Some([own, other]) if own < other => Some(Pair {
            first: turned(triangle, (own % 3 + 1) as u8 % 3),
            second: Some(turned(other / 3, (other % 3) as u8)),
        }),
        Some(_) => None,
    };
    let all = 0..triangles.len() as u32;
    all.into_par_iter().filter_map(pair).collect()
}
