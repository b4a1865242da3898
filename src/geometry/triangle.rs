//! Watertight ray–triangle intersection, after Woop, Benthin and Wald, *Watertight Ray/Triangle
//! Intersection*, JCGT 2(1), 2013.
//!
//! A ray maps each vertex to a point of the plane that it pierces at (0, 0). This mapping rounds,
//! but a vertex is mapped alike in every triangle that uses it, so a closed mesh stays closed; and
//! from there on every decision is exact ([`super::exact`] replaces the paper's f64). A ray through
//! an edge or a vertex counts as inside each triangle there: a double hit is possible, a gap is not.
//!
//! Differences from the paper: the edge functions of a triangle that may be hit are evaluated
//! again to 3 u, which decides exact zeros, and makes t and the barycentrics of a sliver as good as
//! those of any other triangle: t lies where the bounding boxes are (see `accel::traverse`).
//!
//! Range: with `x` the distance of a vertex from the ray (for a direction of any length), signs are
//! exact from x ≈ 2⁻³⁹ = 1.8e-12 m on. Below, the partial products underflow; the two triangles at
//! an edge still agree, and from x < 2⁻⁶³ = 1e-19 m on every triangle there counts as degenerate or
//! hit. Above 1e19 m the products overflow, and such a triangle is missed.
//!
//! Twin of `shaders/geometry/triangle.wgsl`, line by line.

use super::{Ray, exact::exact_edge, exact::exact_edge_refined};
use glam::{Vec2, Vec3};

/// What the triangle test needs of a ray: the shear that turns it into the third axis.
#[derive(Debug, Clone, Copy)]
pub struct RaySetup {
    origin: Vec3,
    /// Axis of the largest |direction|, 0 to 2.
    axis: u32,
    /// Whether the other two are swapped, which keeps the winding where that axis points back.
    swap: bool,
    /// Shear of x and y, scale of z.
    shear: Vec3,
}

/// A hit: t in lengths of the ray's direction, t > 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TriangleHit {
    /// Ray parameter.
    pub t: f32,
    /// Barycentric coordinates of v0, v1, v2; each in [0, 1], each to a relative error of 8 u.
    pub b: [f32; 3],
    /// Whether v0, v1, v2 run clockwise as seen from the ray's origin.
    pub back_face: bool,
}

impl RaySetup {
    /// Direction: finite and not zero.
    pub fn new(origin: Vec3, direction: Vec3) -> RaySetup {
        let size = direction.abs();
        let axis = if size.x >= size.y && size.x >= size.z {
            0
        } else if size.y >= size.z {
            1
        } else {
            2
        };
        let unswapped = permute(axis, false, direction);
        let swap = unswapped.z < 0.0;
        let d = permute(axis, swap, direction);
        let shear = Vec3::new(d.x / d.z, d.y / d.z, 1.0 / d.z);
        RaySetup {
            origin,
            axis,
            swap,
            shear,
        }
    }
}

/// `v` with `axis` last, in cyclic order, then the first two swapped if asked.
fn permute(axis: u32, swap: bool, v: Vec3) -> Vec3 {
    let cyclic = match axis {
        0 => Vec3::new(v.y, v.z, v.x),
        1 => Vec3::new(v.z, v.x, v.y),
        _ => v,
    };
    if swap {
        Vec3::new(cyclic.y, cyclic.x, cyclic.z)
    } else {
        cyclic
    }
}

/// The vertex in the ray's own space, where the ray is the third axis; z is its t.
fn exact_shear(setup: &RaySetup, vertex: Vec3) -> Vec3 {
    let p = permute(setup.axis, setup.swap, vertex - setup.origin);
    Vec3::new(
        p.x - setup.shear.x * p.z,
        p.y - setup.shear.y * p.z,
        setup.shear.z * p.z,
    )
}

/// Σ edge · z, from left to right.
pub(super) fn exact_depth(edges: Vec3, a: Vec3, b: Vec3, c: Vec3) -> f32 {
    (edges.x * a.z + edges.y * b.z) + edges.z * c.z
}

/// Whether two of the numbers have opposite signs; 0 has none.
fn signs_differ(e: Vec3) -> bool {
    (e.x < 0.0 || e.y < 0.0 || e.z < 0.0) && (e.x > 0.0 || e.y > 0.0 || e.z > 0.0)
}

/// A triangle in the ray's own space.
pub type Sheared = [Vec3; 3];

/// The triangles `(a, b, c)` and `(a, c, d)` of a fan in the ray's own space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FanCandidates {
    /// `a`, `b`, `c`, `d`.
    pub vertices: [Vec3; 4],
    /// The quick values of each triangle's edges, opposite to its vertices: right in sign where they
    /// are not 0.
    pub edges: [Vec3; 2],
    /// Whether [`intersect_triangle`] would go on with each after its quick test.
    pub candidates: [bool; 2],
}

