//! The tree that the device traverses: pairs of triangles below wide nodes.

use super::binary::{BinaryTree, WideChildren, WideTopology};
use super::element::{Element, MAX_ELEMENTS, WIDTH};
use super::pair::{Pair, pairs};
use super::primitive::Primitive;
use super::{BuildOptions, Bvh, Placed};
use crate::geometry::Aabb;
use glam::Vec3;
use rayon::prelude::*;
use std::ops::Range;

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
        Emission::new(tree, pairs, triangles, 0, 0).run(&[])
    }
}

/// All pairs, in the order of the input.
fn list(pairs: &[Pair], triangles: &[[Vec3; 3]]) -> Bvh {
    let mut elements = Vec::with_capacity(pairs.len());
    let mut order = Vec::with_capacity(2 * pairs.len());
    for pair in pairs {
        let id = 2 * elements.len() as u32;
        elements.push(Element::pair(pair.vertices(triangles), order.len() as u32));
        order.extend(
            (id..)
                .zip(pair.triangles())
                .map(|(id, turned)| Placed { turned, id }),
        );
    }
    Bvh {
        elements,
        order,
        depth: 0,
        ..Bvh::default()
    }
}

/// One box a pair.
pub(super) fn primitives(pairs: &[Pair], triangles: &[[Vec3; 3]]) -> Vec<Primitive> {
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

/// Wide nodes whose children one task writes.
const CHUNK: usize = 1 << 12;

/// The element that is the first child of each wide node: the children of all nodes follow each
/// other, after the root and a gap.
fn first_children(topology: &WideTopology, gap: u32) -> Vec<u32> {
    let mut next = 1 + gap;
    let first = |node: &WideChildren| {
        let first = next;
        next += node.children().len() as u32;
        first
    };
    let first = topology.nodes.iter().map(first).collect();
    debug_assert!(next as usize <= MAX_ELEMENTS);
    first
}

/// Everything that elements are made of.
pub(super) struct Emission<'a> {
    topology: WideTopology,
    tree: BinaryTree,
    pairs: Vec<Pair>,
    triangles: &'a [[Vec3; 3]],
    /// Leaves that are no pairs: boxes of the tree with indices from the number of pairs on.
    others: usize,
    /// Elements that are left free after the root.
    gap: u32,
    /// The first child of each wide node, an element.
    first_child: Vec<u32>,
}

/// What is in a leaf.
enum Leaf {
    Pair(Pair),
    /// Index of one of the other leaves.
    Other(usize),
}

impl Leaf {
    fn triangles(&self) -> usize {
        match self {
            Leaf::Pair(pair) => pair.triangles().count(),
            Leaf::Other(_) => 0,
        }
    }
}

/// The children of some wide nodes: room to write them to.
struct Chunk<'a> {
    nodes: Range<usize>,
    elements: &'a mut [Element],
    order: &'a mut [Placed],
    /// Position in the tree's order of the first of `order`.
    position: u32,
}

impl<'a> Emission<'a> {
    /// From a tree over the boxes of some pairs and then of so many other leaves.
    pub fn new(
        tree: BinaryTree,
        pairs: Vec<Pair>,
        triangles: &'a [[Vec3; 3]],
        others: usize,
        gap: u32,
    ) -> Self {
        let topology = tree.collapse();
        Self {
            first_child: first_children(&topology, gap),
            topology,
            tree,
            pairs,
            triangles,
            others,
            gap,
        }
    }

    pub fn element_count(&self) -> usize {
        self.topology.nodes.len() + self.gap as usize + self.pairs.len() + self.others
    }

    /// Writes everything, with the other leaves as given.
    pub fn run(&self, others: &[Element]) -> Bvh {
        let count = self.element_count();
        // Filled by all threads, since the first touch of memory takes time.
        let void = Element { words: [0; 16] };
        let mut elements: Vec<Element> = rayon::iter::repeat_n(void, count).collect();
        let mut order: Vec<Placed> =
            rayon::iter::repeat_n(Placed::VOID, self.triangles.len()).collect();
        elements[0] = self.node(0);
        let chunks = self.chunks(&mut elements[1 + self.gap as usize..], &mut order);
        let write = |chunk| self.write(chunk, others);
        chunks.into_par_iter().for_each(write);
        Bvh {
            elements,
            order,
            depth: self.topology.depth,
            ..Bvh::default()
        }
    }

