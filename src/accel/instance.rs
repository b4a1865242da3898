//! A tree that is placed in the world, possibly many times.
//!
//! A ray that reaches an instance is turned into the tree's own space and goes on there. Its direction is
//! not made a unit vector again, so t means the same in both spaces, and hits on different instances are put in
//! order by it.
//!
//! **What rounding does.** Let G be the matrix to the tree's space and c the tree's origin in the world, both as
//! they are in f32: where the instance *is* follows from these alone, p = G⁻¹ q + c for a point q of the tree. They
//! are the same for every ray, so they move no part of an instance against another, and a closed mesh stays closed:
//! in the tree's space there is one ray, as it was computed, and all that [`super::traverse`] proves holds for it.
//!
//! That ray is not quite the image of the ray in the world. With u = 2⁻²⁴ and B = G⁻¹, its origin is wrong by
//! 4 u |G| |o - c| (a difference, three products, two sums), its direction by 3 u |G| |d|, and the triangle test
//! accepts what passes beside it by 10 u t |G| |d|. So it meets what lies beside the ray in the world by no more
//! than |B| |G| (4 u |o - c| + 13 u t |d|). Let R be as in [`TwoLevel::reach`], beyond which nothing is on any axis, and let
//! a ray start no farther from the world's origin than √3 R, as every point of the world does. Then both |o - c| and t |d|
//! are less than 3 R: an instance's box in the world is padded by [`BOX_ERROR`] = 20 u of 3 |B| |G| R, on top of what any box
//! is padded by.

use super::element::{Element, Node};
use crate::geometry::{Aabb, Ray};
use glam::{DMat3, DVec3, Vec3};

#[cfg(doc)]
use super::TwoLevel;

/// In word 13 of an element that is a leaf: it is an instance. The owner of pairs leaves this bit clear.
pub const INSTANCE_FLAG: u32 = 1 << 31;

/// See above; 20 · 2⁻²⁴.
const BOX_ERROR: f64 = 20.0 / 16_777_216.0;

/// Largest sum of a row of |G⁻¹| |G|: errors of a placement grow with it. It is at most 3 for any scales along three
/// axes, turned in any way, and larger under shear alone.
const MAX_CONDITION: f64 = 64.0;

/// Largest scale of a placement and of its inverse, 2⁴⁰; nothing overflows within 10¹⁹ m.
const MAX_SCALE: f64 = 1_099_511_627_776.0;

/// Entries of a matrix that are nearer to 0 are 0, 2⁻¹⁰⁰: some devices flush smaller products.
const SMALLEST: f64 = 7.888_609_052_210_118e-31;

/// Where a tree is in the world.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Placement {
    /// Index of the tree.
    pub tree: usize,
    /// Rows of the matrix that turns the world's directions into the tree's.
    inverse: [Vec3; 3],
    /// Where the tree's origin is in the world, metres.
    center: Vec3,
}

impl Placement {
    /// Places a tree by a matrix and its origin's position in the world, metres. None where the matrix is singular,
    /// shears too much, or is out of range: such a placement's triangles have to be turned into the world
    /// one by one.
    pub fn new(tree: usize, linear: DMat3, center: DVec3) -> Option<Placement> {
        let inverse = rows(linear.inverse()).map(|row| flushed(row).as_vec3());
        let placement = Placement {
            tree,
            inverse,
            center: center.as_vec3(),
        };
        let size = |m: DMat3| {
            m.to_cols_array()
                .into_iter()
                .map(f64::abs)
                .fold(0.0, f64::max)
        };
        let sizes = [
            size(linear),
            size(placement.backward()),
            size(placement.forward()),
        ];
        let is_moderate = sizes
            .iter()
            .all(|s| (1.0 / MAX_SCALE..=MAX_SCALE).contains(s));
        // Not a number where the matrix is singular.
        let is_regular = placement.condition() <= MAX_CONDITION;
        let is_near = center.abs().max_element() < 1e18;
        (is_moderate && is_regular && is_near).then_some(placement)
    }

    /// G as it is in f32.
    fn backward(&self) -> DMat3 {
        let [x, y, z] = self.inverse.map(Vec3::as_dvec3);
        DMat3::from_cols(x, y, z).transpose()
    }

