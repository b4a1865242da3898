//! The traversal on the device against its oracle on the host: same hits, bit for bit where the
//! device rounds as the host does; and no way out of a closed mesh.

mod accel_common;
mod device_common;

use accel_common::{
    LIST, Random, TREE, boxes, build, cube, grid, nasty_ray, needles, scaled, soup, sphere, terrain,
};
use device_common::{ELEMENTS, Kernel, Setup, rounds_as_the_host, upload};
use etendue::accel::{Bvh, Hit};
use etendue::geometry::Ray;
use etendue::gpu::Buffer;
use etendue::render::program::stack_constants;
use glam::Vec3;
use rayon::prelude::*;

type Mesh = Vec<[Vec3; 3]>;

/// Rays that each mesh gets at each scale: more than a million in all.
const RAYS: usize = 16_384;

/// Where the device contracts, t may differ by so many units of the last place, the barycentrics by
/// 1e-5, and one ray in 100,000 may meet another triangle (at edges and ties).
const ULPS: i64 = 64;

/// A structure on the device and on the host.
struct Target {
    bvh: Bvh,
    mesh: Mesh,
    elements: Buffer,
}

impl Target {
    fn new(mesh: &[[Vec3; 3]], list_limit: usize) -> Self {
        let bvh = build(mesh, list_limit);
        Self {
            elements: upload("elements", &bvh.elements),
            bvh,
            mesh: mesh.to_vec(),
        }
    }

    /// A kernel for this list, or for any tree.
    fn kernel(&self, setup: &Setup, entry: &str) -> Kernel {
        let setup = setup.clone();
        if self.bvh.is_list() {
            setup.structure(&self.bvh).kernel("traversal", entry)
        } else {
            setup.kernel("traversal", entry)
        }
    }

    /// The device's hits, and whether it found the rays occluded.
    fn trace(&self, kernel: &Kernel, rays: &[Ray]) -> Vec<(Option<Hit>, bool)> {
        self.trace_with(kernel, rays, [0; 3])
    }

    fn trace_with(
        &self,
        kernel: &Kernel,
        rays: &[Ray],
        params: [u32; 3],
    ) -> Vec<(Option<Hit>, bool)> {
        let inputs: Vec<[[f32; 4]; 2]> = rays
            .iter()
            .map(|r| {
                let (o, d) = (r.origin.extend(r.t_max), r.direction.extend(0.0));
                [o.to_array(), d.to_array()]
            })
            .collect();
        let buffers = [(ELEMENTS, &self.elements)];
        let n = rays.len();
        let results: Vec<[[u32; 4]; 2]> = kernel.run(n as u32, params, &inputs, n, &buffers);
        let hit = |[a, b]: &[[u32; 4]; 2]| Hit {
            t: f32::from_bits(a[0]),
            triangle: a[1],
            b: [b[0], b[1], b[2]].map(f32::from_bits),
            back_face: a[2] == 1,
        };
        results
            .iter()
            .map(|r| ((r[0][1] != u32::MAX).then(|| hit(r)), r[0][3] == 1))
            .collect()
    }
}

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

/// As is, tiny, huge, and far from the origin.
const PLACES: [(f32, Vec3); 5] = [
    (1.0, Vec3::ZERO),
    (1e-6, Vec3::ZERO),
    (1e6, Vec3::ZERO),
    (1.0, Vec3::splat(1e6)),
    (1e3, Vec3::new(1e6, -3e5, 2e6)),
];

/// Rays that are hard to decide, some of them ending just at, before or behind their hit.
fn rays(target: &Target, count: usize, seed: u64) -> Vec<Ray> {
    let mut random = Random(seed);
    (0..count)
        .map(|i| {
            let mut ray = nasty_ray(&target.mesh, &mut random);
            if i % 4 == 3
                && let Some(hit) = target.bvh.intersect(&ray)
            {
                ray.t_max = [hit.t, hit.t.next_down(), hit.t.next_up()][i / 4 % 3];
            }
            ray
        })
        .collect()
}

fn ulps(a: f32, b: f32) -> i64 {
    (i64::from(a.to_bits()) - i64::from(b.to_bits())).abs()
}

/// Whether two hits agree as far as the device's rounding lets them.
fn agree(device: &Option<Hit>, host: &Option<Hit>, exact: bool) -> bool {
    match (device, host) {
        (Some(d), Some(h)) if !exact => {
            let same_place = (0..3).all(|i| (d.b[i] - h.b[i]).abs() < 1e-5);
            d.triangle == h.triangle && ulps(d.t, h.t) <= ULPS && same_place
        }
        _ => device == host,
    }
}

/// How a device's kernel fares against the host.
#[derive(Debug, Default)]
struct Comparison {
    rays: usize,
    hits: usize,
    unlike: usize,
    first: Option<String>,
}

impl Comparison {
    /// Compares what the device found with what the host finds.
    fn add(&mut self, name: &str, target: &Target, rays: &[Ray], found: &[(Option<Hit>, bool)]) {
        let exact = rounds_as_the_host();
        let expected: Vec<_> = rays.par_iter().map(|r| target.bvh.intersect(r)).collect();
        for ((ray, (hit, occluded)), expected) in rays.iter().zip(found).zip(expected) {
            self.hits += usize::from(expected.is_some());
            if !agree(hit, &expected, exact) || *occluded != expected.is_some() {
                self.unlike += 1;
                self.first
                    .get_or_insert_with(|| format!("{name}, {ray:?}: {hit:?}, host {expected:?}"));
            }
        }
        self.rays += rays.len();
    }

    fn assert_alike(&self) {
        let exact = rounds_as_the_host();
        println!("bit for bit: {exact}, {self:?}");
        let allowed = if exact { 0 } else { self.rays / 100_000 };
        assert!(
            self.hits * 3 > self.rays && self.unlike <= allowed,
            "{self:?}"
        );
    }
}

fn compare(
    setup: &Setup,
    meshes: Vec<(&str, Mesh)>,
    list_limit: usize,
    count: usize,
) -> Comparison {
    let mut sum = Comparison::default();
    // One for all trees; the text of a list is its own.
    let mut kernel: Option<Kernel> = None;
    for (m, (name, mesh)) in meshes.into_iter().enumerate() {
        for (p, (scale, offset)) in PLACES.into_iter().enumerate() {
            let target = Target::new(&scaled(&mesh, scale, offset), list_limit);
            if target.bvh.is_list() {
                kernel = None;
            }
            let kernel = kernel.get_or_insert_with(|| target.kernel(setup, "main"));
            let rays = rays(&target, count, (10 * m + p) as u64);
            let found = target.trace(kernel, &rays);
            sum.add(&format!("{name}, scale {scale}"), &target, &rays, &found);
        }
    }
    sum
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
