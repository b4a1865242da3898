//! Structures of two levels on the device against the oracle on the host: same hits, bit for bit where the device
//! rounds as the host does; and no way out of a closed mesh that is an instance.

use crate::accel_common::Random;
use crate::accel_common::instances::{Instanced, place, structures, turn};
use crate::accel_common::{cube, sphere};
use crate::common::rays::{self, end_at_hit, ray_words};
use crate::common::{ELEMENTS, Kernel, Setup, rounds_as_the_host, stack, upload};
use etendue::accel::{Hit, MAX_DEPTH, Steps};
use etendue::geometry::Ray;
use etendue::render::program::stack_constants;
use glam::{DMat3, DVec3, Vec3};
use rayon::prelude::*;

/// Rays for each structure, and where one is traced several times.
const RAYS: usize = 65_536;
const FEWER_RAYS: usize = 16_384;

/// Where the device contracts, t may differ by so much of itself, the barycentrics by 1e-4, and one ray in 10,000 may meet
/// another triangle: it has another ray in an instance's space.
const T_ERROR: f32 = 1e-5;

/// The device's hits, and whether it found the rays occluded.
fn trace(
    kernel: &Kernel,
    target: &Instanced,
    rays: &[Ray],
    params: [u32; 3],
) -> Vec<(Option<Hit>, bool)> {
    let elements = upload("elements", &target.bvh.elements);
    rays::trace(kernel, &elements, rays, params)
}

/// A structure, rays that are hard to decide, some of them ending just at, before or behind their hit, and the host's hits.
struct Case {
    name: &'static str,
    target: Instanced,
    rays: Vec<Ray>,
    expected: Vec<Option<Hit>>,
}

