//! KHR_draco_mesh_compression: the attributes and the triangles of a primitive in one stream.

use draco_core::{
    DataType, DecodeLimits, DecoderBuffer, Mesh as Geometry, MeshDecoder, PointAttribute,
    PointIndex,
};
use serde_json::Value;

use super::accessor::{Accessor, Component};
use super::error::LoadError;
use super::json::{Item, counted, shorten};
use super::primitive::Source;
use crate::host::guard;

/// Points and faces that a stream may have beyond [`EXPANSION`] times its bytes.
const SMALLEST_LIMIT: u64 = 1 << 16;
/// How many points and faces a byte may stand for. Regular grids reach about 10.
const EXPANSION: u64 = 64;
/// Bytes that the decoder takes for a face: indices, corner tables and maps.
const FACE_BYTES: u64 = 128;

/// What a primitive's stream holds; nothing where the primitive has none.
#[derive(Debug, Default)]
pub(super) struct Decoded<'a> {
    pub triangles: Option<Vec<[u32; 3]>>,
    pub warnings: Vec<String>,
    attributes: Vec<(&'a str, Accessor<'a>)>,
}

impl<'a> Decoded<'a> {
    /// The attribute called `name`, if the stream holds it.
    pub fn attribute(&self, name: &str) -> Option<&Accessor<'a>> {
        let mut attributes = self.attributes.iter();
        let found = attributes.find(|(known, _)| *known == name);
        found.map(|(_, accessor)| accessor)
    }
}

/// Decode the stream of a primitive, if it has one.
pub(super) fn decode<'a>(item: &Item<'a>, source: Source<'a>) -> Result<Decoded<'a>, LoadError> {
    let Some(extension) = item.extension("KHR_draco_mesh_compression")? else {
        return Ok(Decoded::default());
    };
    let mode = item.count("mode")?.unwrap_or(4);
    // Strips, too, are decoded as a list of triangles.
    if mode != 4 && mode != 5 {
        return Err(extension.fault(format!(
            "the primitive's `mode` is {mode}, expected 4 or 5 (triangles or a strip of them)"
        )));
    }
    let data = source.data;
    let view = extension.index("bufferView", "buffer view", data.views().len())?;
    let view = view.ok_or_else(|| extension.fault("`bufferView` is missing"))?;
    let geometry = decode_stream(&extension, data.view(view)?, source)?;
    let mut decoded = Decoded {
        triangles: Some(triangles(&extension, &geometry)?),
        ..Decoded::default()
    };
    let attributes = extension.object("attributes", "attributes")?;
    let attributes = attributes.ok_or_else(|| extension.fault("`attributes` is missing"))?;
    let Some(Value::Object(names)) = extension.value("attributes") else {
        return Ok(decoded);
    };
    for name in names.keys() {
        let id = attributes.required_count(name)?;
        read_attribute(
            item,
            &extension,
            (name, id),
            &geometry,
            source,
            &mut decoded,
        )?;
    }
    Ok(decoded)
}

/// The geometry in a stream. A header may claim any number of points, so the counts are limited by the bytes
/// that are there, and what they take is charged to the scene.
fn decode_stream(extension: &Item, bytes: &[u8], source: Source) -> Result<Geometry, LoadError> {
    let most = SMALLEST_LIMIT.max(EXPANSION * bytes.len() as u64);
    let most = most.min(u32::MAX.into());
    let limits = DecodeLimits::default()
        .with_max_points(most)
        .with_max_faces(most)
        .with_max_decoded_bytes(source.data.budget_left());
    let mut geometry = Geometry::new();
    // The decoder is made for untrusted bytes; should it panic on some all the same, that is one file's error.
    let result = guard::catch(|| {
        let mut buffer = DecoderBuffer::new(bytes).with_limits(limits);
        let result = MeshDecoder::new().decode(&mut buffer, &mut geometry);
        result.map_err(|error| shorten(&error.to_string().replace('\n', " ")))
    });
    let result = result.unwrap_or_else(|| Err("the decoder gave up".to_owned()));
    result.map_err(|reason| {
        extension.fault(format!(
            "its data is malformed ({reason}); export or copy the file again"
        ))
    })?;
    let (points, faces) = (geometry.num_points() as u64, geometry.num_faces() as u64);
    if points > most || faces > most || !source.data.charge(faces * FACE_BYTES) {
        return Err(extension.fault(format!(
            "its {} bytes hold {points} points and {faces} triangles, which is too many",
            bytes.len()
        )));
    }
    Ok(geometry)
}

fn triangles(extension: &Item, geometry: &Geometry) -> Result<Vec<[u32; 3]>, LoadError> {
    let points = geometry.num_points();
    let faces: Vec<[u32; 3]> = geometry
        .faces()
        .iter()
        .map(|face| face.map(|point| point.0))
        .collect();
    let inside = |&point: &u32| (point as usize) < points;
    match faces.as_flattened().iter().all(inside) {
        true => Ok(faces),
        false => Err(extension.fault(format!(
            "a triangle refers to a point that is not among its {points}"
        ))),
    }
}