impl FanCandidates {
    /// Triangle 0 or 1.
    pub fn triangle(&self, slot: usize) -> Sheared {
        let [a, b, c, d] = self.vertices;
        [[a, b, c], [a, c, d]][slot]
    }

    /// The hit by the quick values: as [`refined_hit`] has it, but less precise, and met wherever
    /// the quick edges leave it open. `t` may be 0, negative or not a number: then there is none.
    pub fn quick_hit(&self, slot: usize) -> TriangleHit {
        let (depth, determinant) = self.quick_fraction(slot);
        TriangleHit {
            t: depth / determinant,
            b: (self.edges[slot] / determinant).to_array(),
            back_face: determinant < 0.0,
        }
    }

    /// Whether 0 < t ≤ `t_max` by the quick values, without the division that t takes.
    pub fn is_met_within(&self, slot: usize, t_max: f32) -> bool {
        let (depth, determinant) = self.quick_fraction(slot);
        let sign = determinant.to_bits() & (1 << 31);
        let depth = f32::from_bits(depth.to_bits() ^ sign);
        depth > 0.0 && depth <= t_max * determinant.abs()
    }

    /// What quick t is the quotient of: depth and determinant.
    fn quick_fraction(&self, slot: usize) -> (f32, f32) {
        let [a, b, c] = self.triangle(slot);
        let edges = self.edges[slot];
        let determinant = (edges.x + edges.y) + edges.z;
        (exact_depth(edges, a, b, c), determinant)
    }
}

/// Intersects the ray of `setup` with a triangle, both sides; t is any positive number.
///
/// A triangle that the ray sees edge-on, or that is degenerate, is missed.
pub fn intersect_triangle(setup: &RaySetup, v0: Vec3, v1: Vec3, v2: Vec3) -> Option<TriangleHit> {
    let sheared = [v0, v1, v2].map(|v| exact_shear(setup, v));
    let [a, b, c] = sheared;
    // Reject by signs that are certain: most triangles end here.
    let quick = Vec3::new(
        exact_edge(xy(c), xy(b)),
        exact_edge(xy(a), xy(c)),
        exact_edge(xy(b), xy(a)),
    );
    if signs_differ(quick) {
        return None;
    }
    refined_hit(&sheared)
}

/// Both triangles of a fan after their quick test. The shared edge's value is found once: for the
/// other triangle it has the other sign, exactly.
pub fn fan_candidates(setup: &RaySetup, vertices: [Vec3; 4]) -> FanCandidates {
    let vertices = vertices.map(|v| exact_shear(setup, v));
    let [a, b, c, d] = vertices;
    let diagonal = exact_edge(xy(a), xy(c));
    let first = Vec3::new(exact_edge(xy(c), xy(b)), diagonal, exact_edge(xy(b), xy(a)));
    let second = Vec3::new(
        exact_edge(xy(d), xy(c)),
        exact_edge(xy(a), xy(d)),
        -diagonal,
    );
    FanCandidates {
        vertices,
        edges: [first, second],
        candidates: [!signs_differ(first), !signs_differ(second)],
    }
}

/// The second half of [`intersect_triangle`]: decides the zeros, and finds the values to nearly
/// full precision.
pub fn refined_hit(&[a, b, c]: &Sheared) -> Option<TriangleHit> {
    let edges = Vec3::new(
        exact_edge_refined(xy(c), xy(b)),
        exact_edge_refined(xy(a), xy(c)),
        exact_edge_refined(xy(b), xy(a)),
    );
    let determinant = (edges.x + edges.y) + edges.z;
    if signs_differ(edges) || determinant == 0.0 {
        return None;
    }
    let t = exact_depth(edges, a, b, c) / determinant;
    (t > 0.0).then(|| TriangleHit {
        t,
        b: (edges / determinant).to_array(),
        back_face: determinant < 0.0,
    })
}

fn xy(v: Vec3) -> Vec2 {
    Vec2::new(v.x, v.y)
}

