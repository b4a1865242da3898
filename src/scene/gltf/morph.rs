//! Morph targets: weighted displacements of attributes.
//!
//! glTF 2.0 specification, section 3.7.2.2.

use rayon::prelude::*;

use super::accessor::{Accessor, Shape};
use super::elements::PARALLEL;
use super::error::LoadError;
use super::json::{Item, counted};
use super::primitive::{Primitive, Window};

/// The morph targets of a primitive that have a weight, and the weight.
pub(super) fn weighted<'a>(
    primitive: &Item<'a>,
    weights: &[f64],
) -> Result<Vec<(f64, Item<'a>)>, LoadError> {
    if weights.is_empty() {
        return Ok(Vec::new());
    }
    let targets = primitive.items("targets", "morph target")?;
    let pairs = weights.iter().copied().zip(targets);
    Ok(pairs.filter(|(weight, _)| *weight != 0.0).collect())
}

/// Add the weighted displacements of the attribute `name` to the `values` of the vertices in `window`. The fourth
/// component of a tangent, and of a colour where the target has three, stays.
pub(super) fn displace<const N: usize>(
    primitive: &Primitive,
    name: &str,
    values: &mut [[f32; N]],
    window: &Window,
) -> Result<(), LoadError> {
    let mut parts: Vec<(f64, Deltas)> = Vec::new();
    for (weight, target) in &primitive.targets {
        let accessors = primitive.source.accessors;
        if let Some(index) = target.index(name, "accessor", accessors.len())? {
            let deltas = deltas(primitive, target, name, &accessors[index], window)?;
            parts.push((*weight, deltas));
        }
    }
    if parts.is_empty() {
        return Ok(());
    }
    let values = values.par_iter_mut().with_min_len(PARALLEL).enumerate();
    values.for_each(|(vertex, value)| {
        // In f64, so that many small displacements of a far point do not get lost one by one.
        let mut sum = value.map(f64::from);
        for (weight, deltas) in &parts {
            let delta = deltas.of(vertex);
            for (sum, &delta) in sum.iter_mut().zip(delta) {
                *sum += weight * f64::from(delta);
            }
        }
        *value = sum.map(|component| component as f32);
    });
    Ok(())
}

/// Displacements of one target.
enum Deltas {
    Two(Vec<[f32; 2]>),
    Three(Vec<[f32; 3]>),
    Four(Vec<[f32; 4]>),
}

impl Deltas {
    fn of(&self, vertex: usize) -> &[f32] {
        match self {
            Self::Two(deltas) => &deltas[vertex],
            Self::Three(deltas) => &deltas[vertex],
            Self::Four(deltas) => &deltas[vertex],
        }
    }
}

fn deltas(
    primitive: &Primitive,
    target: &Item,
    name: &str,
    accessor: &Accessor,
    window: &Window,
) -> Result<Deltas, LoadError> {
    let vertices = primitive.vertices;
    if accessor.count != vertices {
        return Err(target.fault(format!(
            "{name} has {}, but the primitive has {vertices} vertices",
            counted(accessor.count, "element")
        )));
    }
    let (data, window) = (primitive.source.data, window.clone());
    let shapes: &[Shape] = match name {
        "POSITION" | "NORMAL" | "TANGENT" => &[Shape::Vec3],
        "COLOR_0" => &[Shape::Vec3, Shape::Vec4],
        _ => &[Shape::Vec2],
    };
    accessor.expect_shape(&format!("{name} of a morph target"), shapes)?;
    Ok(match accessor.shape {
        Shape::Vec2 => Deltas::Two(accessor.floats(data, window)?),
        Shape::Vec3 => Deltas::Three(accessor.floats(data, window)?),
        _ => Deltas::Four(accessor.floats(data, window)?),
    })
}
