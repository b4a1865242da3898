//! EXT_mesh_gpu_instancing: a node that shows its mesh many times.

use glam::{DMat4, DQuat, DVec3, DVec4};

use super::accessor::{Accessor, Component, Shape};
use super::error::LoadError;
use super::json::{Item, counted};
use super::primitive::Source;

/// Each instance's space to the node's; none if the node has no such extension.
pub(super) fn read(
    node: &Item,
    source: Source,
    warnings: &mut Vec<String>,
) -> Result<Option<Vec<DMat4>>, LoadError> {
    let Some(extension) = node.extension("EXT_mesh_gpu_instancing")? else {
        return Ok(None);
    };
    let attributes = extension.object("attributes", "attributes")?;
    let attributes = attributes.ok_or_else(|| extension.fault("`attributes` is missing"))?;
    let accessor = |name: &str| -> Result<Option<&Accessor>, LoadError> {
        let index = attributes.index(name, "accessor", source.accessors.len())?;
        Ok(index.map(|index| &source.accessors[index]))
    };
    let names = ["TRANSLATION", "ROTATION", "SCALE"];
    let [translation, rotation, scale] = [
        accessor(names[0])?,
        accessor(names[1])?,
        accessor(names[2])?,
    ];
    let given = [translation, rotation, scale];
    let Some(count) = given.iter().flatten().map(|accessor| accessor.count).next() else {
        return Err(attributes.fault("it has none of TRANSLATION, ROTATION and SCALE"));
    };
    for (name, accessor) in names.iter().zip(given) {
        let found = accessor.map_or(count, |accessor| accessor.count);
        if found != count {
            return Err(attributes.fault(format!(
                "{name} has {}, but another attribute has {count}",
                counted(found, "element")
            )));
        }
    }
    // An instance takes more than its numbers: a matrix, a name, and what becomes of it later.
    if !source.data.charge((count as u64).saturating_mul(256)) {
        return Err(extension.fault(format!("{count} instances are too many")));
    }
    let translations = vectors(translation, names[0], source)?;
    let scales = vectors(scale, names[2], source)?;
    let (rotations, broken) = rotations(rotation, source)?;
    if broken > 0 {
        warnings.push(format!(
            "{}: {broken} of its rotations have no direction; no rotation is used there",
            extension.label()
        ));
    }
    let matrix = |index: usize| {
        DMat4::from_scale_rotation_translation(
            scales.get(index).copied().unwrap_or(DVec3::ONE),
            rotations.get(index).copied().unwrap_or(DQuat::IDENTITY),
            translations.get(index).copied().unwrap_or(DVec3::ZERO),
        )
    };
    Ok(Some((0..count).map(matrix).collect()))
}

fn vectors(
    accessor: Option<&Accessor>,
    name: &str,
    source: Source,
) -> Result<Vec<DVec3>, LoadError> {
    let Some(accessor) = accessor else {
        return Ok(Vec::new());
    };
    accessor.expect_shape(name, &[Shape::Vec3])?;
    let raw = accessor.floats::<3>(source.data, 0..accessor.count)?;
    let vectors: Vec<DVec3> = raw
        .into_iter()
        .map(|v| DVec3::from(v.map(f64::from)))
        .collect();
    match vectors.iter().position(|v| !v.is_finite()) {
        None => Ok(vectors),
        Some(index) => Err(accessor
            .item
            .fault(format!("element {index}, a {name}, is not finite"))),
    }
}

/// Unit quaternions, and how many had no direction.
fn rotations(
    accessor: Option<&Accessor>,
    source: Source,
) -> Result<(Vec<DQuat>, usize), LoadError> {
    let Some(accessor) = accessor else {
        return Ok((Vec::new(), 0));
    };
    accessor.expect_shape("ROTATION", &[Shape::Vec4])?;
    let integers = accessor.component != Component::F32;
    if integers && !accessor.normalized {
        return Err(accessor
            .item
            .fault("ROTATION has integers; expected floats or normalised integers"));
    }
    let raw = accessor.floats::<4>(source.data, 0..accessor.count)?;
    let mut broken = 0;
    let unit = |v: [f32; 4]| {
        let unit = DVec4::from(v.map(f64::from)).try_normalize();
        unit.map_or_else(
            || {
                broken += 1;
                DQuat::IDENTITY
            },
            DQuat::from_vec4,
        )
    };
    let rotations = raw.into_iter().map(unit).collect();
    Ok((rotations, broken))
}
