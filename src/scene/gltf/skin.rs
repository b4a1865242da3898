//! Skins: meshes that follow joints.
//!
//! glTF 2.0 specification, section 3.7.3.

use std::collections::BTreeMap;

use glam::{DMat3, DMat4, DVec3, Vec3};
use rayon::prelude::*;

use super::accessor::{Component, Shape};
use super::elements::PARALLEL;
use super::error::LoadError;
use super::json::{Item, counted};
use super::node::{Nodes, Placed};
use super::pose::Pose;
use super::primitive::{Primitive, Source, Window};
use crate::scene::Mesh;

/// The joints of a skin in one pose.
#[derive(Debug)]
pub(super) struct SkinPose {
    /// What the vertices are posed relative to, so that they keep their digits far from the world's origin.
    pub origin: DVec3,
    /// From the mesh's space to the world's, less `origin`, for each joint.
    matrices: Vec<DMat4>,
}

/// Pose the skins in `wanted`, indices into the file's.
pub(super) fn pose_all(
    root: &Item,
    nodes: &Nodes,
    pose: &Pose,
    placed: &[Placed],
    wanted: impl Iterator<Item = usize>,
    source: Source,
) -> Result<BTreeMap<usize, SkinPose>, LoadError> {
    let items = root.items("skins", "skin")?;
    let mut to_world = vec![None; nodes.len()];
    for placed in placed {
        to_world[placed.node] = Some(placed.to_world);
    }
    let mut complete = false;
    let mut skins = BTreeMap::new();
    for skin in wanted {
        let item = &items[skin];
        let joints = item.indices("joints", "node", nodes.len())?;
        // A skeleton must be in the scene that it moves; where it is not, its nodes still stand somewhere.
        if !complete && joints.iter().any(|&joint| to_world[joint].is_none()) {
            for placed in nodes.place(&nodes.roots(), pose, &mut Vec::new())? {
                to_world[placed.node].get_or_insert(placed.to_world);
            }
            complete = true;
        }
        skins.insert(skin, pose_skin(item, &joints, &to_world, source)?);
    }
    Ok(skins)
}

fn pose_skin(
    item: &Item,
    joints: &[usize],
    to_world: &[Option<DMat4>],
    source: Source,
) -> Result<SkinPose, LoadError> {
    if joints.is_empty() {
        return Err(item.fault("`joints` is missing or empty"));
    }
    let bind = bind_matrices(item, joints.len(), source)?;
    let joints = joints
        .iter()
        .map(|&joint| to_world[joint].unwrap_or(DMat4::IDENTITY));
    let joints: Vec<DMat4> = joints.collect();
    let origin = joints[0].w_axis.truncate();
    let back = DMat4::from_translation(-origin);
    let matrix = |(index, joint): (usize, &DMat4)| {
        let bind = bind.get(index).copied().unwrap_or(DMat4::IDENTITY);
        back * *joint * bind
    };
    let matrices: Vec<DMat4> = joints.iter().enumerate().map(matrix).collect();
    match matrices.iter().position(|matrix| !matrix.is_finite()) {
        None => Ok(SkinPose { origin, matrices }),
        Some(joint) => Err(item.fault(format!("the matrix of joint {joint} is not finite"))),
    }
}

/// From the mesh's space to each joint's; empty, for the identity, if the file gives none.
fn bind_matrices(item: &Item, joints: usize, source: Source) -> Result<Vec<DMat4>, LoadError> {
    let accessors = source.accessors;
    let Some(index) = item.index("inverseBindMatrices", "accessor", accessors.len())? else {
        return Ok(Vec::new());
    };
    let accessor = &accessors[index];
    accessor.expect_shape("inverseBindMatrices", &[Shape::Mat4])?;
    if accessor.component != Component::F32 {
        return Err(accessor.item.fault("inverseBindMatrices must be floats"));
    }
    if accessor.count < joints {
        return Err(item.fault(format!(
            "`inverseBindMatrices` has {}, but there are {}",
            counted(accessor.count, "element"),
            counted(joints, "joint")
        )));
    }
    let matrices = accessor.floats::<16>(source.data, 0..joints)?;
    let matrix = |columns: [f32; 16]| DMat4::from_cols_array(&columns.map(f64::from));
    Ok(matrices.into_iter().map(matrix).collect())
}

/// Up to four joints of each vertex, and their weights.
struct Set {
    joints: Vec<[f32; 4]>,
    weights: Vec<[f32; 4]>,
}

/// Move the vertices of `mesh`, those of the primitive in `window`, with their joints.
pub(super) fn apply(
    primitive: &mut Primitive,
    mesh: &mut Mesh,
    window: &Window,
) -> Result<(), LoadError> {
    let Some(skin) = primitive.skin else {
        return Ok(());
    };
    let sets = read_sets(primitive, window)?;
    if sets.is_empty() {
        primitive.warn("it has no JOINTS_0 and WEIGHTS_0; it follows the skin's first joint");
    }
    check_joints(primitive, &sets, skin.matrices.len())?;
    let bytes = mesh.positions.len() as u64 * size_of::<DMat4>() as u64;
    if !primitive.source.data.charge(bytes) {
        return Err(primitive
            .item
            .fault("there is no memory left to pose its vertices"));
    }
    let vertices = (0..mesh.positions.len()).into_par_iter();
    let blended = |vertex: usize| blend(&sets, vertex, &skin.matrices);
    let matrices: Vec<DMat4> = vertices.with_min_len(PARALLEL).map(blended).collect();
    displace(mesh, &matrices);
    turn_mirrored(mesh, &matrices);
    Ok(())
}

