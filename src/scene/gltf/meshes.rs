//! The meshes that placed nodes show.

use std::collections::BTreeSet;

use rayon::prelude::*;

use super::error::LoadError;
use super::json::Item;
use super::node::{Nodes, Placed};
use super::pose;
use super::primitive::{self, Loaded, Source};
use crate::scene::{Instance, Scene};

/// Load the meshes that the placed nodes show, each primitive once, and place them.
pub(super) fn load(
    root: &Item,
    nodes: &Nodes,
    placed: &[Placed],
    source: Source,
    scene: &mut Scene,
) -> Result<(), LoadError> {
    let items = root.items("meshes", "mesh")?;
    let mut shown = vec![None; placed.len()];
    for (shown, placed) in shown.iter_mut().zip(placed) {
        *shown = nodes.item(placed.node).index("mesh", "mesh", items.len())?;
    }
    let wanted = shown.iter().flatten().copied().collect();
    let meshes_of = load_primitives(&items, &wanted, source, scene)?;
    let skins = pose::Skins::read(root, nodes, placed, source)?;
    for (placed, mesh) in placed.iter().zip(shown) {
        let Some(mesh) = mesh else { continue };
        let item = nodes.item(placed.node);
        let to_world = skins.rest_pose(item, placed, &mut scene.warnings)?;
        let meshes = meshes_of[mesh].iter();
        scene.instances.extend(meshes.map(|&mesh| Instance {
            mesh,
            to_world,
            name: item.name().to_owned(),
        }));
    }
    Ok(())
}

/// Load the primitives of the `wanted` meshes; for each of the file's meshes, what became of them.
fn load_primitives(
    items: &[Item],
    wanted: &BTreeSet<usize>,
    source: Source,
    scene: &mut Scene,
) -> Result<Vec<Vec<usize>>, LoadError> {
    let mut primitives = Vec::new();
    for &mesh in wanted {
        pose::warn_of_morphs(&items[mesh], &mut scene.warnings)?;
        for primitive in items[mesh].items("primitives", "primitive")? {
            primitives.push((mesh, primitive));
        }
    }
    // Collect first: the error of the first primitive wins, whatever thread finds it.
    let loaded: Vec<Result<Loaded, LoadError>> = primitives
        .par_iter()
        .map(|(mesh, primitive)| primitive::load(primitive, items[*mesh].name(), source))
        .collect();
    let mut meshes_of = vec![Vec::new(); items.len()];
    for ((mesh, _), loaded) in primitives.iter().zip(loaded) {
        let loaded = loaded?;
        scene.warnings.extend(loaded.warnings);
        if let Some(triangles) = loaded.mesh {
            meshes_of[*mesh].push(scene.meshes.len());
            scene.meshes.push(triangles);
        }
    }
    Ok(meshes_of)
}
