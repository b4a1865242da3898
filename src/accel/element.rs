//! What a tree is made of on the device: elements of 64 bytes, a cache line, each of them a wide
//! node or a pair of triangles. A traversal loads an element before it looks which of the two it is.

use crate::geometry::Aabb;
use bytemuck::{Pod, Zeroable};
use glam::Vec3;

/// Most children of a node.
pub const WIDTH: usize = 8;

/// Most elements of a tree: a node keeps the first of its children in 28 bits.
pub const MAX_ELEMENTS: usize = 1 << 28;

/// A wide node or a pair, as 16 words.
///
/// A **pair** is the vertices `a, b, c, d` of the triangles `(a, b, c)` and `(a, c, d)`, three
/// words each; then the position of the first triangle in the tree's order (the second one's is
/// the next); then three words that belong to the tree's owner. A pair of one has `d = a`.
///
/// A **node** has up to eight children, elements that are neighbours, the nodes among them first.
/// Their boxes are on a grid of the node's own, 8 bits a coordinate:
///
/// | word | bits from the lowest |
/// |---|---|
/// | 0 | 5 grid exponent, 4 finer x, 2 unused, 21 x |
/// | 1 | 8 origin exponent, 3 number of children - 1, 21 y |
/// | 2 | 4 finer y, 4 finer z, 3 unused, 21 z |
/// | 3 | 4 number of nodes among the children, 28 the first child |
/// | 4 to 15 | x low, x high, y low, y high, z low, z high: 8 bytes each, a byte a child |
///
/// The grid's origin is x, y, z (two's complement) times 2^(origin exponent - 127); its step on an
/// axis is 2^(origin exponent + grid exponent - 8 - finer - 127). Decoded boxes hold the padded ones
/// with [`MARGIN`] steps to spare, but for planes at 0 steps.
///
/// A structure of two levels has more kinds: a header, instances among the leaves, and their records
/// ([`super::Instance`], [`super::TwoLevel`]).
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq, Pod, Zeroable)]
pub struct Element {
    /// As described above.
    pub words: [u32; 16],
}

/// Steps of the grid by which a decoded box is larger than the one it stands for on each side, at
/// least: covers the rounding of a traversal that works in steps (`accel::traverse`).
pub const MARGIN: f64 = 1.0 / 1024.0;

/// Boxes end so many metres from the coordinates' origin on each axis, 2^64: what a ray meets farther
/// away is lost. Triangles of such a size are missed in any case (`geometry::triangle`), and steps must
/// not overflow times the largest reciprocal of a unit vector's component, 2^60.
const REACH: f32 = 18_446_744_073_709_551_616.0;

/// The part of a box within [`REACH`]; of one beyond, its nearest face.
fn within_reach(bounds: &Aabb) -> Aabb {
    let clamped = |v: Vec3| v.clamp(Vec3::splat(-REACH), Vec3::splat(REACH));
    Aabb {
        min: clamped(bounds.min),
        max: clamped(bounds.max),
    }
}

/// Added to exponents so that they are not negative.
const BIAS: i32 = 127;

/// The grid of a node.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Grid {
    /// Multiples of the origin's unit.
    origin: [i32; 3],
    /// Biased exponent of the origin's unit, 1 to 254.
    unit: i32,
    /// Biased exponents of the steps, 1 to 254.
    steps: [i32; 3],
    /// The one that the others are relative to, no smaller than any of them.
    longest: i32,
}

/// A node, decoded.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Node {
    /// Origin of the grid.
    pub origin: Vec3,
    /// Step of the grid on each axis, a power of two.
    pub step: Vec3,
    /// Number of children, 1 to 8.
    pub children: u32,
    /// Nodes among them; these come first.
    pub inner: u32,
    /// The element that is the first child.
    pub first: u32,
    /// Low x, high x, low y, high y, low z, high z of each child, in steps.
    pub planes: [[u8; WIDTH]; 6],
}

/// 2^(exponent - 127).
fn power(biased: i32) -> f64 {
    2f64.powi(biased - BIAS)
}