fn read_sets(primitive: &Primitive, window: &Window) -> Result<Vec<Set>, LoadError> {
    let data = primitive.source.data;
    let mut sets = Vec::new();
    loop {
        let names = ["JOINTS", "WEIGHTS"].map(|name| format!("{name}_{}", sets.len()));
        let [Some(joints), Some(weights)] = [
            primitive.attribute(&names[0])?,
            primitive.attribute(&names[1])?,
        ] else {
            return Ok(sets);
        };
        joints.expect_shape(&names[0], &[Shape::Vec4])?;
        weights.expect_shape(&names[1], &[Shape::Vec4])?;
        if !matches!(joints.component, Component::U8 | Component::U16) || joints.normalized {
            return Err(joints
                .item
                .fault("joints must be plain unsigned integers (`componentType` 5121 or 5123)"));
        }
        sets.push(Set {
            joints: joints.floats(data, window.clone())?,
            weights: weights.floats(data, window.clone())?,
        });
    }
}

/// A joint counts only where it has a weight.
fn check_joints(primitive: &Primitive, sets: &[Set], joints: usize) -> Result<(), LoadError> {
    for (number, set) in sets.iter().enumerate() {
        let outside = |(index, weight): (&f32, &f32)| *index as usize >= joints && *weight != 0.0;
        let wrong = |(index, weight): (&[f32; 4], &[f32; 4])| index.iter().zip(weight).any(outside);
        let pairs = set
            .joints
            .par_iter()
            .zip(&set.weights)
            .with_min_len(PARALLEL);
        if let Some(found) = pairs.find_map_first(|pair| wrong(pair).then_some(pair.0)) {
            let largest = found.iter().fold(0.0_f32, |a, &b| a.max(b));
            return Err(primitive.item.fault(format!(
                "JOINTS_{number} refers to joint {largest}, but its skin has {}",
                counted(joints, "joint")
            )));
        }
    }
    Ok(())
}

/// The joints' matrices as a vertex weighs them.
fn blend(sets: &[Set], vertex: usize, matrices: &[DMat4]) -> DMat4 {
    let mut sum = DMat4::ZERO;
    let mut total = 0.0;
    for set in sets {
        for (&joint, &weight) in set.joints[vertex].iter().zip(&set.weights[vertex]) {
            if weight != 0.0 && weight.is_finite() {
                sum += matrices[joint as usize] * f64::from(weight);
                total += f64::from(weight);
            }
        }
    }
    // Quantised weights do not add up to 1 exactly. Without any, the first joint is followed.
    let first = sets.first().map_or(0, |set| set.joints[vertex][0] as usize);
    match total > 0.0 {
        true => sum * (1.0 / total),
        false => matrices.get(first).copied().unwrap_or(matrices[0]),
    }
}

fn displace(mesh: &mut Mesh, matrices: &[DMat4]) {
    let moved = |p: Vec3, matrix: &DMat4| matrix.transform_point3(p.as_dvec3()).as_vec3();
    let positions = mesh.positions.par_iter_mut().zip(matrices);
    positions
        .with_min_len(PARALLEL)
        .for_each(|(position, matrix)| *position = moved(*position, matrix));
    let normals = mesh.normals.par_iter_mut().zip(matrices);
    normals.with_min_len(PARALLEL).for_each(|(normal, matrix)| {
        let turned = cofactors(matrix) * normal.as_dvec3();
        let outwards = turned * matrix.determinant().signum();
        *normal = unit(outwards).unwrap_or(*normal);
    });
    let tangents = mesh.tangents.par_iter_mut().zip(matrices);
    tangents
        .with_min_len(PARALLEL)
        .for_each(|(tangent, matrix)| {
            let turned = DMat3::from_mat4(*matrix) * tangent.truncate().as_dvec3();
            let turned = unit(turned).unwrap_or(tangent.truncate());
            let side = matrix.determinant().signum() as f32;
            *tangent = turned.extend(tangent.w * side);
        });
}

fn unit(v: DVec3) -> Option<Vec3> {
    let scaled = v / v.abs().max_element();
    scaled.try_normalize().map(|v| v.as_vec3())
}

/// The determinant times the inverse transpose, which exists for singular matrices, too.
fn cofactors(matrix: &DMat4) -> DMat3 {
    let [a, b, c] = [matrix.x_axis, matrix.y_axis, matrix.z_axis].map(|axis| axis.truncate());
    DMat3::from_cols(b.cross(c), c.cross(a), a.cross(b))
}

/// A mirrored triangle shows its other side unless its corners are turned back.
fn turn_mirrored(mesh: &mut Mesh, matrices: &[DMat4]) {
    let mirrored = |vertex: u32| matrices[vertex as usize].determinant() < 0.0;
    let triangles = mesh.indices.par_iter_mut().with_min_len(PARALLEL);
    triangles.for_each(|triangle| {
        if mirrored(triangle[0]) {
            triangle.swap(1, 2);
        }
    });
}