    /// G⁻¹: the tree's directions in the world.
    pub fn forward(&self) -> DMat3 {
        self.backward().inverse()
    }

    /// Where the tree's origin is in the world, metres.
    pub fn center(&self) -> Vec3 {
        self.center
    }

    /// |G⁻¹| |G|.
    fn spread(&self) -> DMat3 {
        absolute(self.forward()) * absolute(self.backward())
    }

    /// Largest sum of a row of |G⁻¹| |G|, at least 1.
    fn condition(&self) -> f64 {
        let sums = rows(self.spread()).map(|row| row.element_sum());
        // Unlike `max`, this keeps what is not a number.
        sums.into_iter()
            .fold(1.0, |a, b| if b <= a { a } else { b })
    }

    /// A ray of the world in the tree's space. Twin of `exact_to_tree` in `shaders/accel/instance.wgsl`.
    pub fn ray(&self, ray: &Ray) -> Ray {
        Ray {
            origin: self.to_tree(ray.origin - self.center),
            direction: self.to_tree(ray.direction),
            t_max: ray.t_max,
        }
    }

    fn to_tree(self, v: Vec3) -> Vec3 {
        let along = |row: Vec3| (row.x * v.x + row.y * v.y) + row.z * v.z;
        Vec3::from(self.inverse.map(along))
    }

    /// The box in the world around boxes of the tree's space.
    pub(super) fn world_box(&self, boxes: impl Iterator<Item = Aabb>) -> (DVec3, DVec3) {
        let (forward, center) = (self.forward(), self.center.as_dvec3());
        let size = absolute(forward);
        let add = |(low, high): (DVec3, DVec3), b: Aabb| {
            let (min, max) = (b.min.as_dvec3(), b.max.as_dvec3());
            let middle = forward * (0.5 * (min + max)) + center;
            let half = size * (0.5 * (max - min));
            (low.min(middle - half), high.max(middle + half))
        };
        boxes.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), add)
    }

    /// That box for rays that start within √3 `reach` metres of the world's origin.
    pub(super) fn padded(&self, (low, high): (DVec3, DVec3), reach: f64) -> Aabb {
        let error = self.spread() * DVec3::splat(3.0 * reach * BOX_ERROR);
        // The sums in f64 are wrong by far less than the next f32.
        let down = |x: f64| (x as f32).next_down().max(f32::MIN);
        let up = |x: f64| (x as f32).next_up().min(f32::MAX);
        Aabb {
            min: Vec3::from((low - error).to_array().map(down)),
            max: Vec3::from((high + error).to_array().map(up)),
        }
    }
}

fn rows(m: DMat3) -> [DVec3; 3] {
    [m.row(0), m.row(1), m.row(2)]
}

fn absolute(m: DMat3) -> DMat3 {
    DMat3::from_cols_array(&m.to_cols_array().map(f64::abs))
}

fn flushed(v: DVec3) -> DVec3 {
    DVec3::from(
        v.to_array()
            .map(|x| if x.abs() < SMALLEST { 0.0 } else { x }),
    )
}

/// The boxes of the children of a tree's root.
pub(super) fn root_boxes(root: &Element) -> impl Iterator<Item = Aabb> + use<> {
    let node: Node = root.decode();
    (0..node.children as usize).map(move |child| node.child_box(child))
}

/// A tree that has been placed, in a structure of two levels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Instance {
    /// Where it is, and which tree.
    pub placement: Placement,
    /// The number that the tree's root has here: each instance numbers the elements of its tree anew, after all
    /// elements that there are, so that the number of a hit names the instance as well as the triangle.
    pub first: u32,
    /// Its box in the world, as the upper level has it before padding.
    pub bounds: Aabb,
}

/// A tree that instances share.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Tree {
    /// Its root, an element. All of its elements follow each other.
    pub root: u32,
    /// How many they are.
    pub elements: u32,
    /// Position of its first triangle in the structure's order.
    pub first_triangle: u32,
    /// Triangles in it.
    pub triangles: u32,
    /// Nodes on the longest way down.
    pub depth: u32,
}

