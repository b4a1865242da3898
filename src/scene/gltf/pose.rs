//! Skins, morph targets and animations: shown in their rest pose.

use glam::DMat4;

use super::accessor::Shape;
use super::error::LoadError;
use super::json::{Item, counted};
use super::node::{Nodes, Placed};
use super::primitive::Source;

/// The skins of the file.
#[derive(Debug)]
pub(super) struct Skins {
    /// Where the bind pose of each skin lies in the world; none if its joints are not in the scene.
    to_world: Vec<Option<DMat4>>,
}

impl Skins {
    /// Read all skins.
    pub fn read(
        root: &Item,
        nodes: &Nodes,
        placed: &[Placed],
        source: Source,
    ) -> Result<Self, LoadError> {
        let items = root.items("skins", "skin")?;
        let mut joints_to_world = vec![None; nodes.len()];
        for Placed { node, to_world } in placed {
            joints_to_world[*node] = Some(*to_world);
        }
        let mut to_world = Vec::with_capacity(items.len());
        for item in &items {
            let joints = item.indices("joints", "node", nodes.len())?;
            let first = joints.first();
            let first = first.ok_or_else(|| item.fault("`joints` is missing or empty"))?;
            let bind = first_bind_matrix(item, source)?;
            let joint = joints_to_world[*first];
            let matrix = joint.map(|joint| joint * bind);
            to_world.push(matrix.filter(|matrix| matrix.is_finite()));
        }
        Ok(Self { to_world })
    }

    /// Where the mesh of a node is shown. A skinned mesh follows its joints and not its node
    /// (glTF 2.0, section 3.7.3.3): its bind pose is placed by its first joint.
    pub fn rest_pose(
        &self,
        item: &Item,
        placed: &Placed,
        warnings: &mut Vec<String>,
    ) -> Result<DMat4, LoadError> {
        let Some(skin) = item.index("skin", "skin", self.to_world.len())? else {
            return Ok(placed.to_world);
        };
        warnings.push(format!(
            "{}: its skin is not posed; it is rendered in its rest pose",
            item.label()
        ));
        Ok(self.to_world[skin].unwrap_or(placed.to_world))
    }
}

/// World space of the bind pose to the first joint's space; identity if the file gives none.
fn first_bind_matrix(item: &Item, source: Source) -> Result<DMat4, LoadError> {
    let accessors = source.accessors;
    let Some(index) = item.index("inverseBindMatrices", "accessor", accessors.len())? else {
        return Ok(DMat4::IDENTITY);
    };
    accessors[index].expect_shape("inverseBindMatrices", &[Shape::Mat4])?;
    let matrices = accessors[index].floats::<16>(source.data, 0..1)?;
    let columns = matrices[0].map(f64::from);
    Ok(DMat4::from_cols_array(&columns))
}

/// Say that morph targets are not applied.
pub(super) fn warn_of_morphs(mesh: &Item, warnings: &mut Vec<String>) -> Result<(), LoadError> {
    for primitive in mesh.items("primitives", "primitive")? {
        if !primitive.array("targets")?.is_empty() {
            warnings.push(format!(
                "{}: its morph targets are not applied; it is rendered in its rest pose",
                mesh.label()
            ));
            break;
        }
    }
    Ok(())
}

/// Say that animations are not played.
pub(super) fn warn_of_animations(root: &Item, warnings: &mut Vec<String>) -> Result<(), LoadError> {
    let animations = root.array("animations")?.len();
    if animations > 0 {
        warnings.push(format!(
            "{} not played; the scene is rendered in its rest pose",
            match animations {
                1 => "its animation is".to_owned(),
                _ => format!("its {} are", counted(animations, "animation")),
            }
        ));
    }
    Ok(())
}
