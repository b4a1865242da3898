//! Bounds on the t of a hit before its edges are refined: most hits are put in order by these alone.
//!
//! Twin of `exact_t_bounds` in `shaders/geometry/triangle.wgsl`.

#[cfg(doc)]
use super::triangle::refined_hit;
use super::triangle::{FanCandidates, exact_depth};

/// Of the edges' errors, 2⁻²³.
const EDGE_SLACK: f32 = 1.192_092_9e-7;
/// Of all other rounding, 2⁻¹⁸.
const DEPTH_SLACK: f32 = 3.814_697_3e-6;
/// Of products that are too small for an f32, 2⁻¹²².
const UNDERFLOW_SLACK: f32 = 1.880_790_9e-37;
/// An edge from which on its sign is certain, 2⁻⁹⁰.
const LEAST_EDGE: f32 = 8.077_936e-28;
/// Coordinates up to which nothing overflows, 2⁴⁰.
const LARGEST: f32 = 1.099_511_6e12;

/// Bounds on the t that [`refined_hit`] computes for a triangle whose quick test has passed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TBounds {
    /// Where this is positive there is a hit.
    pub low: f32,
    /// Where this is negative there is none.
    pub high: f32,
    /// Whether any of this is so.
    pub certain: bool,
}

impl FanCandidates {
    /// The bounds for triangle 0 or 1, which is a candidate.
    ///
    /// Let Xᵢ be the exact edges, eᵢ the quick and Eᵢ the refined ones, all of one sign, zᵢ the
    /// vertices' t, T(e) = Σ eᵢ zᵢ / Σ eᵢ, and u = 2⁻²⁴.
    ///
    /// - T(e) - T(X) = Σ (eᵢ - Xᵢ)(zᵢ - T(X)) / Σ eᵢ, with |eᵢ - Xᵢ| ≤ u (mᵢ + |eᵢ|), where mᵢ is the
    ///   sum of the sizes of the edge's two products. With S the sum of the sizes of all six coordinates,
    ///   Σ mᵢ ≤ S² / 3, and Σ |eᵢ| is no larger (but for rounding); |zᵢ - T(X)| is at most the span of
    ///   the zᵢ. That is less than a third of the first term below.
    /// - |Eᵢ - Xᵢ| ≤ 3 u |Xᵢ|, so |T(E) - T(X)| ≤ 6 u max |zᵢ|. The sums and the quotient round either
    ///   to within 3 u + 2 u + 5 u (a division of 2.5 ulp) of max |zᵢ|. DEPTH_SLACK is 64 u of the sum
    ///   of the |zᵢ|.
    /// - Products below 2⁻¹²⁶ may be flushed to 0: five in either sum, four here.
    ///
    /// An edge of at least 2⁻⁹⁰ keeps its sign: either its products are above 2⁻⁷⁸, where refining is
    /// exact, or they do not cancel to more than 2⁻¹² of themselves.
    pub fn t_bounds(&self, slot: usize) -> TBounds {
        let [a, b, c] = self.triangle(slot);
        let edges = self.edges[slot];
        let determinant = (edges.x + edges.y) + edges.z;
        let t = exact_depth(edges, a, b, c) / determinant;
        let size = (a.x.abs() + a.y.abs()) + (b.x.abs() + b.y.abs()) + (c.x.abs() + c.y.abs());
        let span = (a.z - b.z).abs() + (c.z - b.z).abs();
        let depth = (a.z.abs() + b.z.abs()) + c.z.abs();
        let edge_error = EDGE_SLACK * (span * (size * size)) + UNDERFLOW_SLACK;
        let error = edge_error / determinant.abs() + DEPTH_SLACK * depth;
        let least = edges.abs().min_element();
        TBounds {
            low: t - error,
            high: t + error,
            certain: least >= LEAST_EDGE && size < LARGEST && depth < LARGEST,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::triangle::{RaySetup, fan_candidates, refined_hit};
    use super::*;
    use glam::Vec3;
    use proptest::prelude::*;

    /// Sees the triangle (and no other) along the z axis from the origin.
    fn fan(triangle: [Vec3; 3]) -> FanCandidates {
        let [a, b, c] = triangle;
        fan_candidates(&RaySetup::new(Vec3::ZERO, Vec3::Z), [a, b, c, c])
    }

    fn check(triangle: [Vec3; 3]) -> Option<TBounds> {
        let fan = fan(triangle);
        let bounds = fan.candidates[0].then(|| fan.t_bounds(0))?;
        if !bounds.certain {
            return None;
        }
        match refined_hit(&fan.triangle(0)) {
            Some(hit) => assert!(
                bounds.low <= hit.t && hit.t <= bounds.high,
                "{triangle:?}: {} is not in {bounds:?}",
                hit.t
            ),
            None => assert!(bounds.low <= 0.0, "{triangle:?}: {bounds:?}"),
        }
        Some(bounds)
    }

    fn number() -> impl Strategy<Value = f32> {
        (-16_777_215i32..16_777_216, -90i32..20).prop_map(|(m, e)| m as f32 * 2f32.powi(e))
    }

    /// Three points around the ray, with the third so that the ray passes beside an edge or a vertex.
    fn around(a: Vec3, b: Vec3, along: f32, beside: f32, z: f32) -> [Vec3; 3] {
        let opposite = -(a * along + b * (1.0 - along)) * (1.0 + beside);
        [a, b, opposite.with_z(z)]
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(100_000))]

        #[test]
        fn the_refined_t_is_within(
            x in prop::array::uniform3(-1f32..1.0), y in prop::array::uniform3(-1f32..1.0),
            z in prop::array::uniform3(-3f32..10.0), scale in -44i32..38, depth in -70i32..30, far in 0i32..40,
        ) {
            let away = if far < 20 { far as f32 * 1e4 } else { 0.0 };
            let vertex = |i: usize| {
                let z = (z[i] + away) * 2f32.powi(depth);
                Vec3::new(x[i], y[i], 0.0) * 2f32.powi(scale) + Vec3::Z * z
            };
            check([0, 1, 2].map(vertex));
        }

        #[test]
        fn the_refined_t_of_slivers_is_within(
            a in prop::array::uniform3(-1f32..1.0), b in prop::array::uniform3(-1f32..1.0), z in -3f32..10.0,
            along in 0f32..1.0, beside in -1e-6f32..1e-6, thin in -24i32..1, scale in -40i32..40,
        ) {
            let [a, b] = [a, b].map(Vec3::from);
            let flat = Vec3::new(1.0, 2f32.powi(thin), 1.0) * 2f32.powi(scale);
            check(around(a, b, along, beside, z).map(|v| v * flat));
        }

        #[test]
        fn the_refined_t_of_any_numbers_is_within(v in prop::array::uniform9(number())) {
            check([0, 3, 6].map(|i| Vec3::new(v[i], v[i + 1], v[i + 2])));
        }
    }

