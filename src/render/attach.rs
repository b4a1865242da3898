//! What a pair of the structure says about its triangles.

use super::flatten::FlatGeometry;
use super::layout::{self, FIRST_ATTRIBUTES, FIRST_LIGHT, NONE};
use crate::accel::{Bvh, Element, Placed};

/// Writes into each pair what a hit on it leads to: materials, flags, lights.
pub(super) fn attach(bvh: &mut Bvh, flat: &FlatGeometry, lights: &[u32]) {
    let owners = Owners {
        order: &bvh.order,
        attributes: &flat.attributes,
        lights,
    };
    owners.attach(&mut bvh.elements, 0);
}

/// Triangles that one thread attaches.
const ATTACH_LIMIT: usize = 1 << 14;

/// Triangles in the order of the tree, in which their elements lie too.
struct Owners<'a> {
    order: &'a [Placed],
    attributes: &'a [u32],
    lights: &'a [u32],
}

impl Owners<'_> {
    /// `elements` begin with number `first` and hold all of the triangles' pairs.
    fn attach(self, elements: &mut [Element], first: usize) {
        if self.order.len() > ATTACH_LIMIT {
            let middle = self.order.len() / 2;
            // Both triangles of a pair go right.
            let element = self.order[middle].id as usize / 2;
            let is_split = self.order[middle - 1].id as usize / 2 == element;
            let (left, right) = self.split_at(middle - usize::from(is_split));
            let (low, high) = elements.split_at_mut(element - first);
            rayon::join(|| left.attach(low, first), || right.attach(high, element));
            return;
        }
        for (i, placed) in self.order.iter().enumerate() {
            let words = &mut elements[placed.id as usize / 2 - first].words;
            let emits = self.lights[i] != NONE;
            // Of two lights the first is kept; the second one's comes right after it.
            let is_first_light = words[FIRST_ATTRIBUTES] & layout::TRIANGLE_EMITS == 0;
            if emits && is_first_light {
                words[FIRST_LIGHT] = self.lights[i];
            }
            let flag = if emits { layout::TRIANGLE_EMITS } else { 0 };
            words[FIRST_ATTRIBUTES + (placed.id & 1) as usize] = self.attributes[i] | flag;
        }
    }

    fn split_at(self, middle: usize) -> (Self, Self) {
        let (low_order, order) = self.order.split_at(middle);
        let (low_attributes, attributes) = self.attributes.split_at(middle);
        let (low_lights, lights) = self.lights.split_at(middle);
        let low = Self {
            order: low_order,
            attributes: low_attributes,
            lights: low_lights,
        };
        let high = Self {
            order,
            attributes,
            lights,
        };
        (low, high)
    }
}
