//! The builder on degenerate input, and the validator on broken trees.

mod accel_common;

use accel_common::*;
use etendue::accel::{BuildOptions, Bvh, BvhError, MAX_DEPTH, Side};
use etendue::geometry::Ray;
use glam::Vec3;
use proptest::prelude::*;
use std::time::Instant;

fn degenerate_inputs() -> Vec<(&'static str, Triangles)> {
    let triangle = [Vec3::ZERO, Vec3::X, Vec3::Y];
    let on_a_line = |i: usize| {
        [
            Vec3::X * i as f32,
            Vec3::X * (i + 1) as f32,
            Vec3::X * i as f32,
        ]
    };
    // Centroids at powers of two: the heuristic alone would peel them off one by one.
    let exponential = |i: i32| triangle.map(|v| v + Vec3::X * 2f32.powi(i % 250 - 125));
    vec![
        ("none", vec![]),
        ("one", vec![triangle]),
        ("two", vec![triangle; 2]),
        ("points", vec![[Vec3::ONE; 3]; 100]),
        (
            "distinct points",
            (0..100).map(|i| [Vec3::ONE * i as f32; 3]).collect(),
        ),
        ("on a line", (0..1000).map(on_a_line).collect()),
        ("coincident", vec![triangle; 1000]),
        (
            "concentric",
            (1..500)
                .map(|i| triangle.map(|v| (v - 0.5) * i as f32))
                .collect(),
        ),
        ("exponential", (0..2000).map(exponential).collect()),
        ("huge", scaled(&soup(500, 0.1, 1), 1e30, Vec3::ZERO)),
        ("largest", vec![[Vec3::MIN, Vec3::MAX, Vec3::ZERO]; 20]),
        ("tiny", scaled(&soup(500, 0.1, 2), 1e-30, Vec3::ZERO)),
        ("subnormal", scaled(&soup(500, 0.1, 3), 1e-42, Vec3::ZERO)),
        (
            "far away",
            scaled(&soup(500, 0.1, 4), 1.0, Vec3::splat(1e7)),
        ),
        (
            "huge and tiny",
            [soup(200, 1e30, 5), soup(200, 1e-30, 6)].concat(),
        ),
        (
            "negative zero",
            vec![[-Vec3::ZERO, Vec3::ZERO, -Vec3::X]; 9],
        ),
    ]
}

#[test]
fn degenerate_inputs_build_valid_trees() {
    for (name, triangles) in degenerate_inputs() {
        for max_leaf_size in [0, 1, 4, 15, 1000] {
            for bins in [0, 16, 1000] {
                println!("{name}, leaves of {max_leaf_size}, {bins} bins");
                let (bvh, ordered) = build(&triangles, max_leaf_size, bins);
                let ray = Ray::new(Vec3::new(0.2, 0.2, 5.0), -Vec3::Z);
                assert_eq!(bvh.intersect(&ordered, &ray), brute_force(&ordered, &ray));
                assert_eq!(
                    bvh.occluded(&ordered, &ray),
                    bvh.intersect(&ordered, &ray).is_some()
                );
            }
        }
    }
}

#[test]
fn a_million_coincident_triangles_build_fast_and_evenly() {
    let triangles = vec![[Vec3::ZERO, Vec3::X, Vec3::Y]; 1_000_000];
    let start = Instant::now();
    let (bvh, ordered) = build(&triangles, 4, 16);
    // Generous: a quadratic builder would take hours.
    let seconds = start.elapsed().as_secs();
    assert!(seconds < 60, "{seconds} s");
    assert!(bvh.depth <= 20, "{}", bvh.depth);
    // Every triangle ties: the first in the tree's order wins.
    let hit = bvh.intersect(&ordered, &Ray::new(Vec3::new(0.2, 0.2, 1.0), -Vec3::Z));
    assert_eq!(hit.map(|hit| (hit.t, hit.triangle)), Some((1.0, 0)));
}

