//! A structure of two levels: trees that instances share, below one over the world.
//!
//! Its elements are the tree over the world, whose leaves are pairs and instances, with a header after the root; then
//! the shared trees, each in a space of its own; then a record for each instance.

use super::binary::BinaryTree;
use super::element::Element;
use super::instance::{Instance, Placement, Tree, root_boxes};
use super::pair::pairs;
use super::primitive::Primitive;
use super::wide::{Emission, primitives};
use super::{BuildOptions, Bvh, Placed};
use crate::geometry::Aabb;
use glam::{DVec3, Vec3};
use rayon::prelude::*;
use std::ops::Range;
use thiserror::Error;

/// Elements of all instances together: those and a bit for the pair's triangle are the number of a hit.
const MAX_NUMBERS: u64 = (1 << 31) - 1;

/// What a structure of two levels is built of.
#[derive(Debug, Clone, Copy)]
pub struct TwoLevel<'a> {
    /// All triangles: those of the world, then those of each tree in its own space. Their vertices are finite.
    pub triangles: &'a [[Vec3; 3]],
    /// How many of them are in the world.
    pub world: usize,
    /// The triangles of each tree, none of them empty; they follow each other.
    pub trees: &'a [Range<usize>],
    /// The instances.
    pub placements: &'a [Placement],
    /// Rays start no farther from the world's origin than √3 times this or the largest coordinate in the world, metres.
    pub reach: f32,
}

/// More elements in instances than numbers can name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
#[error("the instances have {count} elements together, more than {limit}")]
pub struct TooManyNumbers {
    /// How many there are.
    pub count: u64,
    /// How many there may be.
    pub limit: u64,
}

impl Bvh {
    /// Builds a structure of two levels, or where nothing is shared what [`Bvh::build`] does. At most
    /// [`super::MAX_TRIANGLES`] triangles and twice the instances together, which the caller checks.
    ///
    /// # Errors
    /// [`TooManyNumbers`].
    pub fn build_two_level(
        input: &TwoLevel,
        options: &BuildOptions,
    ) -> Result<Bvh, TooManyNumbers> {
        if input.placements.is_empty() {
            return Ok(Bvh::build(&input.triangles[..input.world], options));
        }
        let trees: Vec<Bvh> = input
            .trees
            .iter()
            .map(|range| tree(input, range, options))
            .collect();
        let upper = Upper::new(input, &trees, options);
        let placed = upper.place(&trees, input)?;
        let mut bvh = upper.emit(placed);
        for (range, tree) in input.trees.iter().zip(trees) {
            append(&mut bvh, tree, range.start as u32);
        }
        let records = bvh
            .instances
            .iter()
            .map(|i| i.record(&bvh.trees[i.placement.tree]));
        bvh.elements.extend(records);
        Ok(bvh)
    }

    /// What the number of a hit stands for: the element, and the index of its instance if it is in one.
    pub fn resolve(&self, id: u32) -> (u32, Option<usize>) {
        let number = id / 2;
        let after = self.instances.partition_point(|i| i.first <= number);
        match after.checked_sub(1) {
            None => (number, None),
            Some(i) => {
                let instance = &self.instances[i];
                let tree = &self.trees[instance.placement.tree];
                (number - instance.first + tree.root, Some(i))
            }
        }
    }
}

/// A tree of its own space, as if it were alone.
fn tree(input: &TwoLevel, range: &Range<usize>, options: &BuildOptions) -> Bvh {
    let options = BuildOptions {
        list_limit: 0,
        ..*options
    };
    Bvh::build(&input.triangles[range.clone()], &options)
}

/// The upper level before it has its elements.
struct Upper<'a> {
    emission: Emission<'a>,
    bounds: Vec<Aabb>,
    reach: f32,
}

impl<'a> Upper<'a> {
    fn new(input: &TwoLevel<'a>, trees: &[Bvh], options: &BuildOptions) -> Self {
        let world = &input.triangles[..input.world];
        let pairs = pairs(world);
        let mut primitives = primitives(&pairs, world);
        let exact = |p: &Placement| p.world_box(root_boxes(&trees[p.tree].elements[0]));
        let boxes: Vec<(DVec3, DVec3)> = input.placements.par_iter().map(exact).collect();
        let reach = reach(input.reach, &primitives, &boxes);
        let padded = |(p, b): (&Placement, &(DVec3, DVec3))| p.padded(*b, f64::from(reach));
        let bounds: Vec<Aabb> = input
            .placements
            .par_iter()
            .zip(&boxes)
            .map(padded)
            .collect();
        let first = primitives.len() as u32;
        let instance = |(index, &bounds)| Primitive { bounds, index };
        primitives.extend((first..).zip(&bounds).map(instance));
        let binary = BinaryTree::build(&primitives, options.preset);
        let emission = Emission::new(binary, pairs, world, bounds.len(), 1);
        Self {
            emission,
            bounds,
            reach,
        }
    }

