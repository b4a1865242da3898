//! The traversal, on the CPU: the oracle of `shaders/accel/bvh.wgsl`, line by line.
//!
//! **No hit is lost to rounding.** A hit of the triangle test at t has an exact counterpart P in
//! the triangle near the ray: with s the ray parameter at P's coordinate on the dominant axis, P
//! lies beside the ray, on an axis i, by at most 10 u |s dᵢ| + 5 u w, where w is the longest side of
//! the triangle's box and u = 2⁻²⁴ (rounding of `v - o`, of the shear, of its two operations, and a
//! division by 2.5 ulp as Vulkan has it); and |t - s| ≤ 20 u s + 13 u w / |d|ₘₐₓ, since the
//! barycentrics are good to 8 u.
//!
//! A plane of a box is q steps from the node's origin, and t = (origin - o) / d + q (step / d).
//! The first term is good to 7 u of itself (a difference, a reciprocal of 2.5 ulp, a product), the
//! second to 6 u (a reciprocal, a product; steps are powers of two), their sum is rounded once, and
//! the first term is no larger than t and 255 steps together. So a plane's t is wrong by at most
//! 8 u |t|, and by 13 u · 255 = 2^-12.3 steps, of which boxes have [`MARGIN`] = 2⁻¹⁰ to spare; with
//! q = 0 the sum is the first term, and there are no steps to be wrong by.
//!
//! So a box padded by 18 u w is entered no later than t (1 + 38 u) and left no sooner than
//! t (1 - 38 u), and its own entry is no later than its exit by more than 36 u:
//! [`Aabb::padded`] takes 32 u, and [`FAR_SLACK`] 64 u. Both the exit and the closest t so far are
//! widened, so that a box whose triangle ties with the closest hit is entered in whatever order boxes
//! come, and the hit does not depend on that order.
//!
//! A direction component nearer to 0 than [`SMALLEST_SHARE`] of the largest moves by less than 2⁻⁵⁹
//! of the distance from what the boxes are tested with. The padding that the above leaves, 14 u w,
//! is more than this for every triangle larger than 2⁻³⁸ of its distance.

#[cfg(doc)]
use super::element::MARGIN;
use super::element::{Element, WIDTH};
use super::two_level::HEADER;
use super::{Bvh, MAX_DEPTH, list};
#[cfg(doc)]
use crate::geometry::Aabb;
use crate::geometry::Ray;
use crate::geometry::triangle::{RaySetup, fan_candidates, refined_hit};
use glam::Vec3;

/// Factor on the far end of a box's interval, 1 + 2⁻¹⁸. An exact f32.
pub const FAR_SLACK: f32 = 1.000_003_8;

/// A direction component nearer to 0 than this share of the largest is taken as this for the
/// reciprocal, 2⁻⁶⁰, so that nothing overflows within 10¹⁹ m.
const SMALLEST_SHARE: f32 = 8.673_617_4e-19;

/// No triangle.
pub(super) const MISS: u32 = u32::MAX;

/// Marks a reference to a pair.
const LEAF_FLAG: u32 = 1 << 31;

/// The closest hit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hit {
    /// Ray parameter, 0 < t ≤ `t_max`.
    pub t: f32,
    /// The triangle: 2 × the index of its pair's element, + 1 for the second of the pair
    /// ([`Bvh::position`]); in an instance 2 × the pair's number there ([`Bvh::resolve`]).
    pub triangle: u32,
    /// Barycentric coordinates of v0, v1, v2.
    pub b: [f32; 3],
    /// Whether v0, v1, v2 run clockwise as seen from the ray's origin.
    pub back_face: bool,
}

/// What a traversal did.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Steps {
    /// Nodes whose children's boxes were tested.
    pub nodes: u64,
    /// Pairs that were tested.
    pub pairs: u64,
}

/// What the box test needs of a ray.
struct BoxSetup {
    origin: Vec3,
    inverse: Vec3,
}

impl BoxSetup {
    fn new(ray: &Ray) -> BoxSetup {
        let d = ray.direction;
        let least = d.abs().max_element() * SMALLEST_SHARE;
        let inverse = |d: f32| {
            1.0 / if d.abs() < least {
                least.copysign(d)
            } else {
                d
            }
        };
        BoxSetup {
            origin: ray.origin,
            inverse: Vec3::new(inverse(d.x), inverse(d.y), inverse(d.z)),
        }
    }
}

/// Children that are hit and wait: a node's last header word, their slots + 1 in 4 bits each with
/// the next one lowest, and the bits of a t that none of them is entered before.
#[derive(Debug, Clone, Copy, Default)]
struct Group {
    header: u32,
    slots: u32,
    entry: u32,
}

impl Group {
    /// Whether there is a child that may hold a closer hit.
    fn is_worth_it(&self, t_max: f32) -> bool {
        self.slots != 0 && f32::from_bits(self.entry) <= t_max * FAR_SLACK
    }

    /// The reference to the next child, which is taken out.
    fn take(&mut self) -> u32 {
        let slot = (self.slots & 15) - 1;
        self.slots >>= 4;
        let element = (self.header >> 4) + slot;
        if slot < (self.header & 15) {
            element
        } else {
            element | LEAF_FLAG
        }
    }
}

impl Bvh {
    /// The closest hit; at equal t that with the smaller number. A list puts hits in order by a t
    /// that is good to a few u of the triangle's extent along the ray only (`accel::list`).
    ///
    /// The structure has passed [`Bvh::validate`].
    pub fn intersect(&self, ray: &Ray) -> Option<Hit> {
        self.trace(ray, false, &mut Steps::default())
    }