/// Intersects one ray with one triangle: 0 < t ≤ `ray.t_max`.
pub fn intersect(ray: &Ray, triangle: &[Vec3; 3]) -> Option<TriangleHit> {
    let setup = RaySetup::new(ray.origin, ray.direction);
    let [v0, v1, v2] = *triangle;
    intersect_triangle(&setup, v0, v1, v2).filter(|hit| hit.t <= ray.t_max)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn unit() -> [Vec3; 3] {
        [Vec3::ZERO, Vec3::X, Vec3::Y]
    }

    #[test]
    fn counter_clockwise_is_the_front() {
        let point = Vec3::new(0.25, 0.5, 0.0);
        let from_above = intersect(&Ray::new(point + Vec3::Z * 2.0, -Vec3::Z), &unit());
        let from_below = intersect(&Ray::new(point - Vec3::Z * 2.0, Vec3::Z), &unit());
        let expected = |back_face| {
            Some(TriangleHit {
                t: 2.0,
                b: [0.25, 0.25, 0.5],
                back_face,
            })
        };
        assert_eq!(from_above, expected(false));
        assert_eq!(from_below, expected(true));
    }

    /// Facing, t and barycentrics must not depend on which axis dominates.
    #[test]
    fn every_dominant_axis_and_sign_gives_the_same_hit() {
        for turn in 0..3 {
            for sign in [1.0, -1.0] {
                let rotate = |v: Vec3| permute(turn, false, v);
                let triangle = unit().map(rotate);
                let origin = rotate(Vec3::new(0.25, 0.25, sign * 3.0));
                let hit = intersect(&Ray::new(origin, rotate(-Vec3::Z * sign)), &triangle);
                let hit = hit.expect("the ray aims at the triangle");
                assert_eq!((hit.t, hit.b), (3.0, [0.5, 0.25, 0.25]));
                assert_eq!(hit.back_face, sign < 0.0);
            }
        }
    }

    #[test]
    fn edges_and_vertices_belong_to_the_triangle() {
        for (x, y, inside) in [
            (0.0, 0.0, true),
            (1.0, 0.0, true),
            (0.0, 1.0, true),
            (0.5, 0.5, true),
            (0.5, 0.0, true),
            (0.5f32.next_up(), 0.5, false),
            (-f32::MIN_POSITIVE, 0.5, false),
            (0.5, -1e-20, false),
        ] {
            let ray = Ray::new(Vec3::new(x, y, 1.0), -Vec3::Z);
            assert_eq!(intersect(&ray, &unit()).is_some(), inside, "{x} {y}");
        }
    }

    #[test]
    fn t_max_belongs_to_the_ray_and_zero_does_not() {
        let mut ray = Ray::new(Vec3::new(0.25, 0.25, 1.0), -Vec3::Z);
        ray.t_max = 1.0;
        assert!(intersect(&ray, &unit()).is_some());
        ray.t_max = 1f32.next_down();
        assert!(intersect(&ray, &unit()).is_none());
        assert!(intersect(&Ray::new(Vec3::new(0.25, 0.25, 0.0), -Vec3::Z), &unit()).is_none());
        assert!(intersect(&Ray::new(Vec3::new(0.25, 0.25, -1.0), -Vec3::Z), &unit()).is_none());
    }

    #[test]
    fn degenerate_edge_on_and_overflowing_triangles_are_missed() {
        let ray = Ray::new(Vec3::new(-1.0, 0.25, 0.0), Vec3::X);
        assert_eq!(intersect(&ray, &unit()), None);
        for triangle in [
            [Vec3::ZERO; 3],
            [Vec3::ZERO, Vec3::ONE, Vec3::ONE],
            [Vec3::ZERO, Vec3::ONE, Vec3::ONE * 0.5],
            unit().map(|v| (v - 0.25) * 1e30),
        ] {
            assert_eq!(
                intersect(&Ray::new(Vec3::Z * 2.0, -Vec3::Z), &triangle),
                None
            );
        }
    }

    /// A sliver whose edge functions cancel: t must still be where the ray meets it.
    #[test]
    fn slivers_are_placed_correctly() {
        let sliver = [
            Vec3::new(0.3, 0.4, 1.0),
            Vec3::new(1.3, 1.7, 2.0),
            Vec3::new(0.3, 0.400_000_1, 1.0),
        ];
        let mut hits = 0;
        for i in 1..1000 {
            let s = i as f32 / 1000.0;
            let target = sliver[0].lerp(sliver[1], s).lerp(sliver[2], 0.3);
            let origin = Vec3::new(target.x, target.y, -1.0);
            if let Some(hit) = intersect(&Ray::new(origin, Vec3::Z), &sliver) {
                hits += 1;
                let b = hit.b.map(f64::from);
                let x: f64 = (0..3).map(|k| b[k] * f64::from(sliver[k].x)).sum();
                assert!((x - f64::from(origin.x)).abs() < 4e-7, "{x} {}", origin.x);
                let z: f64 = (0..3).map(|k| b[k] * f64::from(sliver[k].z)).sum();
                assert!((z + 1.0 - f64::from(hit.t)).abs() < 1e-6);
            }
        }
        assert!(hits > 300, "{hits}");
    }
}
