//! Structures of two levels on the host: every triangle of every instance in turn finds the same hits, bit for bit;
//! nothing leaves a closed mesh that is an instance; the validator knows what is wrong.

use crate::accel_common::instances::{Instanced, place, structures, turn};
use crate::accel_common::{Random, cube, soup, sphere, terrain};
use etendue::accel::{BuildOptions, Bvh, BvhError, Steps, TwoLevel};
use etendue::geometry::Ray;
use glam::{DMat3, DVec3, Vec3};

/// Rays for each structure.
const RAYS: usize = 2000;

#[test]
fn agrees_with_brute_force() {
    for (name, target) in structures() {
        let mut random = Random(7);
        let (mut hits, mut inside) = (0, 0);
        for i in 0..RAYS {
            let mut ray = target.ray(&mut random);
            if i % 4 == 3
                && let Some(hit) = target.brute_force(&ray)
            {
                ray.t_max = [hit.t, hit.t.next_down(), hit.t.next_up()][i / 4 % 3];
            }
            let expected = target.brute_force(&ray);
            assert_eq!(target.bvh.intersect(&ray), expected, "{name}: {ray:?}");
            assert_eq!(
                target.bvh.occluded(&ray),
                expected.is_some(),
                "{name}: {ray:?}"
            );
            hits += usize::from(expected.is_some());
            let in_instance = |id| target.bvh.resolve(id).1.is_some();
            inside += usize::from(expected.is_some_and(|hit| in_instance(hit.triangle)));
        }
        println!("{name}: {hits} hits of {RAYS} rays, {inside} on instances");
        assert!(
            hits * 3 > RAYS && inside * 10 > RAYS,
            "{name}: {hits} {inside}"
        );
    }
}

/// Negative control: boxes of instances that do not hold what rounding of the ray needs.
#[test]
fn an_instance_s_box_that_is_too_small_is_noticed() {
    let (_, target) = structures().swap_remove(1);
    let mut bvh = target.bvh.clone();
    bvh.reach *= 2.0;
    let error = bvh
        .validate(&target.triangles)
        .expect_err("boxes for a shorter reach");
    assert!(matches!(error, BvhError::Instance { .. }), "{error}");
    let mut bvh = target.bvh.clone();
    bvh.instances[3].bounds.max.x = bvh.instances[3].bounds.max.x.next_down();
    let error = bvh.validate(&target.triangles).expect_err("a smaller box");
    assert!(
        matches!(error, BvhError::Instance { instance: 3 }),
        "{error}"
    );
}

/// What may be wrong, and what the validator says.
#[test]
fn broken_structures_are_noticed() {
    let (_, target) = structures().swap_remove(1);
    type Break = fn(&mut Bvh);
    let broken: [(Break, &str); 9] = [
        (|b| b.elements[1].words[0] += 1, "Sections"),
        (|b| b.instances[0].first += 1, "Instance"),
        (|b| b.trees[1].root += 1, "Sections"),
        (|b| b.depth += 1, "Depth"),
        (|b| b.instances.swap(0, 1), "Instance"),
        (|b| b.trees[2].depth += 1, "Depth"),
        (|b| b.order.swap(0, 1), "Place"),
        (|b| b.elements.truncate(b.elements.len() - 1), "Sections"),
        (
            |b| {
                let last = b.elements.len() - 1;
                b.elements[last].words[15] ^= 1;
            },
            "Instance",
        ),
    ];
    for (i, (break_it, expected)) in broken.into_iter().enumerate() {
        let mut bvh = target.bvh.clone();
        break_it(&mut bvh);
        let error = bvh
            .validate(&target.triangles)
            .expect_err("the structure is broken");
        assert!(format!("{error:?}").starts_with(expected), "{i}: {error:?}");
    }
}

/// A leaf that is not what its instance says, or is there twice.
#[test]
fn broken_leaves_are_noticed() {
    let (_, target) = structures().swap_remove(1);
    let bvh = &target.bvh;
    let upper = 2..bvh.trees[0].root as usize;
    let record = bvh.elements[1].words[0];
    let is_leaf_of = |e: usize, i: u32| {
        let words = &bvh.elements[e].words;
        words[15] == record + i && bvh.trees.iter().any(|t| t.root == words[12])
    };
    let leaf = |i: u32| upper.clone().find(|&e| is_leaf_of(e, i)).expect("a leaf");
    let mut moved = bvh.clone();
    moved.elements[leaf(2)].words[9] ^= 1;
    let error = moved
        .validate(&target.triangles)
        .expect_err("a leaf that was moved");
    assert!(
        matches!(error, BvhError::Instance { instance: 2 }),
        "{error}"
    );
    let mut twice = bvh.clone();
    twice.elements[leaf(2)] = twice.elements[leaf(3)];
    let error = twice
        .validate(&target.triangles)
        .expect_err("a leaf that is there twice");
    assert!(matches!(error, BvhError::InstanceCount { .. }), "{error}");
}

fn assert_closed(bvh: &Bvh, origin: Vec3, direction: Vec3) {
    let ray = Ray::new(origin, direction);
    assert!(
        bvh.intersect(&ray).is_some() && bvh.occluded(&ray),
        "{ray:?}"
    );
}

