//! The builders of binary trees at all presets, and the collapse to wide nodes.

use crate::accel_common::{Triangles, degenerate_inputs, needles, scaled, soup, sphere, terrain};
use etendue::accel::binary::{BinaryTree, MAX_BINARY_DEPTH, WIDTH, WideTopology};
use etendue::accel::{Preset, Primitive};
use etendue::geometry::Aabb;
use glam::Vec3;
use proptest::prelude::*;

const PRESETS: [Preset; 3] = [Preset::Fast, Preset::Balanced, Preset::Best];

fn boxes(triangles: &[[Vec3; 3]]) -> Vec<Primitive> {
    let primitive = |(i, t): (usize, &[Vec3; 3])| Primitive {
        bounds: Aabb::from_points(t),
        index: i as u32,
    };
    triangles.iter().enumerate().map(primitive).collect()
}

/// Builds, validates and collapses.
fn build_tree(primitives: &[Primitive], preset: Preset) -> (BinaryTree, WideTopology) {
    let tree = BinaryTree::build(primitives, preset);
    if let Err(error) = tree.validate(primitives) {
        panic!("{preset:?}: {error}");
    }
    assert!(tree.cost().is_finite());
    let wide = tree.collapse();
    check_wide(&tree, &wide);
    (tree, wide)
}

/// Every leaf once, every wide node reached once and after its parent, the depth.
fn check_wide(tree: &BinaryTree, wide: &WideTopology) {
    let mut roots = vec![None; wide.nodes.len()];
    roots[0] = Some((0u32, 1));
    let (mut leaves, mut depth) = (vec![0; tree.nodes.len()], 1);
    for (i, node) in wide.nodes.iter().enumerate() {
        let (root, level) = roots[i].expect("a parent before its children");
        depth = depth.max(level);
        let mut next = node.first_inner as usize;
        assert!(next > i);
        let mut below = 0;
        for &child in node.children() {
            let binary = &tree.nodes[child as usize];
            below += binary.leaves;
            if binary.is_leaf() {
                leaves[child as usize] += 1;
            } else {
                assert!(child > root, "a child is below its parent");
                assert_eq!(roots[next], None);
                roots[next] = Some((child, level + 1));
                next += 1;
            }
        }
        assert_eq!(below, tree.nodes.get(root as usize).map_or(0, |n| n.leaves));
        // A node that is not full has nothing left to open.
        let expected = tree.nodes.get(root as usize).map_or(0, |n| n.leaves.min(2));
        assert!(node.children().len() >= expected as usize);
    }
    let expected = tree.nodes.iter().map(|n| u32::from(n.is_leaf()));
    assert!(leaves.into_iter().eq(expected));
    assert_eq!(depth, wide.depth);
}

#[test]
fn degenerate_inputs_build_valid_trees() {
    let opposite = |i: usize| [[Vec3::MIN, Vec3::MAX][i % 2]; 3];
    let opposite = ("opposite corners", (0..300).map(opposite).collect());
    for (name, triangles) in degenerate_inputs().into_iter().chain([opposite]) {
        for preset in PRESETS {
            println!("{name}, {preset:?}");
            build_tree(&boxes(&triangles), preset);
        }
    }
}

#[test]
fn a_million_coincident_boxes_build_evenly() {
    let primitives = boxes(&vec![[Vec3::ZERO, Vec3::X, Vec3::Y]; 1_000_000]);
    for preset in PRESETS {
        let (tree, wide) = build_tree(&primitives, preset);
        println!("{preset:?}: {} and {} levels", tree.depth, wide.depth);
        assert!(tree.depth <= 24, "{preset:?}: {}", tree.depth);
    }
}

#[test]
fn exponential_spacing_stays_within_the_depth() {
    // 240 octaves with many boxes in the smallest: peeling would go 240 deep before it halves.
    let small = |i: i32| [Vec3::ZERO, Vec3::X, Vec3::Y].map(|v| v * 1e-37 * i as f32);
    let large = |i: i32| [Vec3::ZERO, Vec3::X, Vec3::Y].map(|v| v + Vec3::splat(2f32.powi(i)));
    let triangles: Triangles = (0..4000).map(small).chain((-120..120).map(large)).collect();
    for preset in PRESETS {
        let (tree, _) = build_tree(&boxes(&triangles), preset);
        assert!(tree.depth > 20 && tree.depth <= MAX_BINARY_DEPTH);
    }
}