/// A measurement: `cargo test --release --test accel_build -- --ignored --nocapture`.
#[test]
#[ignore = "measures the build time of a million triangles"]
fn time_of_a_million_triangles() {
    for (name, triangles) in [
        ("terrain", terrain(708, 1)),
        ("soup", soup(1_000_000, 0.01, 2)),
    ] {
        for _ in 0..3 {
            let start = Instant::now();
            let bvh = Bvh::build(&triangles, &BuildOptions::default());
            let (seconds, n) = (start.elapsed().as_secs_f64(), triangles.len());
            let (nodes, cost) = (bvh.nodes.len(), bvh.sah_cost());
            println!("{name}: {n} triangles, {nodes} nodes, {seconds:.2} s, cost {cost:.1}");
        }
    }
}

#[test]
fn exponential_spacing_stays_within_the_stack() {
    // 60 octaves with many triangles in the smallest: peeling would go 60 deep before it halves.
    let small = |i: i32| [Vec3::ZERO, Vec3::X, Vec3::Y].map(|v| v * 1e-37 * i as f32);
    let large = |i: i32| [Vec3::ZERO, Vec3::X, Vec3::Y].map(|v| v + Vec3::splat(2f32.powi(i)));
    let triangles: Triangles = (0..4000).map(small).chain((-120..120).map(large)).collect();
    for bins in [2, 16] {
        let (bvh, _) = build(&triangles, 1, bins);
        println!("{bins} bins: depth {}", bvh.depth);
        assert!(bvh.depth <= MAX_DEPTH && bvh.depth > 20, "{}", bvh.depth);
    }
}

#[test]
fn the_tree_does_not_depend_on_the_threads() {
    // Enough for every parallel path, with zeros of both signs.
    let mut triangles = soup(80_000, 0.01, 7);
    triangles.extend(scaled(&terrain(40, 8), -1.0, Vec3::ZERO));
    let options = BuildOptions::default();
    let with_threads = |n: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(n).build();
        pool.expect("threads")
            .install(|| Bvh::build(&triangles, &options))
    };
    let one = with_threads(1);
    assert!(one.validate(&triangles).is_ok());
    let bytes = |bvh: &Bvh| bytemuck::cast_slice::<_, u8>(&bvh.nodes).to_vec();
    for n in [2, 3, 8] {
        let other = with_threads(n);
        assert_eq!(one.order, other.order);
        assert!(bytes(&one) == bytes(&other), "{n} threads");
    }
}

#[test]
fn the_heuristic_beats_an_even_split() {
    let triangles = [
        terrain(60, 9),
        scaled(&sphere(20), 0.05, Vec3::new(3.0, 2.0, 1.0)),
    ]
    .concat();
    let (fine, _) = build(&triangles, 4, 16);
    let (coarse, _) = build(&triangles, 15, 2);
    assert!(
        fine.sah_cost() > 1.0 && fine.sah_cost() < 30.0,
        "{}",
        fine.sah_cost()
    );
    assert!(fine.sah_cost() <= coarse.sah_cost() * 1.05);
}

#[test]
fn children_come_after_their_parents() {
    let (bvh, _) = build(&soup(3000, 0.1, 10), 2, 16);
    for (i, node) in bvh.nodes.iter().enumerate() {
        for (index, count) in [(node.left, node.left_count), (node.right, node.right_count)] {
            assert!(count > 0 || index as usize > i);
        }
    }
}

/// Breaks a valid tree and returns what the validator says.
fn broken(break_it: impl Fn(&mut Bvh)) -> BvhError {
    let triangles = soup(40, 0.2, 11);
    let (mut bvh, _) = build(&triangles, 4, 16);
    break_it(&mut bvh);
    bvh.validate(&triangles).expect_err("the tree is broken")
}

/// The first node whose left child is a leaf, and the first whose left child is a node but the root.
fn samples(bvh: &Bvh) -> (usize, usize) {
    let leaf = bvh.nodes.iter().position(|n| n.left_count > 0);
    let inner = bvh.nodes.iter().skip(1).position(|n| n.left_count == 0);
    (leaf.expect("a leaf"), inner.expect("a node") + 1)
}