/// The biased exponent of the largest power of two that is no larger than x > 0.
fn exponent(x: f64) -> i32 {
    ((x.to_bits() >> 52) & 0x7ff) as i32 - 1023 + BIAS
}

impl Grid {
    /// The finest grid whose 256 lines an axis cover a box.
    pub fn around(bounds: &Aabb) -> Grid {
        let (low, high) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
        let largest = low.abs().max_element();
        // 20 bits and a sign hold the origin.
        let mut unit = (exponent(largest.max(f64::MIN_POSITIVE)) - 19).clamp(1, 254);
        loop {
            let origin = low.to_array().map(|x| (x / power(unit)).floor() as i32);
            let step = |i: usize| {
                let size = high[i] - f64::from(origin[i]) * power(unit);
                step_exponent(size)
            };
            let mut steps = [step(0), step(1), step(2)];
            let longest = steps[0].max(steps[1]).max(steps[2]).max(unit - 8);
            if longest - unit + 8 > 31 {
                unit = longest + 8 - 31;
                continue;
            }
            steps = steps.map(|s| s.max(longest - 15).max(1));
            return Grid {
                origin,
                unit,
                steps,
                longest,
            };
        }
    }

    /// A box in steps, rounded outwards.
    fn quantised(&self, bounds: &Aabb) -> [u8; 6] {
        let mut planes = [0; 6];
        for i in 0..3 {
            let origin = f64::from(self.origin[i]) * power(self.unit);
            let in_steps = |x: f32| (f64::from(x) - origin) / power(self.steps[i]);
            planes[2 * i] = (in_steps(bounds.min[i]) - MARGIN).floor().clamp(0.0, 255.0) as u8;
            planes[2 * i + 1] = (in_steps(bounds.max[i]) + MARGIN).ceil().clamp(0.0, 255.0) as u8;
        }
        planes
    }
}

/// The biased exponent of the smallest step of which 254 reach over a size; one is left to round.
fn step_exponent(size: f64) -> i32 {
    let step = size / 254.0;
    let floor = exponent(step.max(f64::MIN_POSITIVE));
    let exact = power(floor) >= step;
    (floor + i32::from(!exact)).clamp(1, 254)
}

