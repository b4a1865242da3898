//! The traversal, on the CPU: the oracle of `shaders/accel/bvh.wgsl`, line by line.
//!
//! **No hit is lost to rounding.** A hit of the triangle test at t has an exact counterpart P in
//! the triangle near the ray: with s the ray parameter at P's coordinate on the dominant axis, P
//! lies beside the ray, on an axis i, by at most 10 u |s dᵢ| + 5 u w, where w is the longest side of
//! the triangle's box and u = 2⁻²⁴ (rounding of `v - o`, of the shear, of its two operations, and a
//! division by 2.5 ulp as Vulkan has it); and |t - s| ≤ 20 u s + 13 u w / |d|ₘₐₓ, since the
//! barycentrics are good to 8 u. A box computes its entry and exit to 7 u. So a box padded by 18 u w
//! is entered no later than t (1 + 37 u) and left no sooner than t (1 - 37 u): [`Aabb::padded`]
//! takes 32 u, and [`FAR_SLACK`] 64 u. Both the exit and the closest t so far are widened, so that
//! a box whose triangle ties with the closest hit is entered in whatever order boxes come, and
//! the hit does not depend on that order.

use super::{Bvh, BvhNode, MAX_DEPTH};
#[cfg(doc)]
use crate::geometry::Aabb;
use crate::geometry::Ray;
use crate::geometry::triangle::{RaySetup, intersect_triangle};
use glam::{BVec3, Vec3};

/// Factor on the far end of a box's interval, 1 + 2⁻¹⁸. An exact f32.
pub const FAR_SLACK: f32 = 1.000_003_8;

/// A direction component nearer to 0 than this is taken as this, with its sign, for the reciprocal.
const SMALLEST_DIRECTION: f32 = 1e-36;

/// No triangle.
const MISS: u32 = u32::MAX;

/// Marks a reference to a leaf: 4 bits below it hold the count, 27 the first triangle.
const LEAF_FLAG: u32 = 1 << 31;

/// The reference to nothing: that of a leaf of 15 triangles at 2²⁷ - 1, where no leaf can begin.
const NOTHING: u32 = u32::MAX;

/// The closest hit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hit {
    /// Ray parameter, 0 < t ≤ `t_max`.
    pub t: f32,
    /// Position of the triangle in the tree's order.
    pub triangle: u32,
    /// Barycentric coordinates of v0, v1, v2.
    pub b: [f32; 3],
    /// Whether v0, v1, v2 run clockwise as seen from the ray's origin.
    pub back_face: bool,
}

/// What the box test needs of a ray.
struct BoxSetup {
    origin: Vec3,
    inverse: Vec3,
    forward: BVec3,
}

impl BoxSetup {
    fn new(ray: &Ray) -> BoxSetup {
        let d = ray.direction;
        let inverse = Vec3::new(reciprocal(d.x), reciprocal(d.y), reciprocal(d.z));
        BoxSetup {
            origin: ray.origin,
            inverse,
            forward: inverse.cmpge(Vec3::ZERO),
        }
    }
}

/// 1 / d, finite.
fn reciprocal(d: f32) -> f32 {
    let smallest = if d >= 0.0 {
        SMALLEST_DIRECTION
    } else {
        -SMALLEST_DIRECTION
    };
    let safe = if d.abs() < SMALLEST_DIRECTION {
        smallest
    } else {
        d
    };
    1.0 / safe
}

/// Where the ray enters a box, at least 0; -1 where it misses it or enters beyond `t_max`.
///
/// Near and far faces are chosen by the ray's sign, so that an inverted box is missed.
fn box_entry(setup: &BoxSetup, min: [f32; 3], max: [f32; 3], t_max: f32) -> f32 {
    let (min, max) = (Vec3::from_array(min), Vec3::from_array(max));
    let near = (Vec3::select(setup.forward, min, max) - setup.origin) * setup.inverse;
    let far = (Vec3::select(setup.forward, max, min) - setup.origin) * setup.inverse;
    let entry = near.x.max(near.y).max(near.z.max(0.0));
    let exit = far.x.min(far.y).min(far.z.min(t_max)) * FAR_SLACK;
    if entry <= exit { entry } else { -1.0 }
}