    #[test]
    fn bounds_of_a_triangle_of_ordinary_shape_are_narrow() {
        let triangle = [(-1.0, -1.0, 4.9), (2.0, -1.0, 5.0), (0.0, 2.0, 5.3)];
        let bounds = check(triangle.map(Vec3::from)).expect("certain");
        assert!(bounds.high - bounds.low < 2e-4, "{bounds:?}");
    }

    #[test]
    fn what_is_behind_or_out_of_range_is_known() {
        let at =
            |z: f32, s: f32| [(-s, -s, z), (2.0 * s, -s, z), (0.0, 2.0 * s, z)].map(Vec3::from);
        assert!(check(at(-1.0, 1.0)).is_some_and(|b| b.high < 0.0));
        assert!(check(at(1.0, 1.0)).is_some_and(|b| b.low > 0.0));
        for uncertain in [
            at(1.0, 1e-15),
            at(1.0, 1e13),
            at(1e13, 1.0),
            at(f32::NAN, 1.0),
        ] {
            assert_eq!(check(uncertain), None);
        }
        let on_an_edge = [(0.0, -1.0, 1.0), (1.0, 0.0, 1.0), (0.0, 1.0, 1.0)].map(Vec3::from);
        assert_eq!(check(on_an_edge), None);
    }
}