    /// Shares out the room.
    fn chunks<'b>(
        &self,
        mut elements: &'b mut [Element],
        mut order: &'b mut [Placed],
    ) -> Vec<Chunk<'b>> {
        let count = self.topology.nodes.len();
        let ranges: Vec<Range<usize>> = (0..count)
            .step_by(CHUNK)
            .map(|start| start..count.min(start + CHUNK))
            .collect();
        let sizes: Vec<_> = ranges.par_iter().map(|r| self.sizes(r.clone())).collect();
        let mut position = 0;
        let chunk = |(nodes, (children, triangles)): (_, (usize, usize))| {
            let chunk = Chunk {
                nodes,
                elements: elements.split_off_mut(..children).expect("enough elements"),
                order: order.split_off_mut(..triangles).expect("enough triangles"),
                position,
            };
            position += triangles as u32;
            chunk
        };
        ranges.into_iter().zip(sizes).map(chunk).collect()
    }

    /// The children of wide nodes, and the triangles in these.
    fn sizes(&self, nodes: Range<usize>) -> (usize, usize) {
        let children = self.topology.nodes[nodes].iter().map(|n| n.children());
        let triangles = |&child: &u32| self.leaf(child).map_or(0, |leaf| leaf.triangles());
        children.fold((0, 0), |(all, sum), children| {
            let here: usize = children.iter().map(triangles).sum();
            (all + children.len(), sum + here)
        })
    }

    /// What a child is if it is a leaf.
    fn leaf(&self, child: u32) -> Option<Leaf> {
        let node = &self.tree.nodes[child as usize];
        let index = node.index as usize;
        let leaf = || match self.pairs.get(index) {
            Some(pair) => Leaf::Pair(*pair),
            None => Leaf::Other(index - self.pairs.len()),
        };
        node.is_leaf().then(leaf)
    }

    /// Nodes first, then leaves.
    fn write(&self, chunk: Chunk, others: &[Element]) {
        let first = self.first_child[chunk.nodes.start];
        let mut elements = chunk.elements.iter_mut().zip(first..);
        let mut order = chunk.order.iter_mut();
        let mut position = chunk.position;
        for node in &self.topology.nodes[chunk.nodes] {
            let leaves = node.children().iter().filter_map(|&child| self.leaf(child));
            let inner = node.children().len() - leaves.clone().count();
            let nodes = node.first_inner..node.first_inner + inner as u32;
            for (wide, (element, _)) in nodes.zip(elements.by_ref()) {
                *element = self.node(wide as usize);
            }
            for (leaf, (element, index)) in leaves.zip(elements.by_ref()) {
                let pair = match leaf {
                    Leaf::Pair(pair) => pair,
                    Leaf::Other(other) => {
                        *element = others[other];
                        continue;
                    }
                };
                *element = Element::pair(pair.vertices(self.triangles), position);
                let turned = (2 * index..).zip(pair.triangles());
                for ((id, turned), placed) in turned.zip(order.by_ref()) {
                    *placed = Placed { turned, id };
                    position += 1;
                }
            }
        }
    }

    fn node(&self, i: usize) -> Element {
        let children = self.topology.nodes[i].children();
        let at = |&child: &u32| &self.tree.nodes[child as usize];
        let inner = children.iter().map(at).filter(|node| !node.is_leaf());
        let leaves = children.iter().map(at).filter(|node| node.is_leaf());
        let mut boxes = [Aabb::EMPTY; WIDTH];
        for (place, node) in boxes.iter_mut().zip(inner.clone().chain(leaves)) {
            *place = node.bounds.padded();
        }
        let first = self.first_child[i];
        Element::node(&boxes[..children.len()], inner.count() as u32, first)
    }
}
