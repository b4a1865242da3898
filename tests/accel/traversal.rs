//! The traversal against every triangle in turn: same hit, bit for bit.

use crate::accel_common::*;
use etendue::accel::{Bvh, Hit};
use etendue::geometry::triangle::{fan_candidates, intersect};
use etendue::geometry::{Ray, RaySetup};
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

fn check(bvh: &Bvh, triangles: &[[Vec3; 3]], ray: &Ray) -> bool {
    let expected = brute_force(bvh, triangles, ray);
    let found = bvh.intersect(ray);
    assert_eq!(found, expected, "{ray:?}");
    assert_eq!(bvh.occluded(ray), expected.is_some(), "{ray:?}");
    let Some(hit) = expected else {
        return false;
    };
    // The hit itself belongs to the ray's range, the number below it does not reach it.
    let up_to = |t_max| Ray { t_max, ..*ray };
    assert_eq!(bvh.intersect(&up_to(hit.t)), expected, "{ray:?}");
    let below = bvh.intersect(&up_to(hit.t.next_down()));
    assert_eq!(below, None, "{ray:?}");
    true
}

/// Scales and offsets of a mesh.
const PLACES: [(f32, Vec3); 5] = [
    (1.0, Vec3::ZERO),
    (1e-6, Vec3::ZERO),
    (1e6, Vec3::ZERO),
    (1.0, Vec3::new(1e3, -7e3, 1.0)),
    (1.0, Vec3::splat(1e6)),
];

#[test]
fn agrees_with_brute_force_on_nasty_meshes() {
    for (name, mesh) in meshes() {
        let mut random = Random(17);
        let (mut hits, mut rays) = (0, 0);
        for (scale, offset) in PLACES {
            let triangles = scaled(&mesh, scale, offset);
            let bvh = build(&triangles, TREE);
            for _ in 0..1600 {
                rays += 1;
                let ray = nasty_ray(&triangles, &mut random);
                hits += usize::from(check(&bvh, &triangles, &ray));
            }
        }
        println!("{name}: {hits} hits of {rays} rays");
        assert!(hits * 20 > rays, "{name}: the rays miss nearly everything");
    }
}

/// A list must find whatever there is to hit that is not doubtful, and no hit that the exact test
/// denies except beside an edge; it may take another hit than the closest only where the two are no
/// farther apart than a triangle is long.
#[test]
fn a_list_finds_what_brute_force_finds() {
    for (name, mesh) in meshes() {
        let mut random = Random(18);
        let (mut hits, mut lost, mut others, mut denied) = (0, 0, 0, 0);
        for (scale, offset) in PLACES {
            let triangles = scaled(&mesh, scale, offset);
            let bvh = build(&triangles, LIST);
            for _ in 0..400 {
                let ray = nasty_ray(&triangles, &mut random);
                let expected = brute_force(&bvh, &triangles, &ray);
                let found = bvh.intersect(&ray);
                assert_eq!(bvh.occluded(&ray), found.is_some(), "{name}: {ray:?}");
                let triangle_of = |hit: Hit| {
                    let placed = bvh.order[bvh.position(hit.triangle)];
                    placed
                        .turned
                        .corners(triangles[placed.turned.triangle as usize])
                };
                let Some(found) = found else {
                    let may_be_lost = |hit: Hit| is_doubtful(&ray, hit, &triangle_of(hit));
                    assert!(
                        expected.is_none_or(may_be_lost),
                        "{name}: {ray:?}: {expected:?}"
                    );
                    lost += usize::from(expected.is_some());
                    continue;
                };
                hits += 1;
                let triangle = triangle_of(found);
                let own = intersect(&ray, &triangle);
                match own {
                    Some(own) => assert_eq!((own.t, own.b), (found.t, found.b), "{name}: {ray:?}"),
                    None => denied += 1,
                }
                if let Some(closest) = expected
                    && found != closest
                {
                    others += 1;
                    let far = extent_along(&ray, &triangle);
                    let doubtful = is_doubtful(&ray, found, &triangle)
                        || is_doubtful(&ray, closest, &triangle_of(closest));
                    assert!(
                        doubtful || (found.t - closest.t).abs() <= far,
                        "{name}: {ray:?}: {found:?} instead of {expected:?}, {far}"
                    );
                }
            }
        }
        println!(
            "{name}: {hits} hits, {lost} lost, {others} not the closest, {denied} denied by the exact test"
        );
        assert!(hits * 20 > 2000, "{name}: the rays miss nearly everything");
    }
}