impl Case {
    fn new((name, target): (&'static str, Instanced), count: usize) -> Self {
        let mut random = Random(5);
        let mut rays: Vec<_> = (0..count).map(|_| target.ray(&mut random)).collect();
        let intersect = |ray: &Ray| target.bvh.intersect(ray);
        let end = |(i, ray): (usize, &mut Ray)| end_at_hit(ray, i, intersect);
        rays.par_iter_mut().enumerate().for_each(end);
        let expected = rays.par_iter().map(intersect).collect();
        Self {
            name,
            target,
            rays,
            expected,
        }
    }

    /// A crowd of instances of uneven scales.
    fn crowd() -> Self {
        Self::new(structures().swap_remove(3), FEWER_RAYS)
    }

    /// The device's hits, and whether it found the rays occluded.
    fn trace(&self, kernel: &Kernel, params: [u32; 3]) -> Vec<(Option<Hit>, bool)> {
        trace(kernel, &self.target, &self.rays, params)
    }

    /// Rays whose answers are unlike the host's, and those that hit.
    fn compare(&self, kernel: &Kernel) -> (usize, usize) {
        let Self { name, rays, .. } = self;
        let mut unlike = 0;
        for ((ray, (hit, occluded)), expected) in rays
            .iter()
            .zip(self.trace(kernel, [0; 3]))
            .zip(&self.expected)
        {
            if !agree(&hit, expected) || occluded != expected.is_some() {
                if unlike == 0 {
                    println!("{name}, {ray:?}: {hit:?}, host {expected:?}");
                }
                unlike += 1;
            }
        }
        let hits = self.expected.iter().flatten().count();
        println!(
            "{name}: {hits} hits of {} rays, {unlike} unlike the host's",
            rays.len()
        );
        (unlike, hits)
    }

    /// How many may be unlike.
    fn allowed(&self) -> usize {
        if rounds_as_the_host() {
            0
        } else {
            self.rays.len() / 10_000
        }
    }
}

/// Whether two hits agree as far as the device's rounding lets them.
fn agree(device: &Option<Hit>, host: &Option<Hit>) -> bool {
    match (device, host) {
        (Some(d), Some(h)) if !rounds_as_the_host() => {
            let same_place = (0..3).all(|i| (d.b[i] - h.b[i]).abs() < 1e-4);
            d.triangle == h.triangle && (d.t - h.t).abs() <= T_ERROR * h.t && same_place
        }
        _ => device == host,
    }
}

/// A kernel for all structures with instances: its stack has room for the deepest.
fn kernel(setup: &Setup, target: &Instanced) -> Kernel {
    assert!(target.bvh.has_instances());
    let setup = setup.clone().structure(&target.bvh);
    setup.with(stack(MAX_DEPTH)).kernel("traversal", "main")
}

#[test]
fn device_and_host_find_the_same_hits() {
    let structures = structures();
    let kernel = kernel(&Setup::new(), &structures[0].1);
    for structure in structures {
        let case = Case::new(structure, RAYS);
        let (unlike, hits) = case.compare(&kernel);
        assert!(
            unlike <= case.allowed() && hits * 3 > RAYS,
            "{}: {unlike}",
            case.name
        );
    }
}

/// The notes of where to return to are on the stack in either memory.
#[test]
fn the_stack_may_be_in_either_memory() {
    let case = Case::crowd();
    let bvh = &case.target.bvh;
    for workgroup_bytes in [0, u32::MAX] {
        let constants = stack_constants(bvh.depth, workgroup_bytes);
        let setup = Setup::new().structure(bvh).with(constants);
        let (unlike, _) = case.compare(&setup.kernel("traversal", "main"));
        assert!(unlike <= case.allowed());
    }
}

/// The two rays of a query, traced one after the other and in rounds of a few elements, get the answers that each
/// gets alone.
#[test]
fn rays_that_are_traced_together_are_answered_as_alone() {
    let case = Case::crowd();
    let rays = &case.rays;
    let setup = Setup::new().structure(&case.target.bvh);
    let expected = case.trace(&setup.kernel("traversal", "main"), [0; 3]);
    let together = setup.kernel("traversal", "together");
    for (shift, round) in [(0, u32::MAX), (1, 1), (7, 2), (100, 16)] {
        let found = case.trace(&together, [shift, round, 0]);
        for i in 0..rays.len() {
            assert_eq!(found[i].0, expected[i].0, "{shift} {round} {:?}", rays[i]);
            let other = (i + rays.len() - shift as usize) % rays.len();
            assert_eq!(found[i].1, expected[other].1, "{shift} {round} {i}");
        }
    }
}

/// Negative controls: hits of another instance's number, t that is taken from the wrong space, returning to the wrong
/// ray, instances of which the last is forgotten.
#[test]
fn mistakes_are_noticed() {
    let case = Case::crowd();
    for (from, to) in [
        ("index + element_shift", "index"),
        ("  settle(t);\n  var waiting", "  var waiting"),
        ("      settle(t);\n      go_to_world", "      go_to_world"),
        ("      go_to_world(t);\n", ""),
        (
            "select((*t).best_instance, (*t).instance,",
            "select((*t).best_instance, 0u,",
        ),
        (
            "waiting.entry |= RETURN_FLAG",
            "waiting = Group(0u, 0u, RETURN_FLAG)",
        ),
    ] {
        let setup = Setup::new().patched("accel/instances.wgsl", from, to);
        let (unlike, hits) = case.compare(&kernel(&setup, &case.target));
        assert!(unlike * 1000 > hits, "{from}: {unlike} of {hits}");
    }
}

/// What `--stats` counts is what the host looks at: a few elements more, since the device knows the distance of the
/// closest hit by its upper bound.
#[test]
fn the_device_counts_what_the_host_looks_at() {
    let Case { target, rays, .. } = Case::new(structures().swap_remove(1), 4096);
    let setup = Setup::new().on(&["COUNT_RAYS"]).structure(&target.bvh);
    let elements = upload("elements", &target.bvh.elements);
    let buffers = [(ELEMENTS, &elements)];
    let kernel = setup.kernel("counts", "traversal");
    let found: Vec<[u32; 4]> = kernel.run(
        rays.len() as u32,
        [0; 3],
        &ray_words(&rays),
        rays.len(),
        &buffers,
    );
    let mut expected = Steps::default();
    for ray in &rays {
        target.bvh.trace(ray, false, &mut expected);
        target.bvh.trace(ray, true, &mut expected);
    }
    let expected = expected.nodes + expected.pairs;
    let found: u64 = found.iter().flatten().map(|&n| u64::from(n)).sum();
    assert!(
        found.abs_diff(expected) * 100 < expected,
        "{found}, the host has {expected}"
    );
}

#[test]
fn nothing_leaves_a_closed_instance_on_the_device() {
    let mut random = Random(3);
    let (mut missed, mut all) = (0, 0);
    let mut any = None;
    for (mesh, radius) in [(sphere(24), 0.9), (cube(7), 1.0)] {
        for scale in [1e-6, 1.0, 1e6] {
            for offset in [DVec3::ZERO, DVec3::new(1e4, -3e3, 2e4) * scale] {
                let linear =
                    turn(&mut random) * DMat3::from_diagonal(DVec3::new(1.0, -0.3, 2.0) * scale);
                let placement = place(0, linear, offset);
                let target = Instanced::new(&[], std::slice::from_ref(&mesh), &[placement]);
                let start = random.point().as_dvec3() * 0.3 * radius;
                let origin = (placement.forward() * start + offset).as_vec3();
                let mut rays: Vec<Ray> = (0..20_000)
                    .map(|_| Ray::new(origin, random.direction()))
                    .collect();
                for &[a, b, c] in &target.placed {
                    let points = [a, a * 0.5 + b * 0.5, (a + b + c) / 3.0];
                    rays.extend(points.map(|point| Ray::new(origin, point - origin)));
                }
                for axis in [Vec3::X, Vec3::Y, Vec3::Z] {
                    rays.extend([Ray::new(origin, axis), Ray::new(origin, -axis)]);
                }
                let kernel = any.get_or_insert_with(|| kernel(&Setup::new(), &target));
                let found = trace(kernel, &target, &rays, [0; 3]);
                missed += found.iter().filter(|(h, o)| h.is_none() || !o).count();
                all += rays.len();
            }
        }
    }
    println!("{all} rays from inside closed instances");
    assert_eq!(missed, 0, "of {all}");
}