    /// Whether anything is hit at 0 < t ≤ `t_max`: `intersect(..).is_some()`, but faster; in a list a hit whose t is
    /// `t_max` but for rounding may be on either side.
    pub fn occluded(&self, ray: &Ray) -> bool {
        if self.is_list() {
            return list::occluded(&self.elements, ray);
        }
        self.trace(ray, true, &mut Steps::default()).is_some()
    }

    /// [`Bvh::intersect`], or with `any_hit` the first hit found, which counts its steps.
    pub fn trace(&self, ray: &Ray, any_hit: bool, steps: &mut Steps) -> Option<Hit> {
        if self.is_list() {
            return list::trace(&self.elements, ray, steps);
        }
        let mut best = Hit {
            t: ray.t_max,
            triangle: MISS,
            b: [0.0; 3],
            back_face: false,
        };
        self.trace_level(ray, (0, 0), any_hit, steps, &mut best);
        (best.triangle != MISS).then_some(best)
    }

    /// Traverses the world, or an instance from its root: `(root, shift)`, where the numbers of hits are those of
    /// the elements and so much more. The device does the same with one stack, on which it notes where to return.
    fn trace_level(
        &self,
        ray: &Ray,
        (root, shift): (u32, u32),
        any_hit: bool,
        steps: &mut Steps,
        best: &mut Hit,
    ) {
        let setup = RaySetup::new(ray.origin, ray.direction);
        let box_setup = BoxSetup::new(ray);
        let mut stack = [Group::default(); MAX_DEPTH as usize];
        let mut stack_size = 0;
        let mut group = Group::default();
        let mut current = root;
        'traversal: loop {
            let element = &self.elements[(current & !LEAF_FLAG) as usize];
            if current < LEAF_FLAG {
                steps.nodes += 1;
                let children = visit(element, &box_setup, best.t);
                if children.slots != 0 {
                    if group.slots != 0 {
                        stack[stack_size] = group;
                        stack_size += 1;
                    }
                    group = children;
                }
            } else if self.has_instances() && element.is_instance() {
                // Counts as a node.
                steps.nodes += 1;
                let instance = &self.instances[self.instance_of(element)];
                let inside = instance.placement.ray(ray);
                let level = (element.words[12], element.words[14]);
                self.trace_level(&inside, level, any_hit, steps, best);
            } else {
                steps.pairs += 1;
                let number = (current & !LEAF_FLAG) + shift;
                test_pair(element, number, &setup, best);
            }
            if any_hit && best.triangle != MISS {
                break;
            }
            // Go on with the children that were put aside last.
            while !group.is_worth_it(best.t) {
                if stack_size == 0 {
                    break 'traversal;
                }
                stack_size -= 1;
                group = stack[stack_size];
            }
            current = group.take();
        }
    }

    /// Index of the instance that a leaf stands for.
    fn instance_of(&self, leaf: &Element) -> usize {
        (leaf.words[15] - self.elements[HEADER].words[0]) as usize
    }
}

/// Positive numbers are in the order of their bits, and all negative ones are before them.
fn bits(t: f32) -> i32 {
    t.to_bits() as i32
}

/// Tests the children of a node; those that are hit, the nearest first.
fn visit(element: &Element, setup: &BoxSetup, t_max: f32) -> Group {
    let node = element.decode();
    let start = (node.origin - setup.origin) * setup.inverse;
    let step = node.step * setup.inverse;
    let mut keys = [0; WIDTH];
    for (slot, key) in keys.iter_mut().enumerate() {
        let t = |plane: usize| {
            let axis = plane / 2;
            start[axis] + f32::from(node.planes[plane][slot]) * step[axis]
        };
        // Near and far planes are chosen by the ray's sign, so that an inverted box is missed.
        let near = |axis: usize| t(2 * axis + usize::from(setup.inverse[axis] < 0.0));
        let far = |axis: usize| t(2 * axis + usize::from(setup.inverse[axis] >= 0.0));
        let entry = bits(near(0)).max(bits(near(1))).max(bits(near(2)).max(0));
        let exit = bits(far(0))
            .min(bits(far(1)))
            .min(bits(far(2)).min(bits(t_max)));
        let exit = bits(f32::from_bits(exit as u32) * FAR_SLACK);
        let is_hit = entry <= exit && (slot as u32) < node.children;
        let nearness = if is_hit { entry as u32 } else { u32::MAX } & !15;
        *key = nearness | if is_hit { slot as u32 + 1 } else { 0 };
    }
    keys.sort_unstable();
    let slots = keys
        .iter()
        .rev()
        .fold(0, |slots, key| slots << 4 | key & 15);
    Group {
        header: element.words[3],
        slots,
        entry: keys[0] & !15,
    }
}

/// Tests both triangles of a pair, which has this number, and keeps the closest hit.
fn test_pair(element: &Element, index: u32, setup: &RaySetup, best: &mut Hit) {
    let fan = fan_candidates(setup, element.vertices());
    for slot in 0..2 {
        if !fan.candidates[slot] {
            continue;
        }
        let triangle = 2 * index + slot as u32;
        if let Some(hit) = refined_hit(&fan.triangle(slot))
            && (hit.t < best.t || (hit.t == best.t && triangle < best.triangle))
        {
            *best = Hit {
                t: hit.t,
                triangle,
                b: hit.b,
                back_face: hit.back_face,
            };
        }
    }
}
