//! Cameras that nodes place.

use std::f64::consts::PI;

use glam::DMat4;

use super::error::LoadError;
use super::json::Item;
use super::transform;
use crate::scene::{Camera, Projection};

/// Read all cameras of the file; they are in no place yet.
pub(super) fn read_all(root: &Item) -> Result<Vec<Camera>, LoadError> {
    let items = root.items("cameras", "camera")?;
    items.iter().map(read).collect()
}

fn read(item: &Item) -> Result<Camera, LoadError> {
    let projection = match item.text("type")? {
        Some("perspective") => perspective(item)?,
        Some("orthographic") => orthographic(item)?,
        _ => return Err(item.fault("`type` must be perspective or orthographic")),
    };
    Ok(Camera {
        name: item.name().to_owned(),
        projection,
        ..Camera::default()
    })
}

fn perspective(item: &Item) -> Result<Projection, LoadError> {
    let lens = item.object("perspective", "perspective")?;
    let lens = lens.ok_or_else(|| item.fault("`perspective` is missing"))?;
    let yfov = lens.number("yfov")?;
    let yfov = yfov.ok_or_else(|| lens.fault("`yfov` is missing"))?;
    if yfov <= 0.0 || yfov >= PI {
        return Err(lens.fault(format!(
            "`yfov` is {yfov}, expected more than 0 and less than π radians"
        )));
    }
    let aspect = lens.number("aspectRatio")?;
    match aspect {
        Some(ratio) if ratio <= 0.0 => {
            Err(lens.fault(format!("`aspectRatio` is {ratio}, expected more than 0")))
        }
        _ => Ok(Projection::Perspective { yfov, aspect }),
    }
}

fn orthographic(item: &Item) -> Result<Projection, LoadError> {
    let lens = item.object("orthographic", "orthographic")?;
    let lens = lens.ok_or_else(|| item.fault("`orthographic` is missing"))?;
    let size = |key: &str| match lens.number(key)? {
        None => Err(lens.fault(format!("`{key}` is missing"))),
        Some(0.0) => Err(lens.fault(format!("`{key}` is 0, expected half the size of the view"))),
        Some(size) => Ok(size),
    };
    Ok(Projection::Orthographic {
        xmag: size("xmag")?,
        ymag: size("ymag")?,
    })
}

/// `camera` as the node `item` places it.
pub(super) fn place(camera: &Camera, item: &Item, to_world: &DMat4) -> Camera {
    let name = match item.name() {
        "" => &camera.name,
        name => name,
    };
    Camera {
        name: name.to_owned(),
        to_world: transform::rigid(to_world),
        ..camera.clone()
    }
}
