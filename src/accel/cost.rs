//! How good a tree is.

use super::Bvh;
use super::build::NODE_COST;
use crate::geometry::Aabb;

impl Bvh {
    /// The surface area heuristic: node steps and triangle tests that a random long ray through the
    /// root's box is expected to cost, in triangle tests. 0 for a root without area.
    pub fn sah_cost(&self) -> f64 {
        let root = self.nodes.first().map_or(Aabb::EMPTY, |node| {
            let [left, right] = node.children();
            left.bounds.union(right.bounds)
        });
        let area = root.half_area();
        if area == 0.0 {
            return 0.0;
        }
        let children = self.nodes.iter().flat_map(|node| node.children());
        let cost = |count: u32| {
            if count == 0 {
                NODE_COST
            } else {
                f64::from(count)
            }
        };
        let sum: f64 = children
            .map(|child| child.bounds.half_area() / area * cost(child.count))
            .sum();
        NODE_COST + sum
    }
}
