//! The proof for a structure of two levels: each of its trees is one by itself, the upper level is, and what
//! instances say fits.

use super::instance::{Instance, root_boxes};
use super::two_level::{HEADER, header, shift};
use super::{Bvh, BvhError};
use crate::geometry::Aabb;
use glam::Vec3;

impl Bvh {
    /// [`Bvh::validate`] with instances. What is wrong in a tree is told by indices of its own.
    pub(super) fn validate_two_level(&self, triangles: &[[Vec3; 3]]) -> Result<(), BvhError> {
        self.check_sections(triangles)?;
        for tree in 0..self.trees.len() {
            self.check_tree(tree, triangles)?;
        }
        self.check_numbers()?;
        let bounds = |(i, instance): (usize, &Instance)| self.check_bounds(i, instance);
        self.instances.iter().enumerate().try_for_each(bounds)?;
        let world = self.trees[0].first_triangle as usize;
        self.upper().validate_level(&triangles[..world])
    }

    /// Upper level, trees and records follow each other, and so do their triangles.
    fn check_sections(&self, triangles: &[[Vec3; 3]]) -> Result<(), BvhError> {
        let (Some(first), Some(last)) = (self.trees.first(), self.trees.last()) else {
            return Err(BvhError::Sections);
        };
        let follow = self.trees.windows(2).all(|pair| {
            pair[1].root.checked_sub(pair[0].root) == Some(pair[0].elements)
                && pair[1].first_triangle.checked_sub(pair[0].first_triangle)
                    == Some(pair[0].triangles)
        });
        let end = last.root as usize + last.elements as usize + self.instances.len();
        let end_of_triangles = last.first_triangle as usize + last.triangles as usize;
        let right = follow
            && first.root as usize > HEADER
            && self.trees.iter().all(|tree| tree.elements > 0)
            && end == self.elements.len()
            && end_of_triangles == triangles.len()
            && self.order.len() == triangles.len()
            && self
                .instances
                .iter()
                .all(|i| i.placement.tree < self.trees.len());
        if right {
            Ok(())
        } else {
            Err(BvhError::Sections)
        }
    }

    /// A tree moved to where it would be alone.
    fn check_tree(&self, index: usize, triangles: &[[Vec3; 3]]) -> Result<(), BvhError> {
        let tree = self.trees[index];
        let first = tree.first_triangle as usize;
        let range = first..first + tree.triangles as usize;
        let mut elements = self.elements[tree.root as usize..][..tree.elements as usize].to_vec();
        // Before anything is moved: every child has to be one of the tree's own.
        let of_its_own = |node: u32| (tree.root..tree.root + tree.elements).contains(&node);
        let mut waiting = vec![tree.root];
        let mut seen = 0;
        while let Some(node) = waiting.pop() {
            let decoded = self.elements[node as usize].decode();
            let last = decoded.first.saturating_add(decoded.children - 1);
            seen += 1;
            if !of_its_own(decoded.first) || !of_its_own(last) || seen > tree.elements {
                return Err(BvhError::Sections);
            }
            waiting.extend(decoded.first..decoded.first + decoded.inner.min(decoded.children));
        }
        shift(
            &mut elements,
            tree.root,
            0,
            tree.first_triangle.wrapping_neg(),
        );
        let mut order = self.order[range.clone()].to_vec();
        for placed in &mut order {
            placed.id = placed.id.wrapping_sub(2 * tree.root);
            placed.turned.triangle = placed.turned.triangle.wrapping_sub(tree.first_triangle);
        }
        let alone = Bvh {
            elements,
            order,
            depth: tree.depth,
            ..Bvh::default()
        };
        alone.validate_level(&triangles[range])
    }

    /// Header, records and the numbers of instances are what they should be.
    fn check_numbers(&self) -> Result<(), BvhError> {
        let first_record = self.elements.len() - self.instances.len();
        let mut next = first_record as u64;
        for (i, instance) in self.instances.iter().enumerate() {
            let tree = &self.trees[instance.placement.tree];
            if u64::from(instance.first) != next
                || self.elements[first_record + i] != instance.record(tree)
            {
                return Err(BvhError::Instance { instance: i });
            }
            next += u64::from(tree.elements);
        }
        let deepest = self.trees.iter().map(|tree| tree.depth).max().unwrap_or(0);
        let fits = next < 1 << 31
            && self.elements[HEADER] == header(first_record as u32, &self.instances)
            && self.depth > deepest;
        if fits {
            Ok(())
        } else {
            Err(BvhError::Sections)
        }
    }

    /// An instance's box holds its tree wherever rays start.
    fn check_bounds(&self, index: usize, instance: &Instance) -> Result<(), BvhError> {
        let tree = &self.trees[instance.placement.tree];
        let boxes = root_boxes(&self.elements[tree.root as usize]);
        let exact = instance.placement.world_box(boxes);
        let reach = f64::from(self.reach);
        let is_near = exact.0.abs().max(exact.1.abs()).max_element() <= reach;
        let padded = instance.placement.padded(exact, reach);
        match is_near && instance.bounds.contains(&padded) {
            true => Ok(()),
            false => Err(BvhError::Instance { instance: index }),
        }
    }

    /// The upper level alone, its instances leaves.
    fn upper(&self) -> Bvh {
        let (end, world) = (
            self.trees[0].root as usize,
            self.trees[0].first_triangle as usize,
        );
        let deepest = self.trees.iter().map(|tree| tree.depth).max().unwrap_or(0);
        Bvh {
            elements: self.elements[..end].to_vec(),
            order: self.order[..world].to_vec(),
            depth: self.depth - 1 - deepest,
            trees: self.trees.clone(),
            instances: self.instances.clone(),
            reach: self.reach,
        }
    }

    /// The box of an instance that is a leaf, whose element must be what the instance says.
    pub(super) fn instance_bounds(&self, leaf: usize) -> Result<Aabb, BvhError> {
        let first_record = self.elements[HEADER].words[0];
        let element = &self.elements[leaf];
        let index = element.words[15].wrapping_sub(first_record) as usize;
        let instance = self.instances.get(index);
        let expected =
            |i: &&Instance| *element == i.element(&self.trees[i.placement.tree], element.words[15]);
        match instance.filter(expected) {
            Some(instance) => Ok(instance.bounds),
            None => Err(BvhError::Instance { instance: index }),
        }
    }
}
