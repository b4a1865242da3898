//! A binary tree over the lights that are somewhere: emissive triangles, point and spot lights. The shader
//! descends it by chance, in proportion to a bound on what each child may send to the point in question
//! (Conty Estevez and Kulla 2018, Importance Sampling of Many Lights with Adaptive Tree Splitting;
//! Pharr, Jakob and Humphreys 2023, section 12.6.3).
//!
//! [`bounds`] says what is known of a group of lights, [`build`] groups them, [`node`] packs a group in 32
//! bytes. `shaders/light/tree.wgsl` descends.

mod bounds;
mod build;
mod cone;
mod node;
#[cfg(test)]
mod tests;

pub use bounds::LightBounds;
pub use cone::Cone;

use super::layout::LightNode;

/// Most decisions on the way to a light: the way is kept in the bits of a word.
pub const MAX_DEPTH: u32 = 32;

/// The tree, as the device holds it.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct LightTree {
    /// The root, then a node for [`LightTree::head`], then pairs of siblings.
    pub nodes: Vec<LightNode>,
    /// Each light's way from the root: bit 0 is the first decision, 1 is to the second child.
    pub trails: Vec<u32>,
}

impl LightTree {
    /// Builds the tree over lights, of which there must be at least one; leaf `i` is light `i`. Alike for
    /// any number of threads.
    pub fn build(lights: &[LightBounds]) -> Self {
        build::build(lights)
    }

    /// Writes what the shader must know of the lights that are in no tree: `count` entries of the table of
    /// lights from `first` on, and the probability 2⁻³² · `threshold` of the tree.
    pub fn head(&mut self, first: u32, count: u32, threshold: u32) {
        self.nodes[1] = LightNode {
            link: first,
            axis: count,
            extent: threshold,
            ..LightNode::default()
        };
    }

    /// Bytes on the device.
    pub fn bytes(&self) -> u64 {
        size_of_val(&self.nodes[..]) as u64
    }
}