impl Element {
    /// A node over padded boxes of its children, 1 to 8 of them, the first `inner` being nodes.
    pub(super) fn node(boxes: &[Aabb], inner: u32, first: u32) -> Element {
        let boxes: Vec<Aabb> = boxes.iter().map(within_reach).collect();
        let bounds = boxes.iter().fold(Aabb::EMPTY, |a, &b| a.union(b));
        let grid = Grid::around(&bounds);
        let finer = grid.steps.map(|s| (grid.longest - s) as u32);
        let [x, y, z] = grid.origin.map(|x| (x << 11) as u32);
        let mut words = [0; 16];
        words[0] = x | (grid.longest - grid.unit + 8) as u32 | finer[0] << 5;
        words[1] = y | grid.unit as u32 | (boxes.len() as u32 - 1) << 8;
        words[2] = z | finer[1] | finer[2] << 4;
        words[3] = first << 4 | inner;
        let mut planes = [[0_u8; WIDTH]; 6];
        for (child, bounds) in boxes.iter().enumerate() {
            for (plane, value) in planes.iter_mut().zip(grid.quantised(bounds)) {
                plane[child] = value;
            }
        }
        for (word, bytes) in words[4..]
            .iter_mut()
            .zip(planes.as_flattened().chunks_exact(4))
        {
            *word = u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]);
        }
        Element { words }
    }

    /// A pair; the owner's words are 0.
    pub(super) fn pair(vertices: [Vec3; 4], first: u32) -> Element {
        let mut words = [0; 16];
        for (i, v) in vertices.iter().enumerate() {
            words[3 * i..3 * i + 3].copy_from_slice(&v.to_array().map(f32::to_bits));
        }
        words[12] = first;
        Element { words }
    }

    /// The vertices of a pair.
    pub fn vertices(&self) -> [Vec3; 4] {
        let float = |i: usize| f32::from_bits(self.words[i]);
        [0, 3, 6, 9].map(|i| Vec3::new(float(i), float(i + 1), float(i + 2)))
    }

    /// The two triangles of a pair; of a pair of one the second is degenerate.
    pub fn triangles(&self) -> [[Vec3; 3]; 2] {
        let [a, b, c, d] = self.vertices();
        [[a, b, c], [a, c, d]]
    }

    /// Position of a pair's first triangle in the tree's order.
    pub fn first_triangle(&self) -> u32 {
        self.words[12]
    }

    /// Decodes a node, as the device does.
    pub(super) fn decode(&self) -> Node {
        let w = &self.words;
        let unit = w[1] & 255;
        let longest = (unit + (w[0] & 31)).wrapping_sub(8);
        let float = |biased: u32| f32::from_bits(biased << 23);
        let coordinate = |word: u32| (word as i32 >> 11) as f32 * float(unit);
        let finer = Vec3::new(
            float(longest.wrapping_sub((w[0] >> 5) & 15)),
            float(longest.wrapping_sub(w[2] & 15)),
            float(longest.wrapping_sub((w[2] >> 4) & 15)),
        );
        let mut planes = [[0; WIDTH]; 6];
        for (plane, words) in planes.iter_mut().zip(w[4..].chunks_exact(2)) {
            plane[..4].copy_from_slice(&words[0].to_le_bytes());
            plane[4..].copy_from_slice(&words[1].to_le_bytes());
        }
        Node {
            origin: Vec3::new(coordinate(w[0]), coordinate(w[1]), coordinate(w[2])),
            step: finer,
            children: ((w[1] >> 8) & 7) + 1,
            inner: w[3] & 15,
            first: w[3] >> 4,
            planes,
        }
    }
}

impl Node {
    /// The box of a child.
    pub fn child_box(&self, child: usize) -> Aabb {
        let corner = |high: usize| {
            let at = |axis: usize| self.plane(axis, high, child) as f32;
            Vec3::new(at(0), at(1), at(2))
        };
        Aabb {
            min: corner(0),
            max: corner(1),
        }
    }

    /// Whether the box of a child holds what of another is within [`REACH`], with [`MARGIN`] to spare
    /// on each side, but for planes through the grid's origin, of which a traversal is sure enough.
    pub fn holds(&self, child: usize, other: &Aabb) -> bool {
        if other.is_empty() {
            return true;
        }
        let other = within_reach(other);
        (0..3).all(|axis| {
            let [origin, step] = [self.origin, self.step].map(|v| f64::from(v[axis]));
            // As `Grid::quantised` has it.
            let in_steps = |x: f32| (f64::from(x) - origin) / step;
            let [low, high] = [0, 1].map(|high| self.planes[2 * axis + high][child]);
            let low_margin = if low == 0 { 0.0 } else { MARGIN };
            step > 0.0
                && f64::from(low) <= in_steps(other.min[axis]) - low_margin
                && f64::from(high) >= in_steps(other.max[axis]) + MARGIN
        })
    }

