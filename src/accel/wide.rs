//! The tree that the device traverses: pairs of triangles below wide nodes.

use super::binary::{BinaryTree, WideTopology};
use super::element::{Element, MAX_ELEMENTS};
use super::pair::{Pair, pairs};
use super::primitive::Primitive;
use super::{BuildOptions, Bvh, Placed};
use crate::geometry::Aabb;
use glam::Vec3;
use rayon::prelude::*;

impl Bvh {
    /// Builds the structure over triangles whose vertices are all finite, in any number up to
    /// [`super::MAX_TRIANGLES`] (which the caller checks). Same input, same
    /// structure, bit for bit, whatever the number of threads.
    pub fn build(triangles: &[[Vec3; 3]], options: &BuildOptions) -> Bvh {
        let pairs = pairs(triangles);
        if pairs.is_empty() || pairs.len() <= options.list_limit {
            return list(&pairs, triangles);
        }
        let tree = BinaryTree::build(&primitives(&pairs, triangles), options.preset);
        let topology = tree.collapse();
        let plan = Plan::new(&topology, &tree, &pairs);
        let element = |kind: &Kind| match *kind {
            Kind::Node(i) => plan.node(i as usize, &topology, &tree),
            Kind::Pair(i) => {
                let vertices = pairs[i as usize].vertices(triangles);
                Element::pair(vertices, plan.positions[i as usize])
            }
        };
        Bvh {
            elements: plan.kinds.par_iter().map(element).collect(),
            order: order(&plan, &pairs),
            depth: topology.depth,
        }
    }
}

/// All pairs, in the order of the input.
fn list(pairs: &[Pair], triangles: &[[Vec3; 3]]) -> Bvh {
    let mut elements = Vec::with_capacity(pairs.len());
    let mut order = Vec::with_capacity(2 * pairs.len());
    for pair in pairs {
        let id = 2 * elements.len() as u32;
        elements.push(Element::pair(pair.vertices(triangles), order.len() as u32));
        let turned = [Some(pair.first), pair.second].into_iter().flatten();
        order.extend((id..).zip(turned).map(|(id, turned)| Placed { turned, id }));
    }
    Bvh {
        elements,
        order,
        depth: 0,
    }
}

/// One box a pair.
fn primitives(pairs: &[Pair], triangles: &[[Vec3; 3]]) -> Vec<Primitive> {
    let primitive = |(i, pair): (usize, &Pair)| {
        // Adding 0 turns -0 into +0, so that no minimum depends on the order of its arguments.
        let vertices = pair.vertices(triangles).map(|v| v + Vec3::ZERO);
        Primitive {
            bounds: Aabb::from_points(&vertices),
            index: i as u32,
        }
    };
    pairs.par_iter().enumerate().map(primitive).collect()
}

/// What an element is to hold.
#[derive(Debug, Clone, Copy)]
enum Kind {
    /// Wide node of the topology.
    Node(u32),
    /// Pair of the list.
    Pair(u32),
}

/// Where everything goes.
struct Plan {
    kinds: Vec<Kind>,
    /// The first child of each wide node, an element.
    first_child: Vec<u32>,
    /// Position in the tree's order of each pair's first triangle.
    positions: Vec<u32>,
}

impl Plan {
    fn new(topology: &WideTopology, tree: &BinaryTree, pairs: &[Pair]) -> Plan {
        let mut plan = Plan {
            kinds: Vec::with_capacity(topology.nodes.len() + pairs.len()),
            first_child: Vec::with_capacity(topology.nodes.len()),
            positions: vec![0; pairs.len()],
        };
        plan.kinds.push(Kind::Node(0));
        let mut position = 0;
        for node in &topology.nodes {
            plan.first_child.push(plan.kinds.len() as u32);
            let (leaves, inner): (Vec<u32>, Vec<u32>) = node
                .children()
                .iter()
                .partition(|&&child| tree.nodes[child as usize].is_leaf());
            let nodes = node.first_inner..node.first_inner + inner.len() as u32;
            plan.kinds.extend(nodes.map(Kind::Node));
            for leaf in leaves {
                let pair = tree.nodes[leaf as usize].index;
                plan.kinds.push(Kind::Pair(pair));
                plan.positions[pair as usize] = position;
                position += 1 + u32::from(pairs[pair as usize].second.is_some());
            }
        }
        debug_assert!(plan.kinds.len() <= MAX_ELEMENTS);
        plan
    }

    fn node(&self, i: usize, topology: &WideTopology, tree: &BinaryTree) -> Element {
        let children = topology.nodes[i].children();
        let is_leaf = |&child: &u32| tree.nodes[child as usize].is_leaf();
        let padded = |&child: &u32| tree.nodes[child as usize].bounds.padded();
        let inner = children.iter().filter(|c| !is_leaf(c));
        let leaves = children.iter().filter(|c| is_leaf(c));
        let boxes: Vec<Aabb> = inner.clone().chain(leaves).map(padded).collect();
        Element::node(&boxes, inner.count() as u32, self.first_child[i])
    }
}

fn order(plan: &Plan, pairs: &[Pair]) -> Vec<Placed> {
    let placed = |(i, kind): (usize, &Kind)| match *kind {
        Kind::Pair(pair) => {
            let Pair { first, second } = pairs[pair as usize];
            let id = 2 * i as u32;
            let second = second.map(|turned| Placed { turned, id: id + 1 });
            [Some(Placed { turned: first, id }), second]
        }
        _ => [None; 2],
    };
    plan.kinds
        .iter()
        .enumerate()
        .flat_map(placed)
        .flatten()
        .collect()
}
