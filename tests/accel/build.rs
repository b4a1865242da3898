//! The builder on degenerate input, and the validator on broken trees.

use crate::accel_common::*;
use etendue::accel::{BuildOptions, Bvh, BvhError, Hit, LIST_LIMIT, MAX_DEPTH};
use etendue::geometry::Ray;
use glam::Vec3;
use proptest::prelude::*;
use std::time::Instant;

#[test]
fn degenerate_inputs_build_valid_structures() {
    for (name, triangles) in degenerate_inputs() {
        for limit in [TREE, LIST] {
            println!("{name}, list limit {limit}");
            let bvh = build(&triangles, limit);
            let ray = Ray::new(Vec3::new(0.2, 0.2, 5.0), -Vec3::Z);
            let expected = brute_force(&bvh, &triangles, &ray);
            let found = bvh.intersect(&ray);
            if limit == TREE {
                assert_eq!(found, expected);
            }
            // A list may take another of hits that are a rounding apart.
            let t = |hit: Option<Hit>| hit.map_or(0.0, |hit| hit.t);
            assert_eq!(found.is_some(), expected.is_some());
            assert!((t(found) - t(expected)).abs() <= 4.0 * f32::EPSILON * t(expected));
            assert_eq!(bvh.occluded(&ray), expected.is_some());
        }
    }
}

#[test]
fn the_number_of_pairs_decides_between_list_and_tree() {
    // Far from each other, so that each is a pair of one.
    let triangles = soup(LIST_LIMIT + 1, 1e-3, 13);
    let is_list = |n: usize| Bvh::build(&triangles[..n], &BuildOptions::default()).is_list();
    assert!(is_list(0) && is_list(1) && is_list(LIST_LIMIT));
    assert!(!is_list(LIST_LIMIT + 1));
}

#[test]
fn a_million_coincident_triangles_build_fast_and_evenly() {
    let triangles = vec![[Vec3::ZERO, Vec3::X, Vec3::Y]; 1_000_000];
    let start = Instant::now();
    let bvh = build(&triangles, TREE);
    // Generous: a quadratic builder would take hours.
    let seconds = start.elapsed().as_secs();
    assert!(seconds < 60, "{seconds} s");
    assert!(bvh.depth <= 20, "{}", bvh.depth);
    // Every triangle ties: the smallest number wins.
    let hit = bvh.intersect(&Ray::new(Vec3::new(0.2, 0.2, 1.0), -Vec3::Z));
    let smallest = bvh.order.iter().map(|placed| placed.id).min();
    assert_eq!(
        hit.map(|hit| (hit.t, Some(hit.triangle))),
        Some((1.0, smallest))
    );
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
            let (elements, cost) = (bvh.elements.len(), bvh.sah_cost());
            println!("{name}: {n} triangles, {elements} elements, {seconds:.2} s, cost {cost:.1}");
        }
    }
}

#[test]
fn exponential_spacing_stays_within_the_stack() {
    // 60 octaves with many triangles in the smallest: peeling would go 60 deep before it halves.
    let small = |i: i32| [Vec3::ZERO, Vec3::X, Vec3::Y].map(|v| v * 1e-37 * i as f32);
    let large = |i: i32| [Vec3::ZERO, Vec3::X, Vec3::Y].map(|v| v + Vec3::splat(2f32.powi(i)));
    let triangles: Triangles = (0..4000).map(small).chain((-120..120).map(large)).collect();
    let bvh = build(&triangles, TREE);
    println!("depth {}", bvh.depth);
    assert!(bvh.depth <= MAX_DEPTH && bvh.depth > 4, "{}", bvh.depth);
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
    for n in [2, 3, 8] {
        assert!(one == with_threads(n), "{n} threads");
    }
}

/// A random long line through the box of two groups of triangles needs fewer elements than the
/// triangles that there are, or a pair in each node would.
#[test]
fn the_cost_is_that_of_a_tree_that_skips_most_of_the_scene() {
    let triangles = [
        terrain(60, 9),
        scaled(&sphere(20), 0.05, Vec3::new(3.0, 2.0, 1.0)),
    ]
    .concat();
    let bvh = build(&triangles, TREE);
    let cost = bvh.sah_cost();
    println!("cost {cost}");
    assert!(cost > 1.0 && cost < 30.0, "{cost}");
    assert_eq!(build(&triangles[..7200], LIST).sah_cost(), 3600.0);
}

/// Breaks a valid structure and returns what the validator says.
fn broken_of(limit: usize, break_it: impl Fn(&mut Bvh)) -> BvhError {
    let triangles = [soup(40, 0.2, 11), cube(2)].concat();
    let mut bvh = build(&triangles, limit);
    break_it(&mut bvh);
    bvh.validate(&triangles)
        .expect_err("the structure is broken")
}

fn broken(break_it: impl Fn(&mut Bvh)) -> BvhError {
    broken_of(TREE, break_it)
}

/// Bits of a node's words: its header has the number of nodes among its children in the lowest four
/// bits, above them the first child.
const HEADER: usize = 3;

/// The element of the first and of the last triangle in the tree's order: pairs.
fn a_pair(bvh: &Bvh) -> usize {
    bvh.order[0].id as usize / 2
}