impl Instance {
    /// The instance as a leaf of the upper level, 16 words: the three rows of G, c, then the tree's root, a flag, what
    /// is added to the number of an element of the tree, and where the record is.
    pub(super) fn element(&self, tree: &Tree, record: u32) -> Element {
        let [x, y, z] = self.placement.inverse;
        let last = [tree.root, INSTANCE_FLAG, self.first - tree.root, record];
        words([x, y, z, self.placement.center], last)
    }

    /// What a hit on it needs: the rows of G⁻¹, c, then the number of its first element, how many they are, what is
    /// added to the number of an element of the tree, and [`Placement::condition`].
    pub(super) fn record(&self, tree: &Tree) -> Element {
        let [x, y, z] = rows(self.placement.forward()).map(|row| row.as_vec3());
        let condition = (self.placement.condition() as f32).next_up().to_bits();
        let last = [self.first, tree.elements, self.first - tree.root, condition];
        words([x, y, z, self.placement.center], last)
    }
}

fn words(vectors: [Vec3; 4], last: [u32; 4]) -> Element {
    let mut words = [0; 16];
    for (i, v) in vectors.iter().enumerate() {
        words[3 * i..3 * i + 3].copy_from_slice(&v.to_array().map(f32::to_bits));
    }
    words[12..].copy_from_slice(&last);
    Element { words }
}

impl Element {
    /// Whether a leaf is an instance instead of a pair.
    pub fn is_instance(&self) -> bool {
        self.words[13] & INSTANCE_FLAG != 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn turned() -> DMat3 {
        DMat3::from_axis_angle(DVec3::new(1.0, 2.0, 3.0).normalize(), 0.7)
    }

    #[test]
    fn any_scales_along_three_axes_can_be_shared() {
        for scales in [
            [1.0, 1.0, 1.0],
            [1e-6, 1.0, 1e6],
            [-1.0, 1.0, 1.0],
            [3e5, -2e-4, 1.0],
        ] {
            let linear = turned() * DMat3::from_diagonal(DVec3::from(scales));
            let placement = Placement::new(0, linear, DVec3::X).expect("a regular matrix");
            assert!(placement.condition() < 3.01, "{}", placement.condition());
            let error = placement.forward() - linear;
            for (e, size) in error
                .to_cols_array()
                .into_iter()
                .zip(scales.map(|s| [s; 3]).as_flattened())
            {
                assert!(e.abs() <= 1e-6 * size.abs(), "{e} {size}");
            }
        }
    }

    #[test]
    fn what_is_singular_sheared_or_out_of_range_cannot() {
        let flat = turned() * DMat3::from_diagonal(DVec3::new(1.0, 0.0, 1.0));
        let sheared = turned() * DMat3::from_diagonal(DVec3::new(1.0, 1e4, 1.0)) * turned();
        for linear in [
            flat,
            sheared,
            DMat3::ZERO,
            DMat3::IDENTITY * 1e13,
            DMat3::IDENTITY * 1e-13,
        ] {
            assert_eq!(Placement::new(0, linear, DVec3::ZERO), None);
        }
        let far = DVec3::new(1e19, 0.0, 0.0);
        assert_eq!(Placement::new(0, DMat3::IDENTITY, far), None);
        let nan = DMat3::from_diagonal(DVec3::new(1.0, f64::NAN, 1.0));
        assert_eq!(Placement::new(0, nan, DVec3::ZERO), None);
    }

    #[test]
    fn a_ray_keeps_its_t() {
        let linear = turned() * DMat3::from_diagonal(DVec3::new(2.0, -0.5, 30.0));
        let center = DVec3::new(10.0, -3.0, 2.0);
        let placement = Placement::new(0, linear, center).expect("a regular matrix");
        let ray = Ray::new(Vec3::new(1.0, 2.0, 3.0), Vec3::new(0.5, -1.0, 0.25));
        let inside = placement.ray(&ray);
        for t in [0.5, 7.0] {
            let q = (inside.origin + t * inside.direction).as_dvec3();
            let p = placement.forward() * q + center;
            assert!((p - (ray.origin + t * ray.direction).as_dvec3()).length() < 1e-5);
        }
    }
}