#[test]
fn the_tree_does_not_depend_on_the_threads() {
    // Enough for every parallel path, with zeros of both signs.
    let mut triangles = soup(150_000, 0.01, 7);
    triangles.extend(scaled(&terrain(80, 8), -1.0, Vec3::ZERO));
    let primitives = boxes(&triangles);
    for preset in PRESETS {
        let with_threads = |n: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(n).build();
            pool.expect("threads").install(|| {
                let tree = BinaryTree::build(&primitives, preset);
                let wide = tree.collapse();
                (tree, wide)
            })
        };
        let one = with_threads(1);
        assert!(one.0.validate(&primitives).is_ok());
        for n in [2, 3, 8] {
            assert!(one == with_threads(n), "{preset:?}, {n} threads");
        }
    }
}

/// Meshes of the tests of quality, by name.
fn test_meshes() -> Vec<(&'static str, Triangles)> {
    let uneven = [
        terrain(60, 9),
        scaled(&sphere(20), 0.05, Vec3::new(3.0, 2.0, 1.0)),
        boxes_in_a_row(),
    ];
    vec![
        ("sphere", sphere(50)),
        ("terrain", terrain(70, 9)),
        ("soup", soup(10_000, 0.05, 3)),
        ("needles", needles(5000, 4)),
        ("uneven", uneven.concat()),
    ]
}

fn boxes_in_a_row() -> Triangles {
    crate::accel_common::boxes(20)
}

/// The best tree is that of the balanced preset, improved by moves none of which raises the cost.
#[test]
fn the_best_tree_costs_no_more_than_the_balanced_one() {
    for (name, triangles) in test_meshes() {
        let cost = PRESETS.map(|preset| build_tree(&boxes(&triangles), preset).0.cost());
        println!("{name}: {cost:?}");
        assert!(cost[2] <= cost[1] * (1.0 + 1e-9), "{name}: {cost:?}");
    }
}

/// Opens the largest child until there are eight: the way that is simple.
fn greedy_collapse(tree: &BinaryTree) -> Vec<Vec<u32>> {
    let area = |i: u32| tree.nodes[i as usize].bounds.half_area();
    let is_leaf = |i: u32| tree.nodes[i as usize].is_leaf();
    let (mut nodes, mut stack) = (vec![], vec![0]);
    while let Some(root) = stack.pop() {
        let mut children = vec![root];
        while children.len() < WIDTH {
            let inner = (0..children.len()).filter(|&k| !is_leaf(children[k]));
            let largest = inner.max_by(|&a, &b| area(children[a]).total_cmp(&area(children[b])));
            let Some(largest) = largest else { break };
            let first = tree.nodes[children.swap_remove(largest) as usize].index;
            children.extend([first, first + 1]);
        }
        stack.extend(children.iter().filter(|&&child| !is_leaf(child)));
        nodes.push(children);
    }
    nodes
}

#[test]
fn the_collapse_costs_no_more_than_opening_the_largest() {
    for (name, triangles) in test_meshes() {
        let (tree, wide) = build_tree(&boxes(&triangles), Preset::Balanced);
        let area = |children: &[u32]| {
            let boxes = children.iter().map(|&i| tree.nodes[i as usize].bounds);
            boxes.fold(Aabb::EMPTY, Aabb::union).half_area()
        };
        let cost: f64 = wide.nodes.iter().map(|node| area(node.children())).sum();
        let greedy: f64 = greedy_collapse(&tree).iter().map(|c| area(c)).sum();
        println!("{name}: {:.4}", cost / greedy);
        assert!(cost <= greedy * (1.0 + 1e-5), "{name}: {cost} > {greedy}");
    }
}

fn any_finite() -> impl Strategy<Value = f32> {
    let small = (-4i32..5).prop_map(|i| i as f32);
    prop_oneof![small, any::<f32>().prop_filter("finite", |x| x.is_finite())]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn any_finite_triangles_build_a_valid_tree(
        coordinates in prop::collection::vec(any_finite(), 0..400),
    ) {
        let vertices: Vec<Vec3> = coordinates.chunks_exact(3).map(Vec3::from_slice).collect();
        let triangles: Triangles = vertices.chunks_exact(3).map(|c| [c[0], c[1], c[2]]).collect();
        for preset in PRESETS {
            build_tree(&boxes(&triangles), preset);
        }
    }
}
