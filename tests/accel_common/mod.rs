//! Meshes, rays and a brute-force oracle for the tests of the acceleration structure.
#![allow(dead_code)] // Each test file uses its part.

mod meshes;

use etendue::accel::{BuildOptions, Bvh, Hit, MAX_LEAF_SIZE};
use etendue::geometry::{Ray, RaySetup, triangle::intersect_triangle};
use glam::Vec3;

pub use meshes::*;

/// Builds, validates, and returns the triangles in the tree's order too.
pub fn build(triangles: &[[Vec3; 3]], max_leaf_size: u32, bins: usize) -> (Bvh, Triangles) {
    let bvh = Bvh::build(
        triangles,
        &BuildOptions {
            max_leaf_size,
            bins,
            ..BuildOptions::default()
        },
    );
    if let Err(error) = bvh.validate(triangles) {
        panic!("leaves of {max_leaf_size}, {bins} bins: {error}");
    }
    let largest = bvh
        .nodes
        .iter()
        .map(|n| n.left_count.max(n.right_count))
        .max();
    assert!(largest <= Some(max_leaf_size.clamp(1, MAX_LEAF_SIZE)));
    assert!(bvh.sah_cost().is_finite());
    let ordered = bvh.reorder(triangles);
    (bvh, ordered)
}

/// Every triangle in turn; the first of the closest.
pub fn brute_force(triangles: &[[Vec3; 3]], ray: &Ray) -> Option<Hit> {
    let setup = RaySetup::new(ray.origin, ray.direction);
    let mut best: Option<Hit> = None;
    for (i, &[v0, v1, v2]) in triangles.iter().enumerate() {
        let Some(hit) = intersect_triangle(&setup, v0, v1, v2) else {
            continue;
        };
        if hit.t <= ray.t_max && best.is_none_or(|b| hit.t < b.t) {
            best = Some(Hit {
                t: hit.t,
                triangle: i as u32,
                b: hit.b,
                back_face: hit.back_face,
            });
        }
    }
    best
}

/// Rays that are hard on boxes and triangles: aimed at vertices, edges and random points, along
/// axes, in the planes of triangles, from near, far and on the surface.
pub fn nasty_ray(triangles: &[[Vec3; 3]], random: &mut Random) -> Ray {
    let target = nasty_point(triangles, random);
    let size = triangles[random.below(triangles.len())];
    let size = size[0].distance(size[1]).max(f32::MIN_POSITIVE);
    let origin = match random.below(4) {
        0 => nasty_point(triangles, random),
        1 => target + random.direction() * size,
        2 => target + random.direction() * size * 1e4,
        _ => target + axis_vector(random) * size * 4.0,
    };
    let direction = match random.below(5) {
        0 => axis_vector(random),
        1 => random.direction(),
        _ => target - origin,
    };
    let usable = direction.is_finite() && direction.abs().max_element() > 1e-18;
    Ray::new(origin, if usable { direction } else { Vec3::X })
}

fn nasty_point(triangles: &[[Vec3; 3]], random: &mut Random) -> Vec3 {
    let [a, b, c] = triangles[random.below(triangles.len())];
    match random.below(3) {
        0 => a,
        1 => a * 0.5 + b * 0.5,
        _ => a * 0.25 + b * 0.25 + c * 0.5,
    }
}

fn axis_vector(random: &mut Random) -> Vec3 {
    let sign = if random.below(2) == 0 { 1.0 } else { -1.0 };
    [Vec3::X, Vec3::Y, Vec3::Z][random.below(3)] * sign
}
