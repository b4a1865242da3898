//! KHR_lights_punctual.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

use glam::{DMat4, DVec3, Vec3};

use super::error::LoadError;
use super::json::Item;
use super::transform;
use crate::scene::{LightKind, PunctualLight};

/// Largest ratio of a spot light's inner to its outer angle: the edge must not be a step.
const SHARPEST: f64 = 0.999;

/// Read all lights of the file; they are in no place yet.
pub(super) fn read_all(
    root: &Item,
    warnings: &mut Vec<String>,
) -> Result<Vec<PunctualLight>, LoadError> {
    let Some(extension) = root.extension("KHR_lights_punctual")? else {
        return Ok(Vec::new());
    };
    let items = extension.items("lights", "light")?;
    items.iter().map(|item| read(item, warnings)).collect()
}

/// The index of the light that a node holds, if any.
pub(super) fn of_node(item: &Item, lights: usize) -> Result<Option<usize>, LoadError> {
    let Some(extension) = item.extension("KHR_lights_punctual")? else {
        return Ok(None);
    };
    let light = extension.index("light", "light", lights)?;
    light
        .map(Some)
        .ok_or_else(|| extension.fault("`light` is missing"))
}

fn read(item: &Item, warnings: &mut Vec<String>) -> Result<PunctualLight, LoadError> {
    let kind = match item.text("type")? {
        Some("point") => LightKind::Point,
        Some("directional") => LightKind::Directional,
        Some("spot") => spot(item, warnings)?,
        _ => return Err(item.fault("`type` must be point, spot or directional")),
    };
    Ok(PunctualLight {
        name: item.name().to_owned(),
        position: DVec3::ZERO,
        direction: DVec3::NEG_Z,
        intensity: intensity(item, warnings)?,
        range: range(item, warnings)?,
        kind,
    })
}

fn intensity(item: &Item, warnings: &mut Vec<String>) -> Result<Vec3, LoadError> {
    let color = item.floats::<3>("color")?.unwrap_or([1.0; 3]);
    let intensity = item.float("intensity")?.unwrap_or(1.0);
    let product = Vec3::from_array(color) * intensity;
    if !product.is_finite() {
        return Err(item.fault("color times intensity is beyond the largest 32-bit float"));
    }
    if product.min_element() < 0.0 {
        warnings.push(format!("{}: it is negative; 0 is used", item.label()));
    }
    Ok(product.max(Vec3::ZERO))
}

fn range(item: &Item, warnings: &mut Vec<String>) -> Result<f64, LoadError> {
    let range = item.number("range")?.unwrap_or(f64::INFINITY);
    if range <= 0.0 {
        warnings.push(format!(
            "{}: `range` is {range}, expected more than 0; no range is used",
            item.label()
        ));
        return Ok(f64::INFINITY);
    }
    Ok(range)
}

fn spot(item: &Item, warnings: &mut Vec<String>) -> Result<LightKind, LoadError> {
    let (inner, outer) = match item.object("spot", "spot")? {
        None => (None, None),
        Some(spot) => (
            spot.number("innerConeAngle")?,
            spot.number("outerConeAngle")?,
        ),
    };
    let (inner, outer) = (inner.unwrap_or(0.0), outer.unwrap_or(FRAC_PI_4));
    if outer <= 0.0 {
        return Err(item.fault(format!(
            "`outerConeAngle` is {outer}, expected more than 0 and at most π/2 radians"
        )));
    }
    if inner < 0.0 || inner > outer || outer > FRAC_PI_2 {
        warnings.push(format!(
            "{}: the cone angles {inner} and {outer} are not in order within [0, π/2]; they are forced to be",
            item.label()
        ));
    }
    let outer = outer.min(FRAC_PI_2);
    Ok(LightKind::Spot {
        inner: inner.clamp(0.0, outer * SHARPEST),
        outer,
    })
}

/// `light` as the node `item` places it; the node's scale changes neither intensity nor range.
pub(super) fn place(light: &PunctualLight, item: &Item, to_world: &DMat4) -> PunctualLight {
    let name = match item.name() {
        "" => &light.name,
        name => name,
    };
    PunctualLight {
        name: name.to_owned(),
        position: to_world.w_axis.truncate(),
        direction: transform::direction(-to_world.z_axis.truncate()).unwrap_or(DVec3::NEG_Z),
        ..light.clone()
    }
}