    /// Gives trees their elements and instances their numbers.
    fn place(
        &self,
        trees: &[Bvh],
        input: &TwoLevel,
    ) -> Result<(Vec<Tree>, Vec<Instance>), TooManyNumbers> {
        let mut next = self.emission.element_count() as u32;
        let mut position = input.world as u32;
        let tree = |bvh: &Bvh| {
            let tree = Tree {
                root: next,
                elements: bvh.elements.len() as u32,
                first_triangle: position,
                triangles: bvh.order.len() as u32,
                depth: bvh.depth,
            };
            next += tree.elements;
            position += tree.triangles;
            tree
        };
        let trees: Vec<Tree> = trees.iter().map(tree).collect();
        let elements = |p: &Placement| u64::from(trees[p.tree].elements);
        let count = u64::from(next) + input.placements.iter().map(elements).sum::<u64>();
        if count > MAX_NUMBERS {
            let limit = MAX_NUMBERS;
            return Err(TooManyNumbers { count, limit });
        }
        let instance = |(&placement, &bounds): (&Placement, &Aabb)| {
            let first = next;
            next += trees[placement.tree].elements;
            Instance {
                placement,
                first,
                bounds,
            }
        };
        let instances = input
            .placements
            .iter()
            .zip(&self.bounds)
            .map(instance)
            .collect();
        Ok((trees, instances))
    }

    /// The upper level alone.
    fn emit(self, (trees, instances): (Vec<Tree>, Vec<Instance>)) -> Bvh {
        let first_record = trees.last().map_or(0, |tree| tree.root + tree.elements);
        let leaves = (first_record..).zip(&instances);
        let leaves: Vec<Element> = leaves
            .map(|(record, i)| i.element(&trees[i.placement.tree], record))
            .collect();
        let mut bvh = self.emission.run(&leaves);
        bvh.elements[HEADER] = header(first_record, &instances);
        let deepest = trees.iter().map(|tree| tree.depth).max();
        // One entry more notes where to return to.
        bvh.depth += 1 + deepest.unwrap_or(0);
        bvh.trees = trees;
        bvh.instances = instances;
        bvh.reach = self.reach;
        bvh
    }
}

/// The element after the root: where the records are, how many, and the first number of the first instance.
pub(super) const HEADER: usize = 1;

pub(super) fn header(first_record: u32, instances: &[Instance]) -> Element {
    let mut words = [0; 16];
    words[0] = first_record;
    words[1] = instances.len() as u32;
    words[2] = instances.first().map_or(u32::MAX, |i| i.first);
    Element { words }
}

/// The farthest that anything is from the world's origin on an axis.
fn reach(asked: f32, primitives: &[Primitive], boxes: &[(DVec3, DVec3)]) -> f32 {
    let farthest = |a: &Aabb| a.min.abs().max(a.max.abs()).max_element();
    let reach = primitives
        .iter()
        .map(|p| farthest(&p.bounds))
        .fold(asked, f32::max);
    let farthest = |(low, high): &(DVec3, DVec3)| low.abs().max(high.abs()).max_element() as f32;
    let reach = boxes.iter().map(farthest).fold(reach, f32::max);
    // Boxes are within 2⁶⁴ metres.
    reach.next_up().min(1e19)
}

/// Puts a tree behind what is there.
fn append(bvh: &mut Bvh, mut tree: Bvh, first_triangle: u32) {
    let (element, position) = (bvh.elements.len() as u32, bvh.order.len() as u32);
    shift(&mut tree.elements, 0, element, position);
    bvh.elements.append(&mut tree.elements);
    bvh.order.extend(tree.order.iter().map(|placed| {
        let mut moved: Placed = *placed;
        moved.id += 2 * element;
        moved.turned.triangle += first_triangle;
        moved
    }));
}

/// Moves a tree of one level whose root is said to be element `from` to where it is element `to`, and its triangles by
/// so many positions, forwards or, with numbers that wrap, backwards.
pub(super) fn shift(elements: &mut [Element], from: u32, to: u32, positions: u32) {
    let mut waiting = vec![0_usize];
    while let Some(index) = waiting.pop() {
        let node = elements[index].decode();
        let first = node.first - from;
        elements[index].words[3] = (first + to) << 4 | node.inner;
        for slot in 0..node.children {
            let child = (first + slot) as usize;
            if slot < node.inner {
                waiting.push(child);
            } else {
                let word = &mut elements[child].words[12];
                *word = word.wrapping_add(positions);
            }
        }
    }
}
