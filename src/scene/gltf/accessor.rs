//! Accessors: what they describe, checked against their buffer views before anything is read.
//!
//! glTF 2.0 specification, section 3.6.2.

use serde_json::Value;

use super::buffer::Data;
use super::error::LoadError;
use super::json::Item;

/// Type of a number in a buffer, little-endian.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Component {
    I8,
    U8,
    I16,
    U16,
    U32,
    F32,
}

impl Component {
    fn read(item: &Item) -> Result<Self, LoadError> {
        match item.required_count("componentType")? {
            5120 => Ok(Self::I8),
            5121 => Ok(Self::U8),
            5122 => Ok(Self::I16),
            5123 => Ok(Self::U16),
            5125 => Ok(Self::U32),
            5126 => Ok(Self::F32),
            other => Err(item.fault(format!(
                "`componentType` is {other}, expected 5120, 5121, 5122, 5123, 5125 or 5126"
            ))),
        }
    }

    /// Bytes of one number.
    pub fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::U32 | Self::F32 => 4,
        }
    }
}

/// Shape of an element.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Shape {
    Scalar,
    Vec2,
    Vec3,
    Vec4,
    Mat2,
    Mat3,
    Mat4,
}

impl Shape {
    fn read(item: &Item) -> Result<Self, LoadError> {
        match item.text("type")? {
            Some("SCALAR") => Ok(Self::Scalar),
            Some("VEC2") => Ok(Self::Vec2),
            Some("VEC3") => Ok(Self::Vec3),
            Some("VEC4") => Ok(Self::Vec4),
            Some("MAT2") => Ok(Self::Mat2),
            Some("MAT3") => Ok(Self::Mat3),
            Some("MAT4") => Ok(Self::Mat4),
            _ => {
                let found = item
                    .value("type")
                    .map_or("nothing".into(), Value::to_string);
                Err(item.fault(format!(
                    "`type` must be SCALAR, VEC2, VEC3, VEC4, MAT2, MAT3 or MAT4, found {}",
                    super::json::shorten(&found)
                )))
            }
        }
    }

    /// Its name in the file.
    pub fn name(self) -> &'static str {
        match self {
            Self::Scalar => "SCALAR",
            Self::Vec2 => "VEC2",
            Self::Vec3 => "VEC3",
            Self::Vec4 => "VEC4",
            Self::Mat2 => "MAT2",
            Self::Mat3 => "MAT3",
            Self::Mat4 => "MAT4",
        }
    }

    /// How many numbers make one element.
    pub fn components(self) -> usize {
        match self {
            Self::Scalar => 1,
            Self::Vec2 => 2,
            Self::Vec3 => 3,
            Self::Vec4 | Self::Mat2 => 4,
            Self::Mat3 => 9,
            Self::Mat4 => 16,
        }
    }

    /// Bytes of one element; columns of matrices begin at multiples of 4.
    pub fn size(self, component: Component) -> usize {
        let columns = |count: usize| count * (count * component.size()).next_multiple_of(4);
        match self {
            Self::Scalar => component.size(),
            Self::Vec2 => 2 * component.size(),
            Self::Vec3 => 3 * component.size(),
            Self::Vec4 => 4 * component.size(),
            Self::Mat2 => columns(2),
            Self::Mat3 => columns(3),
            Self::Mat4 => columns(4),
        }
    }
}

/// A typed view of a buffer view.
#[derive(Debug)]
pub(super) struct Accessor<'a> {
    /// The object in the file, for messages.
    pub item: Item<'a>,
    pub component: Component,
    pub shape: Shape,
    /// Whether integers stand for [0, 1] or [−1, 1].
    pub normalized: bool,
    /// Elements, at least 1.
    pub count: usize,
    /// Where the elements are; none: they are zero.
    pub block: Option<Block>,
    /// Elements one after the other that an extension holds; they take the place of those in `block`.
    pub decoded: Option<Vec<u8>>,
    pub sparse: Option<Sparse>,
}

