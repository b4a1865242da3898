//! The structure of a tiny scene: no tree, just its pairs, each tested by every ray. The oracle of
//! `shaders/accel/list.wgsl`, operation for operation.
//!
//! Hits are put in order by the t of the quick edges, and only the closest is found again to nearly
//! full precision. The quick t is a mean of the vertices' t with weights of one sign, so it is within
//! the triangle but for a few u; how exact it is within depends on how the ray sees the triangle, just
//! as the rounding of its vertices' places does. So a hit where the ray starts may be lost or made.
//!
//! A triangle that the ray sees so nearly edge-on that all its quick edges are 0 is missed, which the
//! exact test may find. Its neighbours at the same place, whose quick test leaves them open there, are
//! met instead, if they are not all such slivers.

use super::element::Element;
use super::traverse::{Hit, MISS, Steps};
use crate::geometry::Ray;
use crate::geometry::triangle::{RaySetup, TriangleHit, fan_candidates, refined_hit};

/// The closest hit by the quick t; of equal ones the first.
pub(super) fn trace(elements: &[Element], ray: &Ray, steps: &mut Steps) -> Option<Hit> {
    let setup = RaySetup::new(ray.origin, ray.direction);
    // A hit at t_max counts, and what counts is below this.
    let mut closest = f32::from_bits(ray.t_max.to_bits() + 1);
    let mut triangle = MISS;
    for (i, element) in elements.iter().enumerate() {
        steps.pairs += 1;
        let fan = fan_candidates(&setup, element.vertices());
        for slot in 0..2 {
            let t = fan.quick_hit(slot).t;
            if fan.candidates[slot] && t > 0.0 && t < closest {
                closest = t;
                triangle = 2 * i as u32 + slot as u32;
            }
        }
    }
    (triangle != MISS).then(|| refine(elements, triangle, &setup))
}

/// Whether anything is met at 0 < t ≤ `t_max`, found without t.
pub(super) fn occluded(elements: &[Element], ray: &Ray) -> bool {
    let setup = RaySetup::new(ray.origin, ray.direction);
    elements.iter().any(|element| {
        let fan = fan_candidates(&setup, element.vertices());
        (0..2).any(|slot| fan.candidates[slot] && fan.is_met_within(slot, ray.t_max))
    })
}

/// The hit on a triangle. Beside an edge the quick test may have left open what the exact one denies:
/// there the quick values are the hit, lest none of the triangles at the edge be met.
fn refine(elements: &[Element], triangle: u32, setup: &RaySetup) -> Hit {
    let fan = fan_candidates(setup, elements[triangle as usize / 2].vertices());
    let slot = (triangle & 1) as usize;
    let exact = refined_hit(&fan.triangle(slot));
    let TriangleHit { t, b, back_face } = exact.unwrap_or_else(|| fan.quick_hit(slot));
    Hit {
        t,
        triangle,
        b,
        back_face,
    }
}
