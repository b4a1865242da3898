//! No way out of a closed mesh.

use etendue::geometry::Ray;
use glam::Vec3;

use super::target::Target;
use crate::accel_common::{LIST, Random, TREE, cube, scaled, sphere};
use crate::common::Setup;

/// Rays from inside at every vertex, edge and middle, and along the axes.
fn escaping_rays(target: &Target, origin: Vec3, random: &mut Random) -> Vec<Ray> {
    let mut rays = Vec::new();
    for &[a, b, c] in &target.mesh {
        for point in [a, a * 0.5 + b * 0.5, b * 0.5 + c * 0.5, (a + b + c) / 3.0] {
            rays.push(Ray::new(origin, point - origin));
            rays.push(Ray::new(origin, (point - origin).normalize()));
        }
    }
    for axis in [Vec3::X, Vec3::Y, Vec3::Z] {
        rays.extend([Ray::new(origin, axis), Ray::new(origin, -axis)]);
    }
    rays.extend((0..20_000).map(|_| Ray::new(origin, random.direction())));
    rays
}

fn escapes(
    setup: &Setup,
    mesh: &[[Vec3; 3]],
    limit: usize,
    radius: f32,
    center: Vec3,
) -> (usize, usize) {
    let (mut random, mut missed, mut all) = (Random(1), 0, 0);
    let target = Target::new(mesh, limit);
    let kernel = target.kernel(setup, "main");
    for offset in [Vec3::ZERO, Vec3::new(0.25, 0.0, -0.5), random.point() * 0.5] {
        let rays = escaping_rays(&target, center + offset * radius, &mut random);
        let found = target.trace(&kernel, &rays);
        missed += found.iter().filter(|(h, o)| h.is_none() || !o).count();
        all += rays.len();
    }
    (missed, all)
}

#[test]
fn nothing_leaves_a_closed_mesh_on_the_device() {
    let (mut missed, mut all) = (0, 0);
    let mut count = |mesh: &[[Vec3; 3]], limit, radius, center| {
        let (m, a) = escapes(&Setup::new(), mesh, limit, radius, center);
        missed += m;
        all += a;
    };
    let center = Vec3::new(1e6, -3e5, 2e6);
    for (limit, fine, faces) in [(TREE, 24, [7, 8]), (LIST, 4, [2, 3])] {
        for scale in [1e-6, 1.0, 1e6] {
            let round = scaled(&sphere(fine), scale, Vec3::ZERO);
            count(&round, limit, 0.5 * scale, Vec3::ZERO);
            for n in faces {
                count(
                    &scaled(&cube(n), scale, Vec3::ZERO),
                    limit,
                    scale,
                    Vec3::ZERO,
                );
            }
        }
        count(&scaled(&sphere(fine), 100.0, center), limit, 50.0, center);
    }
    println!("{all} rays from inside closed meshes");
    assert_eq!(missed, 0, "of {all}");
}

/// Negative control: edges that are not decided exactly lose hits in a tree, and ones that count as
/// outside where they are 0 in a list.
#[test]
fn a_leaky_traversal_is_noticed() {
    let from = "return (difference + sum) + lost;";
    let to = "return select(difference, -1.0, difference == 0.0);";
    let setup = Setup::new().patched("geometry/triangle.wgsl", from, to);
    assert!(escapes(&setup, &cube(8), TREE, 1.0, Vec3::ZERO).0 > 0);
    let from = "(e.x < 0.0 || e.y < 0.0 || e.z < 0.0)";
    let to = "(e.x <= 0.0 || e.y <= 0.0 || e.z <= 0.0)";
    let setup = Setup::new().patched("geometry/triangle.wgsl", from, to);
    assert!(escapes(&setup, &cube(2), LIST, 1.0, Vec3::ZERO).0 > 0);
}