/// What the stack keeps of a child.
fn reference(index: u32, count: u32) -> u32 {
    if count > 0 {
        LEAF_FLAG | (count << 27) | index
    } else {
        index
    }
}

impl Bvh {
    /// The closest hit; at equal t that with the smaller position in the tree.
    ///
    /// `triangles` are in the tree's order ([`Bvh::reorder`]); the tree has passed [`Bvh::validate`].
    pub fn intersect(&self, triangles: &[[Vec3; 3]], ray: &Ray) -> Option<Hit> {
        self.trace(triangles, ray, false)
    }

    /// Whether anything is hit at 0 < t ≤ `t_max`: `intersect(..).is_some()`, but faster.
    pub fn occluded(&self, triangles: &[[Vec3; 3]], ray: &Ray) -> bool {
        self.trace(triangles, ray, true).is_some()
    }

    fn trace(&self, triangles: &[[Vec3; 3]], ray: &Ray, any_hit: bool) -> Option<Hit> {
        let setup = RaySetup::new(ray.origin, ray.direction);
        let box_setup = BoxSetup::new(ray);
        let mut stack = [0u32; MAX_DEPTH as usize];
        let mut stack_size = 0;
        let mut best = Hit {
            t: ray.t_max,
            triangle: MISS,
            b: [0.0; 3],
            back_face: false,
        };
        let mut current = 0;
        loop {
            // Step down to the nearer child that is hit; the other has to wait.
            if current < LEAF_FLAG {
                let (near, far) = visit(&self.nodes[current as usize], &box_setup, best.t);
                current = near;
                if far != NOTHING {
                    stack[stack_size] = far;
                    stack_size += 1;
                }
            }
            // Test the triangles of a leaf.
            if current >= LEAF_FLAG && current != NOTHING {
                test_leaf(current, triangles, &setup, &mut best);
                current = NOTHING;
                if any_hit && best.triangle != MISS {
                    break;
                }
            }
            // Take up the child that was put aside last.
            if current == NOTHING {
                if stack_size == 0 {
                    break;
                }
                stack_size -= 1;
                current = stack[stack_size];
            }
        }
        (best.triangle != MISS).then_some(best)
    }
}

/// Tests both children of a node; returns those that are hit, the nearer one first.
fn visit(node: &BvhNode, setup: &BoxSetup, t_max: f32) -> (u32, u32) {
    let left_entry = box_entry(setup, node.left_min, node.left_max, t_max);
    let right_entry = box_entry(setup, node.right_min, node.right_max, t_max);
    let left = if left_entry < 0.0 {
        NOTHING
    } else {
        reference(node.left, node.left_count)
    };
    let right = if right_entry < 0.0 {
        NOTHING
    } else {
        reference(node.right, node.right_count)
    };
    let right_first = left == NOTHING || (right != NOTHING && right_entry < left_entry);
    if right_first {
        (right, left)
    } else {
        (left, right)
    }
}

/// Tests the triangles of a leaf and keeps the closest hit.
fn test_leaf(leaf: u32, triangles: &[[Vec3; 3]], setup: &RaySetup, best: &mut Hit) {
    let first = leaf & 0x07ff_ffff;
    let count = (leaf >> 27) & 15;
    for i in first..first + count {
        let [v0, v1, v2] = triangles[i as usize];
        if let Some(hit) = intersect_triangle(setup, v0, v1, v2)
            && (hit.t < best.t || (hit.t == best.t && i < best.triangle))
        {
            *best = Hit {
                t: hit.t,
                triangle: i,
                b: hit.b,
                back_face: hit.back_face,
            };
        }
    }
}