/// From inside at every vertex, edge and middle, at random, and along the axes; of any scale, mirrored or not, near the
/// world's origin or far from it.
#[test]
fn nothing_leaves_a_closed_mesh_that_is_an_instance() {
    let mut random = Random(3);
    let mut rays = 0;
    for (mesh, radius) in [(sphere(24), 0.9), (cube(7), 1.0)] {
        for scale in [1e-6, 1.0, 1e6] {
            for offset in [DVec3::ZERO, DVec3::new(1e4, -3e3, 2e4) * scale] {
                let sizes = DVec3::new(1.0, -0.3, 2.0) * scale;
                let linear = turn(&mut random) * DMat3::from_diagonal(sizes);
                let placement = place(0, linear, offset);
                let target = Instanced::new(&[], std::slice::from_ref(&mesh), &[placement]);
                let start = random.point().as_dvec3() * 0.3 * radius;
                let origin = (placement.forward() * start + offset).as_vec3();
                for &[a, b, c] in &target.placed {
                    for point in [a, a * 0.5 + b * 0.5, (a + b + c) / 3.0] {
                        assert_closed(&target.bvh, origin, point - origin);
                        assert_closed(&target.bvh, origin, (point - origin).normalize());
                        rays += 2;
                    }
                }
                for axis in [
                    Vec3::X,
                    Vec3::Y,
                    Vec3::Z,
                    Vec3::NEG_X,
                    Vec3::NEG_Y,
                    Vec3::NEG_Z,
                ] {
                    assert_closed(&target.bvh, origin, axis);
                }
                for _ in 0..5000 {
                    assert_closed(&target.bvh, origin, random.direction());
                }
                rays += 5006;
            }
        }
    }
    println!("{rays} rays from inside closed instances");
}

/// A mirror turns the winding round, but not what is the front.
#[test]
fn the_front_stays_the_front_under_a_mirror() {
    let plain = crate::accel_common::build(&sphere(12), crate::accel_common::TREE);
    let from_outside = Ray::new(Vec3::new(5.0, 0.1, 0.2), Vec3::NEG_X);
    let from_inside = Ray::new(Vec3::ZERO, Vec3::X);
    let back_faces = |bvh: &Bvh| {
        let hit = |ray| bvh.intersect(ray).expect("a hit").back_face;
        [&from_outside, &from_inside].map(hit)
    };
    let expected = back_faces(&plain);
    assert_ne!(expected[0], expected[1]);
    for side in [1.0, -1.0] {
        let linear = DMat3::from_diagonal(DVec3::new(side, 1.0, 1.0));
        let target = Instanced::new(&[], &[sphere(12)], &[place(0, linear, DVec3::ZERO)]);
        assert_eq!(back_faces(&target.bvh), expected, "{side}");
    }
}

/// Instances nobody sees cost next to nothing, and those that are seen one element more each.
#[test]
fn elements_that_rays_look_at_are_counted() {
    let mut random = Random(9);
    let alone = Instanced::new(
        &[],
        &[terrain(20, 5)],
        &[place(0, DMat3::IDENTITY, DVec3::ZERO)],
    );
    let plain = crate::accel_common::build(&alone.placed, crate::accel_common::TREE);
    let (mut two, mut one) = (Steps::default(), Steps::default());
    for _ in 0..1000 {
        let ray = alone.ray(&mut random);
        alone.bvh.trace(&ray, false, &mut two);
        plain.trace(&ray, false, &mut one);
    }
    println!("{two:?}, one level {one:?}");
    assert!(two.pairs.abs_diff(one.pairs) * 100 < one.pairs);
    assert!(two.nodes > one.nodes && two.nodes <= one.nodes + 2000 + one.nodes / 100);
}

#[test]
fn the_structure_does_not_depend_on_the_threads() {
    let mut random = Random(5);
    let triangles = [soup(20_000, 0.01, 7), terrain(40, 8), sphere(40)].concat();
    let first = 20_000 + terrain(40, 8).len();
    let placements: Vec<_> = (0..5000)
        .map(|i| place(i % 2, turn(&mut random), random.point().as_dvec3() * 20.0))
        .collect();
    let input = TwoLevel {
        triangles: &triangles,
        world: 20_000,
        trees: &[20_000..first, first..triangles.len()],
        placements: &placements,
        reach: 0.0,
    };
    let with_threads = |n: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(n).build();
        let build = || Bvh::build_two_level(&input, &BuildOptions::default());
        pool.expect("threads").install(build).expect("few elements")
    };
    let one = with_threads(1);
    assert_eq!(one.validate(&triangles), Ok(()));
    for n in [2, 5] {
        assert!(one == with_threads(n), "{n} threads");
    }
}

#[test]
fn more_elements_than_numbers_are_refused() {
    let triangles = soup(20_000, 0.01, 7);
    let placements = vec![place(0, DMat3::IDENTITY, DVec3::ZERO); 200_000];
    let all = 0..triangles.len();
    let input = TwoLevel {
        triangles: &triangles,
        world: 0,
        trees: std::slice::from_ref(&all),
        placements: &placements,
        reach: 0.0,
    };
    let error = Bvh::build_two_level(&input, &BuildOptions::default()).expect_err("too many");
    assert!(error.count > error.limit && error.limit == (1 << 31) - 1);
}
