//! The traversal against every triangle in turn: same hit, bit for bit.

mod accel_common;

use accel_common::*;
use etendue::geometry::Ray;
use glam::Vec3;
use proptest::prelude::*;

fn meshes() -> Vec<(&'static str, Triangles)> {
    let stacked = [sphere(8), sphere(8), cube(4), cube(4)].concat();
    vec![
        ("soup", soup(300, 0.2, 1)),
        ("dust", soup(300, 1e-3, 2)),
        ("overlapping", soup(200, 1.0, 3)),
        ("needles", needles(300, 4)),
        ("terrain", terrain(16, 5)),
        (
            "flat",
            grid(16, 16, |i, j| Vec3::new(i as f32, 0.0, j as f32)),
        ),
        (
            "flat in z",
            grid(16, 16, |i, j| Vec3::new(i as f32, j as f32, -1.0)),
        ),
        (
            "long strips",
            grid(64, 1, |i, j| {
                Vec3::new(i as f32 * 0.01, 0.3, j as f32 * 100.0)
            }),
        ),
        ("boxes", boxes(16)),
        ("cube", cube(8)),
        ("sphere", sphere(12)),
        ("coincident", stacked),
    ]
}

fn check(bvh: &etendue::accel::Bvh, ordered: &[[Vec3; 3]], ray: &Ray) -> bool {
    let expected = brute_force(ordered, ray);
    let found = bvh.intersect(ordered, ray);
    assert_eq!(found, expected, "{ray:?}");
    assert_eq!(bvh.occluded(ordered, ray), expected.is_some(), "{ray:?}");
    let Some(hit) = expected else {
        return false;
    };
    // The hit itself belongs to the ray's range, the number below it does not reach it.
    let up_to = |t_max| Ray { t_max, ..*ray };
    assert_eq!(bvh.intersect(ordered, &up_to(hit.t)), expected, "{ray:?}");
    let below = bvh.intersect(ordered, &up_to(hit.t.next_down()));
    assert_eq!(below, None, "{ray:?}");
    true
}

#[test]
fn agrees_with_brute_force_on_nasty_meshes() {
    for (name, mesh) in meshes() {
        let mut random = Random(17);
        let (mut hits, mut rays) = (0, 0);
        for (scale, offset) in [
            (1.0, Vec3::ZERO),
            (1e-6, Vec3::ZERO),
            (1e6, Vec3::ZERO),
            (1.0, Vec3::new(1e3, -7e3, 1.0)),
            (1.0, Vec3::splat(1e6)),
        ] {
            let triangles = scaled(&mesh, scale, offset);
            for max_leaf_size in [1, 4] {
                let (bvh, ordered) = build(&triangles, max_leaf_size, 16);
                for _ in 0..800 {
                    rays += 1;
                    let ray = nasty_ray(&ordered, &mut random);
                    hits += usize::from(check(&bvh, &ordered, &ray));
                }
            }
        }
        println!("{name}: {hits} hits of {rays} rays");
        assert!(hits * 20 > rays, "{name}: the rays miss nearly everything");
    }
}

#[test]
fn ties_go_to_the_smaller_position_whatever_the_order() {
    // Layers of the same plane in one tree, hit from both sides and along both diagonals.
    let triangles = [cube(4), cube(4), cube(2), cube(1)].concat();
    let (bvh, ordered) = build(&triangles, 1, 16);
    let mut random = Random(3);
    for _ in 0..5000 {
        let direction = random.direction();
        let ray = Ray::new(direction * -3.0 + random.point() * 0.5, direction);
        let (found, expected) = (bvh.intersect(&ordered, &ray), brute_force(&ordered, &ray));
        assert_eq!(found, expected, "{ray:?}");
    }
}

#[test]
fn an_empty_tree_is_never_hit() {
    let (bvh, ordered) = build(&[], 4, 16);
    let mut random = Random(5);
    for _ in 0..1000 {
        let ray = Ray::new(random.point() * 1e6, random.direction());
        assert_eq!(bvh.intersect(&ordered, &ray), None);
    }
}

/// Coordinates on a coarse lattice, so that edges, vertices and planes meet rays exactly.
fn lattice_point() -> impl Strategy<Value = Vec3> {
    (-3i32..4, -3i32..4, -3i32..4).prop_map(|(x, y, z)| Vec3::new(x as f32, y as f32, z as f32))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn agrees_with_brute_force_on_lattices(
        corners in prop::collection::vec((lattice_point(), lattice_point(), lattice_point()), 1..60),
        rays in prop::collection::vec((lattice_point(), lattice_point()), 20),
        exponent in -30i32..30,
        max_leaf_size in 1u32..6,
    ) {
        let scale = 2f32.powi(exponent) * 1.1;
        let triangles: Triangles = corners.iter().map(|&(a, b, c)| [a * scale, b * scale, c * scale]).collect();
        let (bvh, ordered) = build(&triangles, max_leaf_size, 8);
        for (origin, direction) in rays.into_iter().filter(|(_, d)| *d != Vec3::ZERO) {
            check(&bvh, &ordered, &Ray::new(origin * 0.5 * scale, direction));
        }
    }

    #[test]
    fn agrees_with_brute_force_on_random_triangles(
        seed in any::<u64>(), size in -8i32..4, distance in -3i32..6, n in 1usize..40,
    ) {
        let triangles = soup(n, 10f32.powi(size), seed);
        let (bvh, ordered) = build(&triangles, 2, 8);
        let mut random = Random(seed);
        for _ in 0..20 {
            let [a, b, c] = ordered[random.below(n)];
            let target = a * random.unit() + b * random.unit() + c * random.unit();
            let origin = random.direction() * 10f32.powi(distance);
            check(&bvh, &ordered, &Ray::new(origin, target - origin));
        }
    }
}
