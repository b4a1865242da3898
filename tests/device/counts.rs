//! What `--stats` counts on the device: the elements that the traversal on the host looks at.

use crate::accel_common::{LIST, Random, TREE, build, cube, nasty_ray, soup, sphere};
use crate::common::rays::ray_words;
use crate::common::{ELEMENTS, Setup, device, rounds_as_the_host, upload};
use etendue::accel::{Bvh, Steps};
use etendue::geometry::Ray;
use etendue::render::layout::ElementCounts;
use etendue::render::program::device_elements;
use glam::Vec3;

const RAYS: usize = 4096;
/// Binding of the sums.
const ELEMENT_COUNTS: u32 = 9;

fn on_the_host(bvh: &Bvh, ray: &Ray) -> [u32; 4] {
    let counted = |any_hit| {
        let mut steps = Steps::default();
        bvh.trace(ray, any_hit, &mut steps);
        [steps.nodes as u32, steps.pairs as u32]
    };
    let (closest, any) = (counted(false), counted(true));
    [closest[0], closest[1], any[0], any[1]]
}

fn on_the_device(bvh: &Bvh, rays: &[Ray]) -> Vec<[u32; 4]> {
    let elements = upload("elements", &device_elements(bvh));
    let setup = Setup::new().on(&["COUNT_RAYS"]).structure(bvh);
    let kernel = setup.kernel("counts", "traversal");
    let count = rays.len();
    kernel.run(
        count as u32,
        [0; 3],
        &ray_words(rays),
        count,
        &[(ELEMENTS, &elements)],
    )
}

/// On the device the distance of the closest hit so far is known by its upper bound: it may look at a
/// few elements more. Where it rounds otherwise, one ray in a hundred may go another way.
fn check(name: &str, mesh: &[[Vec3; 3]], list_limit: usize) {
    let bvh = build(mesh, list_limit);
    let mut random = Random(7);
    let rays: Vec<Ray> = (0..RAYS).map(|_| nasty_ray(mesh, &mut random)).collect();
    let found = on_the_device(&bvh, &rays);
    let expected: Vec<_> = rays.iter().map(|ray| on_the_host(&bvh, ray)).collect();
    let as_few = |[n, p, any_n, any_p]: [u32; 4], e: [u32; 4]| {
        n >= e[0] && p >= e[1] && [any_n, any_p] == [e[2], e[3]]
    };
    let others = found
        .iter()
        .zip(&expected)
        .filter(|&(&f, &e)| !as_few(f, e));
    let allowed = if rounds_as_the_host() { 0 } else { RAYS / 100 };
    let count = others.count();
    assert!(
        count <= allowed,
        "{name}: {count} of {RAYS} rays have other counts"
    );
    let sum = |counts: &[[u32; 4]]| counts.iter().flatten().map(|&n| u64::from(n)).sum::<u64>();
    let (found, expected) = (sum(&found), sum(&expected));
    assert!(
        expected > RAYS as u64 && found.abs_diff(expected) * 100 < expected,
        "{name}: {found} elements for all rays, the host has {expected}"
    );
}

#[test]
fn the_device_counts_what_the_host_looks_at() {
    check("soup", &soup(1000, 0.2, 1), TREE);
    check("sphere", &sphere(24), TREE);
    check("soup, a list", &soup(12, 0.5, 1), LIST);
}

#[test]
fn a_list_counts_all_its_pairs_and_no_node() {
    let mesh = soup(12, 0.5, 1);
    let bvh = build(&mesh, LIST);
    let pairs = bvh.elements.len() as u32;
    let ray = nasty_ray(&mesh, &mut Random(3));
    assert_eq!(on_the_device(&bvh, &[ray]), [[0, pairs, 0, pairs]]);
}

/// Planes tell which pair of a solid the closest hit is on, and near an edge all pairs do.
#[test]
fn a_solid_counts_the_pair_that_is_met() {
    let bvh = build(&cube(1), LIST);
    let through = |x: f32| Ray::new(Vec3::new(x, 0.3, 0.9), -Vec3::Z);
    let counts = on_the_device(&bvh, &[through(0.2), through(1.0)]);
    assert_eq!(counts[0], [0, 1, 0, 0]);
    assert!(counts[1][1] == 7 && counts[1][3] > 0, "{:?}", counts[1]);
}

#[test]
fn the_sums_carry_beyond_32_bits() {
    const LANES: u32 = 1000;
    let (nodes, pairs) = (u32::MAX - 5, 0x4000_0001);
    let sums = upload("element counts", &[ElementCounts::default()]);
    let kernel = Setup::new().on(&["COUNT_RAYS"]).kernel("counts", "total");
    let others = [(ELEMENT_COUNTS, &sums)];
    kernel.run::<_, [u32; 4]>(
        LANES,
        [nodes, pairs, 0],
        &[[0_f32; 4]],
        LANES as usize,
        &others,
    );
    let read: Vec<ElementCounts> = device().read(&sums, 0, 1).expect("the sums");
    let wide = |low: u32, high: u32| u64::from(high) << 32 | u64::from(low);
    let n = u64::from(LANES);
    assert_eq!(
        wide(read[0].nodes_low, read[0].nodes_high),
        n * u64::from(nodes)
    );
    assert_eq!(
        wide(read[0].pairs_low, read[0].pairs_high),
        n * u64::from(pairs)
    );
}
