//! The crate `obvhs`: its builders over our boxes, its trees in our form.

use etendue::accel::Primitive;
use etendue::accel::binary::{BinaryNode, BinaryTree};
use etendue::geometry::Aabb;
use obvhs::BvhBuildParams;
use obvhs::bvh2::{Bvh2, builder::build_bvh2};

/// Its presets by name.
pub const PRESETS: [&str; 5] = ["very_fast", "fast", "medium", "slow", "very_slow"];

/// Over one box a leaf, as ours: else trees of different leaves would be compared. What only serves
/// larger leaves, the second reinsertion after their collapse, is left out.
pub fn build(boxes: &[Primitive], preset: &str) -> Bvh2 {
    let params = match preset {
        "very_fast" => BvhBuildParams::very_fast_build(),
        "fast" => BvhBuildParams::fast_build(),
        "medium" => BvhBuildParams::medium_build(),
        "slow" => BvhBuildParams::slow_build(),
        _ => BvhBuildParams::very_slow_build(),
    };
    let params = BvhBuildParams {
        max_prims_per_leaf: 1,
        post_collapse_reinsertion_batch_ratio_multiplier: 0.0,
        ..params
    };
    let aabb = |p: &Primitive| obvhs::aabb::Aabb::new(p.bounds.min.into(), p.bounds.max.into());
    let aabbs: Vec<_> = boxes.iter().map(aabb).collect();
    build_bvh2(&aabbs, params, &mut Default::default())
}

/// The same tree, in our order of nodes.
pub fn converted(bvh: &Bvh2) -> BinaryTree {
    let mut leaves = vec![0; bvh.nodes.len()];
    count(bvh, 0, &mut leaves);
    let nothing = BinaryNode {
        bounds: Aabb::EMPTY,
        index: 0,
        leaves: 0,
    };
    let mut tree = BinaryTree {
        nodes: vec![nothing; 2 * leaves[0] as usize - 1],
        depth: 0,
    };
    // Its node, the place of ours, that of our first node below, the level.
    let mut stack = vec![(0, 0, 1, 0)];
    while let Some((i, place, first, level)) = stack.pop() {
        let node = &bvh.nodes[i];
        let child = node.first_index as usize;
        let is_leaf = node.is_leaf();
        tree.depth = tree.depth.max(level);
        tree.nodes[place] = BinaryNode {
            bounds: Aabb {
                min: node.aabb().min.into(),
                max: node.aabb().max.into(),
            },
            index: if is_leaf {
                bvh.primitive_indices[child]
            } else {
                first as u32
            },
            leaves: leaves[i],
        };
        if !is_leaf {
            stack.push((child, first, first + 2, level + 1));
            let right = first + 2 * leaves[child] as usize;
            stack.push((child + 1, first + 1, right, level + 1));
        }
    }
    tree
}

fn count(bvh: &Bvh2, i: usize, leaves: &mut [u32]) -> u32 {
    let node = &bvh.nodes[i];
    let first = node.first_index as usize;
    leaves[i] = match node.is_leaf() {
        true => node.prim_count,
        false => count(bvh, first, leaves) + count(bvh, first + 1, leaves),
    };
    leaves[i]
}
