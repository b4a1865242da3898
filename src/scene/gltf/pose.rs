//! Poses: what an animation changes of the nodes, and how the meshes that they show are deformed.

use std::collections::BTreeMap;

use glam::{DQuat, DVec3};

use super::error::LoadError;
use super::json::Item;
use super::skin::SkinPose;

/// What an animation sets of a node; all else is the node's own.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct NodePose {
    pub translation: Option<DVec3>,
    pub rotation: Option<DQuat>,
    pub scale: Option<DVec3>,
    pub weights: Option<Vec<f64>>,
}

impl NodePose {
    /// Whether it moves the node.
    pub fn moves(&self) -> bool {
        self.translation.is_some() || self.rotation.is_some() || self.scale.is_some()
    }
}

/// The nodes that an animation changes, by their index.
pub(super) type Pose = BTreeMap<usize, NodePose>;

/// How the vertices of a mesh are displaced.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Deformation<'a> {
    /// Weight of each morph target; empty: all are zero.
    pub weights: &'a [f64],
    pub skin: Option<&'a SkinPose>,
}

/// The weights of a mesh's morph targets as a node shows it: the animation's, else the node's, else the mesh's.
/// Empty if all are zero.
pub(super) fn weights(
    node: &Item,
    pose: Option<&NodePose>,
    mesh: &Item,
) -> Result<Vec<f64>, LoadError> {
    let animated = pose.and_then(|pose| pose.weights.clone());
    let weights = match animated {
        Some(weights) => weights,
        None => match node.number_list("weights")? {
            Some(weights) => weights,
            None => mesh.number_list("weights")?.unwrap_or_default(),
        },
    };
    match weights.iter().any(|&weight| weight != 0.0) {
        true => Ok(weights),
        false => Ok(Vec::new()),
    }
}
