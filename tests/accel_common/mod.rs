//! Meshes, rays and a brute-force oracle for the tests of the acceleration structure.
#![allow(dead_code)] // Each binary uses its part.

pub mod instances;
mod meshes;

use etendue::accel::{BuildOptions, Bvh, Hit};
use etendue::geometry::{Ray, RaySetup, triangle::intersect_triangle};
use glam::Vec3;

pub use meshes::*;

/// A tree, however few triangles there are.
pub const TREE: usize = 0;
/// A list, however many.
pub const LIST: usize = usize::MAX;

/// Builds with a `list_limit` and validates.
pub fn build(triangles: &[[Vec3; 3]], list_limit: usize) -> Bvh {
    let options = BuildOptions {
        list_limit,
        ..BuildOptions::default()
    };
    let bvh = Bvh::build(triangles, &options);
    if let Err(error) = bvh.validate(triangles) {
        panic!("{error}");
    }
    assert_eq!(bvh.is_list(), list_limit == LIST || triangles.is_empty());
    assert!(bvh.sah_cost().is_finite());
    bvh
}

/// Every triangle in turn; the closest, at equal t the one with the smaller number.
pub fn brute_force(bvh: &Bvh, triangles: &[[Vec3; 3]], ray: &Ray) -> Option<Hit> {
    let setup = RaySetup::new(ray.origin, ray.direction);
    let mut best: Option<Hit> = None;
    for placed in &bvh.order {
        let [v0, v1, v2] = placed
            .turned
            .corners(triangles[placed.turned.triangle as usize]);
        let Some(hit) = intersect_triangle(&setup, v0, v1, v2) else {
            continue;
        };
        let is_closer = |b: Hit| (hit.t, placed.id) < (b.t, b.triangle);
        if hit.t <= ray.t_max && best.is_none_or(is_closer) {
            best = Some(Hit {
                t: hit.t,
                triangle: placed.id,
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