/// Whether a list may lose or make a hit: where the ray starts, and on a triangle whose quick edges are
/// all 0.
fn is_doubtful(ray: &Ray, hit: Hit, &[a, b, c]: &[Vec3; 3]) -> bool {
    let setup = RaySetup::new(ray.origin, ray.direction);
    let fan = fan_candidates(&setup, [a, b, c, a]);
    hit.t <= extent_along(ray, &[a, b, c]) || fan.edges[0] == Vec3::ZERO
}

/// The part of a ray along which a triangle lies, in t, and the rounding of its vertices.
fn extent_along(ray: &Ray, triangle: &[Vec3; 3]) -> f32 {
    let axis = ray.direction.abs().max_position();
    let t = triangle.map(|v| (v[axis] - ray.origin[axis]) / ray.direction[axis]);
    let (low, high) = (t[0].min(t[1]).min(t[2]), t[0].max(t[1]).max(t[2]));
    (high - low) + low.abs().max(high.abs()) * 16.0 * f32::EPSILON
}

#[test]
fn the_end_of_a_ray_belongs_to_it_in_a_list_too() {
    let triangles = vec![[Vec3::ZERO, Vec3::X, Vec3::Y]];
    let bvh = build(&triangles, LIST);
    let mut ray = Ray::new(Vec3::new(0.25, 0.25, 2.0), -Vec3::Z);
    ray.t_max = 2.0;
    assert_eq!(bvh.intersect(&ray).map(|hit| hit.t), Some(2.0));
    ray.t_max = 2f32.next_down();
    assert_eq!(bvh.intersect(&ray), None);
}

#[test]
fn ties_go_to_the_smaller_number_whatever_the_order() {
    // Layers of the same plane in one tree, hit from both sides and along both diagonals.
    let triangles = [cube(4), cube(4), cube(2), cube(1)].concat();
    let bvh = build(&triangles, TREE);
    let mut random = Random(3);
    for _ in 0..5000 {
        let direction = random.direction();
        let ray = Ray::new(direction * -3.0 + random.point() * 0.5, direction);
        let expected = brute_force(&bvh, &triangles, &ray);
        assert_eq!(bvh.intersect(&ray), expected, "{ray:?}");
    }
}

#[test]
fn an_empty_scene_is_never_hit() {
    let bvh = build(&[], TREE);
    let mut random = Random(5);
    for _ in 0..1000 {
        let ray = Ray::new(random.point() * 1e6, random.direction());
        assert_eq!(bvh.intersect(&ray), None);
        assert!(!bvh.occluded(&ray));
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
    ) {
        let scale = 2f32.powi(exponent) * 1.1;
        let triangles: Triangles = corners.iter().map(|&(a, b, c)| [a * scale, b * scale, c * scale]).collect();
        let bvh = build(&triangles, TREE);
        for (origin, direction) in rays.into_iter().filter(|(_, d)| *d != Vec3::ZERO) {
            check(&bvh, &triangles, &Ray::new(origin * 0.5 * scale, direction));
        }
    }

    #[test]
    fn agrees_with_brute_force_on_random_triangles(
        seed in any::<u64>(), size in -8i32..4, distance in -3i32..6, n in 1usize..40,
    ) {
        let triangles = soup(n, 10f32.powi(size), seed);
        let bvh = build(&triangles, TREE);
        let mut random = Random(seed);
        for _ in 0..20 {
            let [a, b, c] = triangles[random.below(n)];
            let target = a * random.unit() + b * random.unit() + c * random.unit();
            let origin = random.direction() * 10f32.powi(distance);
            check(&bvh, &triangles, &Ray::new(origin, target - origin));
        }
    }
}
