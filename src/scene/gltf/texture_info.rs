//! The `textureInfo` objects of materials, with KHR_texture_transform.

use glam::{DMat2, DVec2, Vec2};

use super::error::LoadError;
use super::json::Item;
use super::material::RawMaterial;

/// A use of one of the file's textures.
#[derive(Debug, Clone, Copy)]
pub(super) struct RawSlot {
    /// Index into the file's textures.
    pub texture: usize,
    /// The file's texture coordinate set; after [`choose_sets`] the scene's, 0 or 1.
    pub tex_coord: u32,
    /// uv' = matrix · uv + offset.
    pub matrix: [Vec2; 2],
    /// See `matrix`.
    pub offset: Vec2,
}

/// Read the `textureInfo` object `key` of `item`, if present.
pub(super) fn read(item: &Item, key: &str, textures: usize) -> Result<Option<RawSlot>, LoadError> {
    let Some(info) = item.object(key, key)? else {
        return Ok(None);
    };
    let texture = info
        .index("index", "texture", textures)?
        .ok_or_else(|| info.fault("`index` is missing"))?;
    let mut slot = RawSlot {
        texture,
        tex_coord: tex_coord(&info)?.unwrap_or(0),
        matrix: [Vec2::X, Vec2::Y],
        offset: Vec2::ZERO,
    };
    if let Some(transform) = info.extension("KHR_texture_transform")? {
        apply_transform(&mut slot, &transform)?;
    }
    Ok(Some(slot))
}

fn tex_coord(item: &Item) -> Result<Option<u32>, LoadError> {
    let Some(set) = item.count("texCoord")? else {
        return Ok(None);
    };
    let set = u32::try_from(set);
    set.map(Some)
        .map_err(|_| item.fault("`texCoord` is not a texture coordinate set"))
}

/// Translation · rotation · scale.
///
/// The extension's text says that UVs turn counter-clockwise with v pointing down; its GLSL
/// listing has the transposed matrix, an acknowledged mistake (KhronosGroup/glTF issue 1563) that
/// no implementation follows.
fn apply_transform(slot: &mut RawSlot, item: &Item) -> Result<(), LoadError> {
    let offset = item.floats::<2>("offset")?.unwrap_or([0.0, 0.0]);
    let scale = item.numbers::<2>("scale")?.unwrap_or([1.0, 1.0]);
    let (sin, cos) = item.number("rotation")?.unwrap_or(0.0).sin_cos();
    let rotation = DMat2::from_cols(DVec2::new(cos, -sin), DVec2::new(sin, cos));
    let matrix = (rotation * DMat2::from_diagonal(DVec2::from_array(scale))).as_mat2();
    if !matrix.is_finite() {
        return Err(item.fault("`scale` is beyond the largest 32-bit float"));
    }
    slot.matrix = [matrix.x_axis, matrix.y_axis];
    slot.offset = Vec2::from_array(offset);
    slot.tex_coord = tex_coord(item)?.unwrap_or(slot.tex_coord);
    Ok(())
}

/// Map the texture coordinate sets that a material reads to sets 0 and 1 of the scene.
///
/// The scene keeps two sets a mesh; a material that reads only sets 0 and 1 keeps their numbers.
pub(super) fn choose_sets(item: &Item, raw: &mut RawMaterial) -> Result<(), LoadError> {
    let mut sets: Vec<u32> = raw
        .slots
        .iter()
        .flatten()
        .map(|slot| slot.tex_coord)
        .collect();
    sets.sort_unstable();
    sets.dedup();
    raw.tex_coords = match sets.as_slice() {
        [] | [0] | [1] | [0, 1] => return Ok(()),
        [only] => [*only, 1],
        [first, second] => [*first, *second],
        _ => {
            return Err(item.fault(format!(
                "its textures use {} sets of texture coordinates, expected at most two",
                sets.len()
            )));
        }
    };
    for slot in raw.slots.iter_mut().flatten() {
        slot.tex_coord = u32::from(slot.tex_coord != raw.tex_coords[0]);
    }
    Ok(())
}