/// Elements in a buffer view: all of them lie inside it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Block {
    pub view: usize,
    pub offset: usize,
    pub stride: usize,
}

/// Elements that replace others.
#[derive(Debug)]
pub(super) struct Sparse {
    pub count: usize,
    pub index_component: Component,
    pub indices: Block,
    pub values: Block,
}

/// Read the descriptions of all accessors.
pub(super) fn read_all<'a>(root: &Item<'a>, data: &Data) -> Result<Vec<Accessor<'a>>, LoadError> {
    let items = root.items("accessors", "accessor")?;
    items.into_iter().map(|item| read(item, data)).collect()
}

fn read<'a>(item: Item<'a>, data: &Data) -> Result<Accessor<'a>, LoadError> {
    let component = Component::read(&item)?;
    let shape = Shape::read(&item)?;
    let count = item.required_count("count")?;
    if count == 0 {
        return Err(item.fault("`count` is 0, expected at least 1"));
    }
    let size = shape.size(component);
    let sparse = match item.object("sparse", "sparse")? {
        Some(sparse) => Some(read_sparse(&sparse, data, size, count)?),
        None => None,
    };
    Ok(Accessor {
        component,
        shape,
        normalized: item.flag("normalized")?,
        count,
        block: read_block(&item, data, size, count, true)?,
        decoded: None,
        sparse,
        item,
    })
}

fn read_sparse(
    item: &Item,
    data: &Data,
    size: usize,
    elements: usize,
) -> Result<Sparse, LoadError> {
    let count = item.required_count("count")?;
    if count > elements {
        return Err(item.fault(format!(
            "it replaces {count} elements, but the accessor has {elements}"
        )));
    }
    let missing = |key: &str| item.fault(format!("`{key}` is missing"));
    let indices = item.object("indices", "indices")?;
    let indices = indices.ok_or_else(|| missing("indices"))?;
    let values = item.object("values", "values")?;
    let values = values.ok_or_else(|| missing("values"))?;
    let index_component = Component::read(&indices)?;
    if !matches!(
        index_component,
        Component::U8 | Component::U16 | Component::U32
    ) {
        return Err(indices.fault("`componentType` must be 5121, 5123 or 5125"));
    }
    let view_missing = |item: &Item| item.fault("`bufferView` is missing");
    Ok(Sparse {
        count,
        index_component,
        indices: read_block(&indices, data, index_component.size(), count, false)?
            .ok_or_else(|| view_missing(&indices))?,
        values: read_block(&values, data, size, count, false)?
            .ok_or_else(|| view_missing(&values))?,
    })
}

/// Where `count` elements of `size` bytes lie; an error if the buffer view does not hold them.
fn read_block(
    item: &Item,
    data: &Data,
    size: usize,
    count: usize,
    strided: bool,
) -> Result<Option<Block>, LoadError> {
    let Some(view) = item.index("bufferView", "buffer view", data.views().len())? else {
        return Ok(None);
    };
    let offset = item.count("byteOffset")?.unwrap_or(0);
    let range = &data.views()[view];
    let stride = range.stride.filter(|_| strided).unwrap_or(size);
    if stride < size {
        return Err(item.fault(format!(
            "its elements of {size} bytes overlap, since {} has `byteStride` {stride}",
            range.label
        )));
    }
    let end = count
        .checked_sub(1)
        .map_or(Some(0), |steps| {
            steps.checked_mul(stride)?.checked_add(size)
        })
        .and_then(|bytes| bytes.checked_add(offset));
    if end.is_none_or(|end| end > range.len()) {
        return Err(item.fault(format!(
            "{count} elements of {size} bytes, {stride} apart, from byte {offset} on do not fit in {}, which has {} bytes",
            range.label,
            range.len()
        )));
    }
    Ok(Some(Block {
        view,
        offset,
        stride,
    }))
}