#[test]
fn the_validator_finds_broken_links() {
    assert_eq!(broken(|b| b.nodes.clear()), BvhError::NoRoot);
    let error = broken(|b| b.nodes[0].left = 1000);
    assert!(matches!(
        error,
        BvhError::NodeIndex {
            node: 0,
            side: Side::Left,
            child: 1000,
            ..
        }
    ));
    assert!(
        error
            .to_string()
            .contains("node 0: its left child is node 1000"),
        "{error}"
    );
    // A cycle: a lower node points at one above it.
    let error = broken(|b| {
        let (_, inner) = samples(b);
        b.nodes[inner].left = inner as u32;
    });
    assert!(matches!(error, BvhError::SharedNode { .. }), "{error}");
    let error = broken(|b| {
        let extra = b.nodes[0];
        b.nodes.push(bytemuck::Zeroable::zeroed());
        b.nodes[0] = extra;
    });
    assert!(matches!(error, BvhError::Unreachable { .. }), "{error}");
    assert!(matches!(broken(|b| b.depth -= 1), BvhError::Depth { .. }));
}

#[test]
fn the_validator_finds_broken_leaves() {
    let at_leaf = |change: fn(&mut etendue::accel::BvhNode)| {
        broken(move |b| {
            let (leaf, _) = samples(b);
            change(&mut b.nodes[leaf]);
        })
    };
    assert!(matches!(
        at_leaf(|n| n.left_count = 16),
        BvhError::LeafSize { count: 16, .. }
    ));
    assert!(matches!(
        at_leaf(|n| n.left = u32::MAX),
        BvhError::LeafRange { .. }
    ));
    assert!(matches!(
        at_leaf(|n| n.left = 39),
        BvhError::TriangleTwice { .. } | BvhError::LeafRange { .. }
    ));
    let error = broken(|b| {
        let node = b.nodes.iter_mut().find(|n| n.left_count > 1);
        node.expect("a leaf of two").left_count -= 1;
    });
    assert!(matches!(error, BvhError::TriangleMissing { .. }), "{error}");
    assert!(matches!(
        broken(|b| b.order[3] = b.order[4]),
        BvhError::Order { position: 4, .. }
    ));
    assert!(matches!(
        broken(|b| b.order[3] = 40),
        BvhError::Order { position: 3, .. }
    ));
    assert!(matches!(
        broken(|b| b.order.truncate(5)),
        BvhError::OrderLength { .. }
    ));
}

#[test]
fn the_validator_finds_broken_boxes() {
    for axis in 0..3 {
        let error = broken(|b| b.nodes[0].right_max[axis] -= 0.1);
        assert_eq!(
            error,
            BvhError::Box {
                node: 0,
                side: Side::Right
            }
        );
        let error = broken(|b| b.nodes[0].left_min[axis] = f32::NAN);
        assert_eq!(
            error,
            BvhError::Box {
                node: 0,
                side: Side::Left
            }
        );
    }
    let triangles = soup(1, 0.1, 12);
    let (mut bvh, _) = build(&triangles, 4, 16);
    bvh.nodes[0].right_max = [0.0; 3];
    let error = BvhError::AbsentBox {
        node: 0,
        side: Side::Right,
    };
    assert_eq!(bvh.validate(&triangles), Err(error));
}

fn any_finite() -> impl Strategy<Value = f32> {
    prop_oneof![-4i32..5, Just(0),]
        .prop_map(|i| i as f32)
        .boxed()
        .prop_union(
            any::<f32>()
                .prop_filter("finite", |x| x.is_finite())
                .boxed(),
        )
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn any_finite_triangles_build_a_valid_tree(
        coordinates in prop::collection::vec(any_finite(), 0..400),
        max_leaf_size in 1u32..9,
        bins in 2usize..33,
    ) {
        let vertices: Vec<Vec3> = coordinates.chunks_exact(3).map(Vec3::from_slice).collect();
        let triangles: Triangles = vertices.chunks_exact(3).map(|c| [c[0], c[1], c[2]]).collect();
        build(&triangles, max_leaf_size, bins);
    }
}
