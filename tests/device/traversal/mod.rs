//! The traversal on the device against its oracle on the host: same hits, bit for bit where the
//! device rounds as the host does; and no way out of a closed mesh.

mod closed;
mod list;
mod target;

use crate::accel_common::{
    LIST, Random, TREE, boxes, build, cube, grid, needles, soup, sphere, terrain,
};
use crate::common::Setup;
use etendue::render::program::stack_constants;
use glam::Vec3;
use target::{Mesh, Target, compare, rays};

/// Rays that each mesh gets at each scale: more than a million in all.
const RAYS: usize = 16_384;

fn meshes() -> Vec<(&'static str, Mesh)> {
    let stacked = [sphere(8), sphere(8), cube(4), cube(4)].concat();
    vec![
        ("soup", soup(1000, 0.2, 1)),
        ("dust", soup(1000, 1e-3, 2)),
        ("overlapping", soup(200, 1.0, 3)),
        ("needles", needles(300, 4)),
        ("terrain", terrain(24, 5)),
        (
            "flat",
            grid(16, 16, |i, j| Vec3::new(i as f32, 0.0, j as f32)),
        ),
        (
            "long strips",
            grid(64, 1, |i, j| {
                Vec3::new(i as f32 * 0.01, 0.3, j as f32 * 100.0)
            }),
        ),
        ("boxes", boxes(16)),
        ("cube", cube(8)),
        ("sphere", sphere(24)),
        ("coincident", stacked),
        ("layers", layers()),
        ("one", vec![[Vec3::ZERO, Vec3::X, Vec3::Y]]),
        ("all the same", vec![[Vec3::ZERO, Vec3::X, Vec3::Y]; 500]),
    ]
}

/// Triangles of all shapes, four of each, whose vertices are a few units of the last place apart.
fn layers() -> Mesh {
    let mut random = Random(6);
    // No denormal numbers, which some devices flush.
    let mut nudged = |x: f32| x * (1.0 + random.below(5) as f32 * f32::EPSILON);
    [soup(60, 0.5, 7), needles(60, 8)]
        .concat()
        .into_iter()
        .flat_map(|triangle| [triangle; 4])
        .map(|triangle| triangle.map(|v| Vec3::from(v.to_array().map(&mut nudged))))
        .collect()
}

/// Few enough triangles for a list.
fn small_meshes() -> Vec<(&'static str, Mesh)> {
    vec![
        ("soup", soup(24, 0.3, 1)),
        ("needles", needles(24, 4)),
        ("terrain", terrain(4, 5)),
        ("cube", cube(2)),
        ("boxes", boxes(3)),
        ("coincident", [cube(1), cube(1)].concat()),
        ("one", vec![[Vec3::ZERO, Vec3::X, Vec3::Y]]),
    ]
}

#[test]
fn device_and_host_find_the_same_hits_in_a_tree() {
    let sum = compare(&Setup::new(), meshes(), TREE, RAYS);
    assert!(sum.rays >= 1_000_000);
    sum.assert_alike();
}

/// The traversal's stack is in the workgroup's memory if it fits there, and else private.
#[test]
fn the_stack_may_be_in_either_memory() {
    let mesh = terrain(40, 5);
    let depth = build(&mesh, TREE).depth;
    for workgroup_bytes in [0, u32::MAX] {
        let setup = Setup::new().with(stack_constants(depth, workgroup_bytes));
        compare(&setup, vec![("terrain", mesh.clone())], TREE, RAYS).assert_alike();
    }
}

#[test]
fn device_and_host_find_the_same_hits_in_a_list() {
    compare(&Setup::new(), small_meshes(), LIST, RAYS).assert_alike();
}

/// The two rays of a query, traced one after the other and in rounds of a few elements, get the
/// answers that each gets alone.
#[test]
fn rays_that_are_traced_together_are_answered_as_alone() {
    for limit in [TREE, LIST] {
        for mesh in [
            terrain(4, 5),
            [sphere(4), cube(1)].concat(),
            soup(40, 0.5, 9),
        ] {
            let target = Target::new(&mesh, limit);
            let alone = target.kernel(&Setup::new(), "main");
            let together = target.kernel(&Setup::new(), "together");
            let rays = rays(&target, RAYS, 1);
            let expected = target.trace(&alone, &rays);
            let hits = expected.iter().filter(|(hit, _)| hit.is_some()).count();
            assert!(hits * 3 > RAYS && hits < RAYS, "{hits}");
            for (shift, round) in [(0, u32::MAX), (1, 1), (7, 2), (100, 16)] {
                let found = target.trace_with(&together, &rays, [shift, round, 0]);
                for i in 0..RAYS {
                    assert_eq!(
                        found[i].0, expected[i].0,
                        "{limit} {shift} {round} {:?}",
                        rays[i]
                    );
                    let other = (i + RAYS - shift as usize) % RAYS;
                    assert_eq!(found[i].1, expected[other].1, "{limit} {shift} {round} {i}");
                }
            }
        }
    }
}

/// Negative control: ties that go to the larger number.
#[test]
fn a_wrong_tie_is_noticed() {
    let (from, to) = ("id < best.triangle", "id > best.triangle");
    let setup = Setup::new().patched("accel/closest.wgsl", from, to);
    let same = vec![[Vec3::ZERO, Vec3::X, Vec3::Y]; 500];
    let sum = compare(&setup, vec![("all the same", same)], TREE, RAYS);
    assert!(sum.unlike * 10 > sum.hits, "{sum:?}");
    let (from, to) = ("hit.t < so_far.t", "hit.t <= so_far.t");
    let setup = Setup::new().patched("accel/list.wgsl", from, to);
    let same = vec![[Vec3::ZERO, Vec3::X, Vec3::Y]; 5];
    let sum = compare(&setup, vec![("all the same", same)], LIST, RAYS);
    assert!(sum.unlike * 10 > sum.hits, "{sum:?}");
}

/// Negative control: hits that are put in order by a t that is less exact than it is said to be.
#[test]
fn bounds_that_are_too_narrow_are_noticed() {
    for (from, to) in [
        ("t - error, t + error", "t, t"),
        ("EDGE_SLACK * (span", "0.0 * (span"),
        ("DEPTH_SLACK * depth", "0.0 * depth"),
    ] {
        let setup = Setup::new().patched("geometry/triangle.wgsl", from, to);
        let sum = compare(&setup, vec![("layers", layers())], TREE, RAYS);
        assert!(sum.unlike * 10_000 > sum.hits, "{to}: {sum:?}");
    }
}

/// Negative control: children that are visited although they are not there, or left out.
#[test]
fn a_child_too_few_is_noticed() {
    let (from, to) = ("slots <= vec4u(count)", "slots < vec4u(count)");
    let setup = Setup::new().patched("accel/boxes.wgsl", from, to);
    let sum = compare(&setup, vec![("cube", cube(8))], TREE, RAYS);
    assert!(sum.unlike * 100 > sum.hits, "{sum:?}");
}
