//! Structures on the device and on the host, and how far they agree.

use etendue::accel::{Bvh, Hit};
use etendue::geometry::Ray;
use etendue::gpu::Buffer;
use etendue::render::program::device_elements;
use glam::Vec3;
use rayon::prelude::*;

use crate::accel_common::{Random, build, nasty_ray, scaled};
use crate::common::rays::{self, end_at_hit};
use crate::common::{Kernel, Setup, rounds_as_the_host, upload};

pub type Mesh = Vec<[Vec3; 3]>;

/// Where the device contracts, t may differ by so many units of the last place, the barycentrics by
/// 1e-5, and one ray in 100,000 may meet another triangle (at edges and ties).
const ULPS: i64 = 64;

/// A structure on the device and on the host.
pub struct Target {
    pub bvh: Bvh,
    pub mesh: Mesh,
    pub elements: Buffer,
}

impl Target {
    pub fn new(mesh: &[[Vec3; 3]], list_limit: usize) -> Self {
        let bvh = build(mesh, list_limit);
        Self {
            elements: upload("elements", &device_elements(&bvh)),
            bvh,
            mesh: mesh.to_vec(),
        }
    }

    /// A kernel for this list, or for any tree.
    pub fn kernel(&self, setup: &Setup, entry: &str) -> Kernel {
        let setup = setup.clone();
        if self.bvh.is_list() {
            setup.structure(&self.bvh).kernel("traversal", entry)
        } else {
            setup.kernel("traversal", entry)
        }
    }

    /// The device's hits, and whether it found the rays occluded.
    pub fn trace(&self, kernel: &Kernel, rays: &[Ray]) -> Vec<(Option<Hit>, bool)> {
        self.trace_with(kernel, rays, [0; 3])
    }

    pub fn trace_with(
        &self,
        kernel: &Kernel,
        rays: &[Ray],
        params: [u32; 3],
    ) -> Vec<(Option<Hit>, bool)> {
        rays::trace(kernel, &self.elements, rays, params)
    }
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
pub fn rays(target: &Target, count: usize, seed: u64) -> Vec<Ray> {
    let mut random = Random(seed);
    let ray = |_| nasty_ray(&target.mesh, &mut random);
    let mut rays: Vec<_> = (0..count).map(ray).collect();
    let end = |(i, ray): (usize, &mut Ray)| end_at_hit(ray, i, |ray| target.bvh.intersect(ray));
    rays.par_iter_mut().enumerate().for_each(end);
    rays
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
pub struct Comparison {
    pub rays: usize,
    pub hits: usize,
    pub unlike: usize,
    first: Option<String>,
}

impl Comparison {
    /// Compares what the device found with what the host finds.
    fn add(&mut self, name: &str, target: &Target, rays: &[Ray], found: &[(Option<Hit>, bool)]) {
        let exact = rounds_as_the_host();
        let answer = |r: &Ray| (target.bvh.intersect(r), target.bvh.occluded(r));
        let answers: Vec<_> = rays.par_iter().map(answer).collect();
        for ((ray, (hit, occluded)), (expected, is_met)) in rays.iter().zip(found).zip(answers) {
            self.hits += usize::from(expected.is_some());
            if !agree(hit, &expected, exact) || *occluded != is_met {
                self.unlike += 1;
                self.first
                    .get_or_insert_with(|| format!("{name}, {ray:?}: {hit:?}, host {expected:?}"));
            }
        }
        self.rays += rays.len();
    }

    pub fn assert_alike(&self) {
        let exact = rounds_as_the_host();
        println!("bit for bit: {exact}, {self:?}");
        let allowed = if exact { 0 } else { self.rays / 100_000 };
        assert!(
            self.hits * 3 > self.rays && self.unlike <= allowed,
            "{self:?}"
        );
    }
}

/// Meshes at all places against the host.
pub fn compare(
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