/// Add the attribute `name`, which has number `id` in the stream, as the primitive's accessor describes it.
fn read_attribute<'a>(
    item: &Item<'a>,
    extension: &Item<'a>,
    (name, id): (&'a str, usize),
    geometry: &Geometry,
    source: Source<'a>,
    decoded: &mut Decoded<'a>,
) -> Result<(), LoadError> {
    let accessors = source.accessors;
    let attributes = item.object("attributes", "attributes")?;
    let index = match &attributes {
        Some(attributes) => attributes.index(name, "accessor", accessors.len())?,
        None => None,
    };
    // What the primitive does not ask for is not read.
    let Some(index) = index else { return Ok(()) };
    let described = &accessors[index];
    let stored = u32::try_from(id).ok();
    let stored = stored.and_then(|id| geometry.attribute_by_unique_id(id));
    let stored = stored.ok_or_else(|| {
        extension.fault(format!(
            "{name} is attribute {id}, which its data does not hold"
        ))
    })?;
    let points = geometry.num_points();
    if described.count != points && decoded.warnings.is_empty() {
        decoded.warnings.push(format!(
            "{}: it holds {}, but the accessors promise {}; what it holds is used",
            extension.label(),
            counted(points, "point"),
            counted(described.count, "element"),
        ));
    }
    let size = described.shape.size(described.component) as u64;
    if !source.data.charge(points as u64 * size) {
        return Err(extension.fault("there is no memory left for its attributes"));
    }
    let bytes = elements(stored, points, described)
        .map_err(|problem| extension.fault(format!("{name}: {problem}")))?;
    let accessor = Accessor {
        item: described.item.clone(),
        component: described.component,
        shape: described.shape,
        normalized: described.normalized,
        count: points,
        block: None,
        decoded: Some(bytes),
        sparse: None,
    };
    decoded.attributes.push((name, accessor));
    Ok(())
}

/// The attribute's values for all points one after the other, in the accessor's type.
fn elements(
    stored: &PointAttribute,
    points: usize,
    described: &Accessor,
) -> Result<Vec<u8>, String> {
    let components = described.shape.components();
    if usize::from(stored.num_components()) != components {
        return Err(format!(
            "its elements have {}, but the accessor is {}",
            counted(stored.num_components().into(), "component"),
            described.shape.name()
        ));
    }
    let kind = stored.data_type();
    let width = kind.byte_length();
    if width == 0 {
        return Err(format!("numbers of type {kind:?} are not read"));
    }
    let stride = usize::try_from(stored.byte_stride()).unwrap_or(0);
    let same = component_of(kind) == Some(described.component);
    let mut bytes = Vec::with_capacity(points * components * described.component.size());
    for point in 0..points as u32 {
        let value = stored.mapped_index(PointIndex(point)).0 as usize;
        let at = value.checked_mul(stride);
        let end = at.and_then(|at| at.checked_add(components * width));
        let element = at
            .zip(end)
            .and_then(|(at, end)| stored.buffer().data().get(at..end));
        let element = element.ok_or_else(|| format!("point {point} has no value"))?;
        match same {
            true => bytes.extend_from_slice(element),
            false => element
                .chunks_exact(width)
                .try_for_each(|number| convert(number, kind, described.component, &mut bytes))?,
        }
    }
    Ok(bytes)
}

fn component_of(kind: DataType) -> Option<Component> {
    match kind {
        DataType::Int8 => Some(Component::I8),
        DataType::Uint8 => Some(Component::U8),
        DataType::Int16 => Some(Component::I16),
        DataType::Uint16 => Some(Component::U16),
        DataType::Uint32 => Some(Component::U32),
        DataType::Float32 => Some(Component::F32),
        _ => None,
    }
}

/// Append one number in the accessor's type, where that type can hold it: encoders choose wider types, too.
fn convert(raw: &[u8], from: DataType, to: Component, bytes: &mut Vec<u8>) -> Result<(), String> {
    let number =
        number(raw, from).ok_or_else(|| format!("numbers of type {from:?} are not read"))?;
    let back = match to {
        Component::I8 => put(bytes, (number as i8).to_le_bytes(), f64::from(number as i8)),
        Component::U8 => put(bytes, (number as u8).to_le_bytes(), f64::from(number as u8)),
        Component::I16 => put(
            bytes,
            (number as i16).to_le_bytes(),
            f64::from(number as i16),
        ),
        Component::U16 => put(
            bytes,
            (number as u16).to_le_bytes(),
            f64::from(number as u16),
        ),
        Component::U32 => put(
            bytes,
            (number as u32).to_le_bytes(),
            f64::from(number as u32),
        ),
        // Rounding to the nearest float is what the accessor asks for.
        Component::F32 => put(bytes, (number as f32).to_le_bytes(), number),
    };
    match back == number || number.is_nan() {
        true => Ok(()),
        false => Err(format!("{number} does not fit the accessor's type {to:?}")),
    }
}

fn put<const SIZE: usize>(bytes: &mut Vec<u8>, raw: [u8; SIZE], value: f64) -> f64 {
    bytes.extend_from_slice(&raw);
    value
}

/// A little-endian number of a stream; all of these are exact in f64.
fn number(raw: &[u8], kind: DataType) -> Option<f64> {
    Some(match kind {
        DataType::Int8 => f64::from(i8::from_le_bytes(raw.try_into().ok()?)),
        DataType::Uint8 => f64::from(u8::from_le_bytes(raw.try_into().ok()?)),
        DataType::Int16 => f64::from(i16::from_le_bytes(raw.try_into().ok()?)),
        DataType::Uint16 => f64::from(u16::from_le_bytes(raw.try_into().ok()?)),
        DataType::Int32 => f64::from(i32::from_le_bytes(raw.try_into().ok()?)),
        DataType::Uint32 => f64::from(u32::from_le_bytes(raw.try_into().ok()?)),
        DataType::Float32 => f64::from(f32::from_le_bytes(raw.try_into().ok()?)),
        DataType::Float64 => f64::from_le_bytes(raw.try_into().ok()?),
        _ => return None,
    })
}
