//! How good a tree is.

use super::Bvh;
use crate::geometry::Aabb;

impl Bvh {
    /// The surface area heuristic: elements that a random long line through the root's box is
    /// expected to load, nodes and pairs alike. 0 for a root without area. For a list, all of them.
    pub fn sah_cost(&self) -> f64 {
        if self.is_list() {
            return self.elements.len() as f64;
        }
        let mut area = 0.0;
        let mut root = Aabb::EMPTY;
        let mut waiting = vec![0];
        while let Some(index) = waiting.pop() {
            let node = self.elements[index as usize].decode();
            for child in 0..node.children {
                let bounds = node.child_box(child as usize);
                area += bounds.half_area();
                if index == 0 {
                    root = root.union(bounds);
                }
            }
            waiting.extend(node.first..node.first + node.inner);
        }
        let whole = root.half_area();
        if whole > 0.0 { 1.0 + area / whole } else { 0.0 }
    }
}