    /// A plane of a child's box, metres; `high` is 0 or 1.
    fn plane(&self, axis: usize, high: usize, child: usize) -> f64 {
        let steps = f64::from(self.planes[2 * axis + high][child]);
        f64::from(self.origin[axis]) + steps * f64::from(self.step[axis])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn span(min: [f32; 3], max: [f32; 3]) -> Aabb {
        Aabb {
            min: Vec3::from(min),
            max: Vec3::from(max),
        }
    }

    /// Encodes and decodes; checks the counts and that every box is held, with its margin.
    fn round_trip(boxes: &[Aabb]) -> Node {
        let padded: Vec<Aabb> = boxes.iter().map(Aabb::padded).collect();
        let inner = boxes.len() as u32 / 2;
        let node = Element::node(&padded, inner, 12_345).decode();
        assert_eq!(node.children as usize, boxes.len());
        assert_eq!((node.inner, node.first), (inner, 12_345));
        for (i, bounds) in padded.iter().enumerate() {
            assert!(node.holds(i, bounds), "{boxes:?}: {i}: {node:?}");
        }
        node
    }

    #[test]
    fn extreme_boxes_are_held() {
        let unit = span([-1.0; 3], [1.0; 3]);
        let times = |s: f32| span([-s, -s, 0.5 * s], [s, 0.25 * s, s]);
        let at = |x: f32, size: f32| span([x, -x, 0.0], [x + size, -x + size, size]);
        for bounds in [
            unit,
            times(1e-30),
            times(1e-42),
            times(1e18),
            times(1e30),
            times(f32::MAX),
            at(1e6, 1e-3),
            at(-1e9, 1.0),
            at(1e18, 0.0),
            span([0.0; 3], [0.0; 3]),
            span([5.0, -1.0, 1.0], [5.0, 1.0, 1.0]),
            span([0.0, 0.0, 0.0], [1e18, 1e-18, 1.0]),
            span([-2.0, 0.0, 1e-30], [30.0, 1e30, 2e-30]),
        ] {
            round_trip(&[bounds]);
            round_trip(&[bounds, unit]);
            round_trip(&[bounds, times(1e-30), at(1e6, 1e-3)]);
        }
    }

    #[test]
    fn up_to_eight_children_are_held_closely() {
        let child = |i: usize| {
            let x = i as f32 * 0.75 - 3.0;
            span([x, -x, 7.0], [x + 0.5, 0.25 - x, 7.0])
        };
        for n in 1..=WIDTH {
            let boxes: Vec<Aabb> = (0..n).map(child).collect();
            let node = round_trip(&boxes);
            for (i, bounds) in boxes.iter().enumerate() {
                let decoded = node.child_box(i);
                let looseness = (bounds.min - decoded.min).max(decoded.max - bounds.max);
                assert!(
                    looseness.cmple(2.0 * node.step + 1e-4).all(),
                    "{n}, {i}: {looseness}"
                );
            }
        }
    }

    /// Boxes of all sizes at all places.
    #[test]
    fn random_boxes_are_held() {
        let mut state = 1_u64;
        let mut next = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            (state >> 33) as u32
        };
        // Sign, exponent and fraction are all random; no infinities.
        let mut any = || f32::from_bits(next() << 1 ^ next()).clamp(f32::MIN, f32::MAX);
        for i in 0..20_000 {
            let mut point = || [any(), any(), any()].map(|x| if x.is_nan() { 0.0 } else { x });
            let boxes: Vec<Aabb> = (0..i % WIDTH + 1)
                .map(|_| Aabb::from_points(&[Vec3::from(point()), Vec3::from(point())]))
                .collect();
            round_trip(&boxes);
        }
    }

    /// Negative control: a box that is larger by a step is not held.
    #[test]
    fn a_larger_box_is_not_held() {
        let bounds = span([-1.0, 2.0, 3.0], [4.0, 5.0, 6.0]);
        let node = round_trip(&[bounds, span([-2.0; 3], [9.0; 3])]);
        for axis in 0..3 {
            let mut larger = node.child_box(0);
            larger.max[axis] = larger.max[axis].next_up();
            assert!(!node.holds(0, &larger), "{axis}");
            let mut smaller = node.child_box(0);
            smaller.min[axis] = smaller.min[axis].next_down();
            assert!(!node.holds(0, &smaller), "{axis}");
        }
        assert!(node.holds(0, &Aabb::EMPTY));
    }

    #[test]
    fn a_pair_keeps_its_vertices() {
        let [a, b, c, d] = [Vec3::X, Vec3::Y, Vec3::Z, Vec3::splat(-0.0)];
        let element = Element::pair([a, b, c, d], 77);
        assert_eq!(element.vertices(), [a, b, c, d]);
        assert_eq!(element.triangles(), [[a, b, c], [a, c, d]]);
        assert_eq!(
            (element.first_triangle(), &element.words[13..]),
            (77, &[0; 3][..])
        );
    }
}