#[test]
fn the_validator_finds_broken_links() {
    assert_eq!(broken(|b| b.elements.clear()), BvhError::NoRoot);
    let error = broken(|b| b.elements[0].words[HEADER] = 1000 << 4);
    assert!(
        matches!(
            error,
            BvhError::Children {
                node: 0,
                first: 1000,
                ..
            }
        ),
        "{error}"
    );
    assert!(error.to_string().contains("elements 1000 to"), "{error}");
    // A cycle: the root's children are the root and so on.
    let error = broken(|b| b.elements[0].words[HEADER] &= 15);
    assert!(
        matches!(error, BvhError::SharedChild { node: 0, child: 0 }),
        "{error}"
    );
    let error = broken(|b| b.elements[0].words[HEADER] |= 15);
    assert!(
        matches!(
            error,
            BvhError::InnerCount {
                node: 0,
                inner: 15,
                ..
            }
        ),
        "{error}"
    );
    let error = broken(|b| b.elements.push(b.elements[1]));
    assert!(matches!(error, BvhError::Unreachable { .. }), "{error}");
    // A node taken for a pair: what is below it is lost.
    let error = broken(|b| b.elements[0].words[HEADER] -= 1);
    assert!(matches!(error, BvhError::Unreachable { .. }), "{error}");
    assert!(matches!(broken(|b| b.depth += 1), BvhError::Depth { .. }));
}

#[test]
fn the_validator_finds_broken_pairs() {
    for limit in [TREE, LIST] {
        let broken = |break_it: fn(&mut Bvh)| broken_of(limit, break_it);
        // A vertex, a position in the order, which triangle is where.
        for word in [0, 4, 8, 12] {
            let error = broken_of(limit, |b| {
                let pair = a_pair(b);
                b.elements[pair].words[word] ^= 1;
            });
            assert!(
                matches!(error, BvhError::Vertices { .. } | BvhError::Place { .. }),
                "word {word}: {error}"
            );
        }
        let error = broken(|b| b.order[3].id = u32::MAX);
        assert_eq!(
            error,
            BvhError::Place {
                position: 3,
                id: u32::MAX
            }
        );
        let error = broken(|b| b.order.swap(3, 4));
        assert!(
            matches!(error, BvhError::Place { position: 3, .. }),
            "{error}"
        );
        let error = broken(|b| b.order[3].turned = b.order[4].turned);
        assert!(
            matches!(error, BvhError::Order { position: 4, .. }),
            "{error}"
        );
        let error = broken(|b| b.order[3].turned.triangle = 1000);
        assert!(
            matches!(error, BvhError::Order { position: 3, .. }),
            "{error}"
        );
        let error = broken(|b| b.order[3].turned.first = 3);
        assert!(
            matches!(error, BvhError::Order { position: 3, .. }),
            "{error}"
        );
        let error = broken(|b| b.order[3].turned.first = (b.order[3].turned.first + 1) % 3);
        assert!(matches!(error, BvhError::Vertices { .. }), "{error}");
        let error = broken(|b| b.order.truncate(5));
        assert!(
            matches!(error, BvhError::OrderLength { order: 5, .. }),
            "{error}"
        );
    }
}

#[test]
fn the_validator_finds_a_list_of_too_much_or_too_little() {
    let error = broken_of(LIST, |b| b.elements.push(b.elements[0]));
    assert!(matches!(error, BvhError::Vertices { .. }), "{error}");
    let error = broken_of(LIST, |b| {
        b.elements.pop();
    });
    assert!(matches!(error, BvhError::Place { .. }), "{error}");
    // A tree is no list.
    let error = broken(|b| b.depth = 0);
    assert!(
        matches!(error, BvhError::Vertices { .. } | BvhError::Place { .. }),
        "{error}"
    );
}

/// Moving any plane of a box by a step inwards must show where the box is tight: in a scene with many
/// boxes every kind of plane is, somewhere.
#[test]
fn the_validator_finds_broken_boxes() {
    let triangles = soup(400, 0.2, 12);
    let whole = build(&triangles, TREE);
    let first_pair = whole.order.iter().map(|placed| placed.id / 2).min();
    assert!(first_pair > Some(1));
    for plane in 0..6 {
        let mut found = 0;
        let mut bvh = whole.clone();
        // The root has eight children; their boxes are bytes.
        for child in 0..8 {
            let word = 4 + 2 * plane + child / 4;
            let step = 1 << (8 * (child % 4));
            let kept = bvh.elements[0].words[word];
            let inwards = if plane % 2 == 0 {
                kept.wrapping_add(step)
            } else {
                kept.wrapping_sub(step)
            };
            bvh.elements[0].words[word] = inwards;
            if let Err(error) = bvh.validate(&triangles) {
                found += usize::from(matches!(error, BvhError::Box { node: 0, .. }));
            }
            bvh.elements[0].words[word] = kept;
        }
        println!("plane {plane}: {found} of 8 moves found");
        assert_eq!(found, 8, "plane {plane}");
    }
    // Grids of no size.
    let error = broken(|b| b.elements[0].words[1] = 0);
    assert!(
        matches!(
            error,
            BvhError::Box { .. }
                | BvhError::Children { .. }
                | BvhError::Unreachable { .. }
                | BvhError::InnerCount { .. }
        ),
        "{error}"
    );
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
    fn any_finite_triangles_build_a_valid_structure(
        coordinates in prop::collection::vec(any_finite(), 0..400),
    ) {
        let vertices: Vec<Vec3> = coordinates.chunks_exact(3).map(Vec3::from_slice).collect();
        let triangles: Triangles = vertices.chunks_exact(3).map(|c| [c[0], c[1], c[2]]).collect();
        build(&triangles, TREE);
        build(&triangles, LIST);
    }
}
