//! No ray leaves a closed mesh, and none enters between two triangles.

use crate::accel_common::*;
use etendue::accel::Bvh;
use etendue::geometry::{Ray, RaySetup, triangle::intersect_triangle};
use glam::Vec3;

const SCALES: [f32; 3] = [1e-6, 1.0, 1e6];

fn assert_closed(bvh: &Bvh, origin: Vec3, direction: Vec3) {
    let ray = Ray::new(origin, direction);
    assert!(bvh.intersect(&ray).is_some(), "{ray:?}");
    assert!(bvh.occluded(&ray), "{ray:?}");
}

/// Aims from `origin` at every vertex, edge midpoint and middle of a triangle.
fn aim_at_features(bvh: &Bvh, triangles: &[[Vec3; 3]], origin: Vec3) {
    for &[a, b, c] in triangles {
        let (ab, middle) = (a * 0.5 + b * 0.5, (a + b + c) / 3.0);
        for target in [a, ab, middle] {
            assert_closed(bvh, origin, target - origin);
            assert_closed(bvh, origin, (target - origin).normalize());
        }
    }
}

fn aim_at_random(bvh: &Bvh, origin: Vec3, random: &mut Random) {
    for _ in 0..5000 {
        assert_closed(bvh, origin, random.direction());
    }
    for axis in [Vec3::X, Vec3::Y, Vec3::Z] {
        assert_closed(bvh, origin, axis);
        assert_closed(bvh, origin, -axis);
    }
}

fn check_inside(mesh: &[[Vec3; 3]], inner_radius: f32) {
    let mut random = Random(1);
    for scale in SCALES {
        let triangles = scaled(mesh, scale, Vec3::ZERO);
        let off_center = random.point() * 0.5 * inner_radius;
        for bvh in [TREE, LIST].map(|limit| build(&triangles, limit)) {
            for origin in [
                Vec3::ZERO,
                Vec3::new(0.25, 0.0, -0.5) * inner_radius,
                off_center,
            ] {
                aim_at_features(&bvh, &triangles, origin * scale);
                aim_at_random(&bvh, origin * scale, &mut random);
            }
        }
    }
}

#[test]
fn nothing_leaves_a_sphere() {
    check_inside(&sphere(24), 0.9);
}

#[test]
fn nothing_leaves_a_cube() {
    check_inside(&cube(8), 1.0);
    check_inside(&cube(7), 1.0);
}

#[test]
fn nothing_leaves_a_closed_mesh_far_from_the_origin() {
    let mut random = Random(2);
    let center = Vec3::new(1e6, -3e5, 2e6);
    // Rounding the vertices to 1/8 m moves them, but every copy of a vertex alike.
    let triangles = scaled(&sphere(24), 100.0, center);
    for bvh in [TREE, LIST].map(|limit| build(&triangles, limit)) {
        aim_at_features(&bvh, &triangles, center);
        aim_at_random(&bvh, center, &mut random);
    }
}

/// A grid seen from afar and at grazing angles: the projected triangles are slivers.
#[test]
fn nothing_passes_a_grid_at_grazing_angles() {
    let mut random = Random(3);
    let floor = grid(32, 32, |i, j| {
        Vec3::new(i as f32 - 16.0, 0.0, j as f32 - 16.0)
    });
    for scale in SCALES {
        let bvh = build(&scaled(&floor, scale, Vec3::ZERO), TREE);
        for _ in 0..20_000 {
            let target = Vec3::new(random.point().x, 0.0, random.point().z) * 15.0;
            let slope = 10f32.powf(-5.0 * random.unit());
            let away = Vec3::new(random.point().x, slope, random.point().z) * 100.0;
            let target = if random.below(2) == 0 {
                target.round()
            } else {
                target
            };
            assert_closed(&bvh, (target + away) * scale, -away);
        }
    }
}

/// Rays in the planes of boxes' faces, along their edges, and through their corners.
#[test]
fn rays_in_box_planes_hit_what_stands_in_their_way() {
    for scale in SCALES {
        let bvh = build(&scaled(&cube(4), scale, Vec3::ZERO), TREE);
        for axis in [Vec3::X, Vec3::Y, Vec3::Z] {
            for i in -4i32..=4 {
                for j in -4i32..=4 {
                    let (u, v) = (i as f32 * 0.25, j as f32 * 0.25);
                    let across = Vec3::new(axis.y, axis.z, axis.x) * u
                        + Vec3::new(axis.z, axis.x, axis.y) * v;
                    let start = across - axis * 3.0;
                    let ray = Ray::new(start * scale, axis);
                    let hit = bvh.intersect(&ray).map(|hit| hit.t);
                    assert_eq!(hit, Some(3.0 * scale - scale), "{ray:?}");
                }
            }
        }
    }
}

/// A ray between the two sides of a shared edge, next to it by single ulps: exactly one triangle
/// holds it unless it meets the edge exactly, where both do.
#[test]
fn a_shared_edge_is_neither_open_nor_double() {
    let mut random = Random(4);
    let mut both = 0;
    for _ in 0..100_000 {
        // Seen from the origin the edge runs up and down, with one triangle on each side.
        let (a, b) = (
            random.point() + Vec3::Y * 4.0,
            random.point() - Vec3::Y * 4.0,
        );
        let (c, d) = (
            random.point() + Vec3::Z * 4.0,
            random.point() - Vec3::Z * 4.0,
        );
        let s = 0.01 + 0.98 * random.unit();
        let origin = Vec3::new(40.0, 0.1, 0.2);
        let setup = RaySetup::new(origin, a * s + b * (1.0 - s) - origin);
        let left = intersect_triangle(&setup, a, b, c).is_some();
        let right = intersect_triangle(&setup, b, a, d).is_some();
        assert!(left || right, "{a} {b}");
        both += usize::from(left && right);
    }
    assert!(both < 1000, "{both}");
}

/// Rays from outside cross a closed mesh an even number of times where they meet no edge exactly:
/// each crossing is counted by facing, and the facings cancel.
#[test]
fn facings_cancel_along_every_ray() {
    let mut random = Random(5);
    let mesh = sphere(16);
    for _ in 0..3000 {
        let origin = random.direction() * 3.0;
        let setup = RaySetup::new(origin, random.point() - origin);
        let sides = mesh
            .iter()
            .filter_map(|&[a, b, c]| intersect_triangle(&setup, a, b, c));
        let sum: i32 = sides.map(|hit| if hit.back_face { 1 } else { -1 }).sum();
        assert_eq!(sum, 0);
    }
}
