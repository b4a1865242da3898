//! The meshes that placed nodes show.

use std::collections::BTreeMap;

use glam::DMat4;
use rayon::prelude::*;

use super::error::LoadError;
use super::instancing;
use super::json::Item;
use super::node::{Nodes, Placed};
use super::pose::{self, Deformation, Pose};
use super::primitive::{self, Loaded, Source};
use super::skin::{self, SkinPose};
use crate::scene::{Instance, Scene};

/// The nodes and where they stand.
#[derive(Clone, Copy)]
pub(super) struct Stand<'a> {
    pub nodes: &'a Nodes<'a>,
    pub pose: &'a Pose,
    pub placed: &'a [Placed],
}

/// A mesh of the file with all that makes its vertices differ: nodes for which it is the same share the result.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
struct Shown {
    mesh: usize,
    skin: Option<usize>,
    /// The bits of the morph targets' weights.
    weights: Vec<u64>,
}

/// Load the meshes that the visible nodes show, each primitive once for each way to show it, and place them.
pub(super) fn load(
    root: &Item,
    stand: Stand,
    source: Source,
    scene: &mut Scene,
) -> Result<(), LoadError> {
    let items = root.items("meshes", "mesh")?;
    let skins = root.array("skins")?.len();
    let mut shown: Vec<Option<Shown>> = Vec::with_capacity(stand.placed.len());
    for placed in stand.placed {
        let node = placed.visible.then_some(placed.node);
        shown.push(match node {
            Some(node) => what(node, stand, &items, skins)?,
            None => None,
        });
    }
    let wanted = shown.iter().flatten().filter_map(|shown| shown.skin);
    let mut wanted: Vec<usize> = wanted.collect();
    wanted.sort_unstable();
    wanted.dedup();
    let Stand {
        nodes,
        pose,
        placed,
    } = stand;
    let skins = skin::pose_all(root, nodes, pose, placed, wanted.into_iter(), source)?;
    let meshes_of = load_primitives(&items, &shown, &skins, source, scene)?;
    for (placed, shown) in stand.placed.iter().zip(&shown) {
        if let Some(shown) = shown {
            let skin = shown.skin.map(|skin| &skins[&skin]);
            place(
                stand.nodes.item(placed.node),
                placed,
                skin,
                &meshes_of[shown],
                source,
                scene,
            )?;
        }
    }
    Ok(())
}

/// What a node shows, if it shows anything.
fn what(
    node: usize,
    stand: Stand,
    items: &[Item],
    skins: usize,
) -> Result<Option<Shown>, LoadError> {
    let item = stand.nodes.item(node);
    let Some(mesh) = item.index("mesh", "mesh", items.len())? else {
        return Ok(None);
    };
    let weights = pose::weights(item, stand.pose.get(&node), &items[mesh])?;
    Ok(Some(Shown {
        mesh,
        skin: item.index("skin", "skin", skins)?,
        weights: weights.into_iter().map(f64::to_bits).collect(),
    }))
}

/// Place a node's meshes: once, or as often as it has instances.
fn place(
    item: &Item,
    placed: &Placed,
    skin: Option<&SkinPose>,
    meshes: &[usize],
    source: Source,
    scene: &mut Scene,
) -> Result<(), LoadError> {
    let instances = instancing::read(item, source, &mut scene.warnings)?;
    // A skinned mesh follows its joints and not its node (section 3.7.3.3).
    let to_world = match skin {
        Some(skin) => DMat4::from_translation(skin.origin),
        None => placed.to_world,
    };
    let instances = match (instances, skin) {
        (Some(_), Some(_)) => {
            scene.warnings.push(format!(
                "{}: its mesh has a skin, so its instances are not shown; the mesh is shown once",
                item.label()
            ));
            vec![to_world]
        }
        (Some(instances), None) => instances.into_iter().map(|own| to_world * own).collect(),
        (None, _) => vec![to_world],
    };
    if let Some(index) = instances.iter().position(|matrix| !matrix.is_finite()) {
        return Err(item.fault(format!("the transform of instance {index} is not finite")));
    }
    for &mesh in meshes {
        scene
            .instances
            .extend(instances.iter().map(|&to_world| Instance {
                mesh,
                to_world,
                name: item.name().to_owned(),
            }));
    }
    Ok(())
}

/// Load the primitives of all that is `shown`; for each, what became of them.
fn load_primitives(
    items: &[Item],
    shown: &[Option<Shown>],
    skins: &BTreeMap<usize, SkinPose>,
    source: Source,
    scene: &mut Scene,
) -> Result<BTreeMap<Shown, Vec<usize>>, LoadError> {
    let mut meshes_of: BTreeMap<Shown, Vec<usize>> = BTreeMap::new();
    for shown in shown.iter().flatten() {
        meshes_of.entry(shown.clone()).or_default();
    }
    let mut primitives = Vec::new();
    for (index, shown) in meshes_of.keys().enumerate() {
        for primitive in items[shown.mesh].items("primitives", "primitive")? {
            primitives.push((index, shown, primitive));
        }
    }
    // Collect first: the error of the first primitive wins, whatever thread finds it.
    let loaded: Vec<Result<Loaded, LoadError>> = primitives
        .par_iter()
        .map(|(_, shown, item)| {
            let weights: Vec<f64> = shown
                .weights
                .iter()
                .map(|&bits| f64::from_bits(bits))
                .collect();
            let deformation = Deformation {
                weights: &weights,
                skin: shown.skin.map(|skin| &skins[&skin]),
            };
            primitive::load(item, items[shown.mesh].name(), deformation, source)
        })
        .collect();
    let owners: Vec<usize> = primitives.iter().map(|(index, ..)| *index).collect();
    let mut lists = vec![Vec::new(); meshes_of.len()];
    for (owner, loaded) in owners.into_iter().zip(loaded) {
        let loaded = loaded?;
        scene.warnings.extend(loaded.warnings);
        if let Some(triangles) = loaded.mesh {
            lists[owner].push(scene.meshes.len());
            scene.meshes.push(triangles);
        }
    }
    for (list, found) in meshes_of.values_mut().zip(lists) {
        *list = found;
    }
    Ok(meshes_of)
}
