//! The traversal on the device against its oracle on the host: same hits, bit for bit where the
//! device rounds as the host does; and no way out of a closed mesh.

mod accel_common;
mod device_common;

use accel_common::{
    Random, boxes, build, cube, grid, nasty_ray, needles, scaled, soup, sphere, terrain,
};
use device_common::{Kernel, NODES, Setup, TRIANGLES, rounds_as_the_host, upload};
use etendue::accel::{Bvh, Hit};
use etendue::geometry::Ray;
use etendue::gpu::Buffer;
use etendue::render::layout;
use glam::Vec3;
use rayon::prelude::*;

type Mesh = Vec<[Vec3; 3]>;

/// Rays that each mesh gets at each scale: more than a million in all.
const RAYS: usize = 16_384;

/// Where the device contracts, t may differ by so many units of the last place, the barycentrics by
/// 1e-5, and one ray in 100,000 may meet another triangle (at edges and ties).
const ULPS: i64 = 64;

/// A tree on the device and on the host.
struct Target {
    bvh: Bvh,
    ordered: Mesh,
    buffers: [(u32, Buffer); 2],
}

impl Target {
    fn new(mesh: &[[Vec3; 3]]) -> Self {
        let (bvh, ordered) = build(mesh, 4, 16);
        let on_device = |[v0, v1, v2]: &[Vec3; 3]| layout::Triangle {
            v0: v0.to_array(),
            v1: v1.to_array(),
            v2: v2.to_array(),
            light: layout::NONE,
            ..Default::default()
        };
        let triangles: Vec<_> = ordered.iter().map(on_device).collect();
        Self {
            buffers: [
                (NODES, upload("nodes", &bvh.nodes)),
                (TRIANGLES, upload("triangles", &triangles)),
            ],
            bvh,
            ordered,
        }
    }

    /// The device's hits, and whether it found the rays occluded.
    fn trace(&self, kernel: &Kernel, rays: &[Ray]) -> Vec<(Option<Hit>, bool)> {
        let inputs: Vec<[[f32; 4]; 2]> = rays
            .iter()
            .map(|r| {
                let (o, d) = (r.origin.extend(r.t_max), r.direction.extend(0.0));
                [o.to_array(), d.to_array()]
            })
            .collect();
        let buffers: Vec<_> = self.buffers.iter().map(|(i, b)| (*i, b)).collect();
        let n = rays.len();
        let results: Vec<[[u32; 4]; 2]> = kernel.run(n as u32, [0; 3], &inputs, n, &buffers);
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

fn kernel() -> Kernel {
    Setup::new().kernel("traversal", "main")
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
        ("one", vec![[Vec3::ZERO, Vec3::X, Vec3::Y]]),
        ("all the same", vec![[Vec3::ZERO, Vec3::X, Vec3::Y]; 500]),
    ]
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
fn rays(target: &Target, seed: u64) -> Vec<Ray> {
    let mut random = Random(seed);
    (0..RAYS)
        .map(|i| {
            let mut ray = nasty_ray(&target.ordered, &mut random);
            if i % 4 == 3
                && let Some(hit) = target.bvh.intersect(&target.ordered, &ray)
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

fn compare(kernel: &Kernel, meshes: Vec<(&str, Mesh)>, exact: bool) -> Comparison {
    let mut sum = Comparison::default();
    for (m, (name, mesh)) in meshes.into_iter().enumerate() {
        for (p, (scale, offset)) in PLACES.into_iter().enumerate() {
            let target = Target::new(&scaled(&mesh, scale, offset));
            let rays = rays(&target, (10 * m + p) as u64);
            let found = target.trace(kernel, &rays);
            let expected: Vec<_> = rays
                .par_iter()
                .map(|r| target.bvh.intersect(&target.ordered, r))
                .collect();
            for ((ray, (hit, occluded)), expected) in rays.iter().zip(found).zip(expected) {
                sum.hits += usize::from(expected.is_some());
                if !agree(&hit, &expected, exact) || occluded != expected.is_some() {
                    sum.unlike += 1;
                    sum.first.get_or_insert_with(|| {
                        format!("{name}, scale {scale}, {ray:?}: {hit:?}, host {expected:?}")
                    });
                }
            }
            sum.rays += rays.len();
        }
    }
    sum
}

#[test]
fn device_and_host_find_the_same_hits() {
    let exact = rounds_as_the_host();
    let sum = compare(&kernel(), meshes(), exact);
    println!("bit for bit: {exact}, {sum:?}");
    assert!(sum.rays >= 1_000_000 && sum.hits * 3 > sum.rays);
    let allowed = if exact { 0 } else { sum.rays / 100_000 };
    assert!(sum.unlike <= allowed, "{sum:?}");
}

/// Negative control: ties that go to the larger position.
#[test]
fn a_wrong_tie_is_noticed() {
    let (from, to) = ("i < best.triangle", "i > best.triangle");
    let setup = Setup::new().patched("accel/bvh.wgsl", from, to);
    let kernel = setup.kernel("traversal", "main");
    let same = vec![[Vec3::ZERO, Vec3::X, Vec3::Y]; 500];
    let sum = compare(&kernel, vec![("all the same", same)], rounds_as_the_host());
    assert!(sum.unlike * 10 > sum.hits, "{sum:?}");
}

/// Rays from inside at every vertex, edge and middle, and along the axes.
fn escaping_rays(target: &Target, origin: Vec3, random: &mut Random) -> Vec<Ray> {
    let mut rays = Vec::new();
    for &[a, b, c] in &target.ordered {
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

fn escapes(kernel: &Kernel, mesh: &[[Vec3; 3]], radius: f32, center: Vec3) -> (usize, usize) {
    let (mut random, mut missed, mut all) = (Random(1), 0, 0);
    let target = Target::new(mesh);
    for offset in [Vec3::ZERO, Vec3::new(0.25, 0.0, -0.5), random.point() * 0.5] {
        let rays = escaping_rays(&target, center + offset * radius, &mut random);
        let found = target.trace(kernel, &rays);
        missed += found.iter().filter(|(h, o)| h.is_none() || !o).count();
        all += rays.len();
    }
    (missed, all)
}

#[test]
fn nothing_leaves_a_closed_mesh_on_the_device() {
    let kernel = kernel();
    let (mut missed, mut all) = (0, 0);
    let mut count = |(m, a)| {
        missed += m;
        all += a;
    };
    for scale in [1e-6, 1.0, 1e6] {
        for (mesh, radius) in [(sphere(24), 0.9), (cube(8), 1.0), (cube(7), 1.0)] {
            let mesh = scaled(&mesh, scale, Vec3::ZERO);
            count(escapes(&kernel, &mesh, radius * scale, Vec3::ZERO));
        }
    }
    let center = Vec3::new(1e6, -3e5, 2e6);
    let far = scaled(&sphere(24), 100.0, center);
    count(escapes(&kernel, &far, 50.0, center));
    println!("{all} rays from inside closed meshes");
    assert_eq!(missed, 0, "of {all}");
}

/// Negative control: edges that are not decided exactly lose hits.
#[test]
fn a_leaky_traversal_is_noticed() {
    let from = "return (difference + sum) + lost;";
    let to = "return select(difference, -1.0, difference == 0.0);";
    let kernel = Setup::new().patched("geometry/triangle.wgsl", from, to);
    let kernel = kernel.kernel("traversal", "main");
    assert!(escapes(&kernel, &cube(8), 1.0, Vec3::ZERO).0 > 0);
}
