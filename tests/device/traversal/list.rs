//! What a list leaves out: pairs on the hull of the scene are not in the way from triangle to triangle.

use etendue::geometry::{Ray, RaySetup, triangle::intersect_triangle};
use glam::Vec3;

use super::target::{Mesh, Target};
use crate::accel_common::{LIST, Random, cube, scaled, soup};
use crate::common::{ELEMENTS, Setup};

const RAYS: usize = 65_536;

/// A closed room with a block and two loose triangles in it, none of which touches a wall: which of two surfaces in one
/// plane comes first is rounding.
fn room() -> Mesh {
    let block = scaled(&cube(1), 0.3, Vec3::new(0.2, -0.6, 0.1));
    [cube(1), block, scaled(&soup(2, 0.5, 3), 0.5, Vec3::ZERO)].concat()
}

/// A ray from a point within a triangle to one within another.
struct Between {
    ray: Ray,
    ends: [u32; 2],
}

impl Between {
    /// None where the ray is nearly in the plane of one of the two, so that rounding decides what it meets.
    fn new(target: &Target, random: &mut Random) -> Option<Self> {
        let order = &target.bvh.order;
        let ends = [(); 2].map(|()| order[random.below(order.len())].id);
        let triangles = ends.map(|id| corners(target, id));
        let [origin, aim] = triangles.map(|[a, b, c]| {
            let (u, v) = (random.unit(), random.unit());
            a + (b - a) * (0.05 + 0.4 * u) + (c - a) * (0.05 + 0.4 * v)
        });
        let mut ray = Ray::new(origin, aim - origin);
        ray.t_max = 1.0;
        let is_steep = |[a, b, c]: [Vec3; 3]| {
            let normal = (b - a).cross(c - a).normalize_or_zero();
            normal.dot(ray.direction).abs() > 1e-3
        };
        triangles
            .into_iter()
            .all(is_steep)
            .then_some(Self { ray, ends })
    }

    fn words(&self) -> [[f32; 4]; 3] {
        let ray = &self.ray;
        let [start, end] = self.ends.map(f32::from_bits);
        [
            ray.origin.extend(ray.t_max).to_array(),
            ray.direction.extend(0.0).to_array(),
            [start, end, 0.0, 0.0],
        ]
    }

    /// Whether any triangle but those at its ends is in its way.
    fn is_blocked(&self, target: &Target) -> bool {
        let setup = RaySetup::new(self.ray.origin, self.ray.direction);
        target.bvh.order.iter().any(|placed| {
            let [a, b, c] = corners(target, placed.id);
            let hit = intersect_triangle(&setup, a, b, c);
            !self.ends.contains(&placed.id) && hit.is_some_and(|hit| hit.t <= self.ray.t_max)
        })
    }
}

fn corners(target: &Target, id: u32) -> [Vec3; 3] {
    target.bvh.elements[(id >> 1) as usize].triangles()[(id & 1) as usize]
}

/// Rays for which the device's answer is not that of all triangles, and those that something blocks.
fn compare(setup: &Setup) -> (usize, usize) {
    let target = Target::new(&room(), LIST);
    let mut random = Random(11);
    let rays: Vec<_> = (0..RAYS)
        .filter_map(|_| Between::new(&target, &mut random))
        .collect();
    let inputs: Vec<_> = rays.iter().map(Between::words).collect();
    let kernel = target.kernel(setup, "between");
    let buffers = [(ELEMENTS, &target.elements)];
    let n = rays.len();
    let found: Vec<[[u32; 4]; 2]> = kernel.run(n as u32, [0; 3], &inputs, n, &buffers);
    let expected: Vec<_> = rays.iter().map(|ray| ray.is_blocked(&target)).collect();
    let pairs = expected.iter().zip(&found);
    let unlike = pairs.filter(|(e, f)| **e != (f[0][3] == 1)).count();
    let blocked = expected.iter().filter(|e| **e).count();
    println!("{n} rays, {blocked} blocked, {unlike} unlike");
    assert!(blocked * 4 > n && blocked * 4 < 3 * n, "{blocked} of {n}");
    (unlike, blocked)
}

#[test]
fn the_hull_is_in_no_ray_s_way() {
    assert_eq!(compare(&Setup::new()).0, 0);
}

/// Negative controls: pairs of no solid do not count, nor do solids; and rays from anywhere that are taken for rays between triangles.
#[test]
fn pairs_left_out_are_noticed() {
    for (file, from, to) in [
        (
            "list.wgsl",
            "hit |= any_of_pair",
            "hit = hit && any_of_pair",
        ),
        (
            "accel/solids.wgsl",
            "so_far.blocks || blocks",
            "so_far.blocks && blocks",
        ),
    ] {
        let (unlike, blocked) = compare(&Setup::new().patched(file, from, to));
        assert!(unlike * 100 > blocked, "{from}: {unlike} of {blocked}");
    }
    let (from, to) = ("if (ray.start == NONE || ray.end == NONE)", "if (false)");
    let setup = Setup::new().patched("list.wgsl", from, to);
    let target = Target::new(&room(), LIST);
    let kernel = target.kernel(&setup, "main");
    let ray = Ray::new(Vec3::new(0.1, 0.8, 0.2), Vec3::Y);
    assert!(target.bvh.occluded(&ray) && !target.trace(&kernel, &[ray])[0].1);
}
