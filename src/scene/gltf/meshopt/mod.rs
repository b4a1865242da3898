//! EXT_meshopt_compression and KHR_meshopt_compression: buffer views that are compressed, each by itself.
//!
//! The decoders follow the text of both specifications (appendix A, the bit stream; appendix B, the filters).

mod attributes;
mod filters;
mod indices;
mod stream;

use std::ops::Range;

use super::error::LoadError;
use super::json::Item;
use filters::Filter;

/// The extensions; their objects are alike.
const NAMES: [&str; 2] = ["KHR_meshopt_compression", "EXT_meshopt_compression"];

/// Most bytes that a byte of a stream can stand for: a control byte of 0xAA says that 4 bytes of each of 256
/// elements repeat.
const EXPANSION: usize = 1024;

/// What to decode for a buffer view.
#[derive(Debug)]
pub(super) struct Compressed<'a> {
    /// The extension's object, for messages.
    pub item: Item<'a>,
    /// The buffer that holds the compressed bytes.
    pub buffer: usize,
    /// Where in it they are.
    pub range: Range<usize>,
    stride: usize,
    count: usize,
    mode: Mode,
    filter: Filter,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Mode {
    Attributes,
    Triangles,
    Indices,
}

/// The extension's object in a buffer view or a buffer, if present.
pub(super) fn extension<'a>(item: &Item<'a>) -> Result<Option<Item<'a>>, LoadError> {
    for name in NAMES {
        if let Some(extension) = item.extension(name)? {
            return Ok(Some(extension));
        }
    }
    Ok(None)
}

/// How the buffer view `item` of `length` bytes is compressed, if it is; `lengths` are those of all buffers.
pub(super) fn read<'a>(
    item: &Item<'a>,
    length: usize,
    lengths: &[usize],
) -> Result<Option<Compressed<'a>>, LoadError> {
    let Some(item) = extension(item)? else {
        return Ok(None);
    };
    let buffer = item.index("buffer", "buffer", lengths.len())?;
    let buffer = buffer.ok_or_else(|| item.fault("`buffer` is missing"))?;
    let start = item.count("byteOffset")?.unwrap_or(0);
    let size = item.required_count("byteLength")?;
    let end = start
        .checked_add(size)
        .filter(|&end| end <= lengths[buffer]);
    let end = end.ok_or_else(|| {
        item.fault(format!(
            "{size} bytes from byte {start} on do not fit in buffer {buffer}, which has {}",
            lengths[buffer]
        ))
    })?;
    let compressed = Compressed {
        buffer,
        range: start..end,
        stride: item.required_count("byteStride")?,
        count: item.required_count("count")?,
        mode: mode(&item)?,
        filter: filter(&item)?,
        item,
    };
    compressed.check(length)?;
    Ok(Some(compressed))
}

fn mode(item: &Item) -> Result<Mode, LoadError> {
    match item.text("mode")? {
        Some("ATTRIBUTES") => Ok(Mode::Attributes),
        Some("TRIANGLES") => Ok(Mode::Triangles),
        Some("INDICES") => Ok(Mode::Indices),
        _ => Err(item.fault("`mode` must be ATTRIBUTES, TRIANGLES or INDICES")),
    }
}

fn filter(item: &Item) -> Result<Filter, LoadError> {
    match item.text("filter")? {
        None | Some("NONE") => Ok(Filter::None),
        Some("OCTAHEDRAL") => Ok(Filter::Octahedral),
        Some("QUATERNION") => Ok(Filter::Quaternion),
        Some("EXPONENTIAL") => Ok(Filter::Exponential),
        Some("COLOR") => Ok(Filter::Color),
        _ => Err(item.fault("`filter` must be NONE, OCTAHEDRAL, QUATERNION, EXPONENTIAL or COLOR")),
    }
}

impl Compressed<'_> {
    /// The rules that the specification states for the extension's object.
    fn check(&self, length: usize) -> Result<(), LoadError> {
        let (stride, count) = (self.stride, self.count);
        let size = stride.checked_mul(count);
        if size != Some(length) {
            return Err(self.item.fault(format!(
                "{count} elements of {stride} bytes are not the {length} bytes of the buffer view"
            )));
        }
        let attributes = self.mode == Mode::Attributes;
        let strides = match attributes {
            true => stride.is_multiple_of(4) && (4..=256).contains(&stride),
            false => stride == 2 || stride == 4,
        };
        if !strides || !self.filter.takes(stride) {
            return Err(self.item.fault(format!(
                "`byteStride` is {stride}, which its mode and filter do not allow"
            )));
        }
        if !attributes && self.filter != Filter::None {
            return Err(self.item.fault("indices must not have a `filter`"));
        }
        if self.mode == Mode::Triangles && !count.is_multiple_of(3) {
            return Err(self
                .item
                .fault(format!("`count` is {count}, expected a multiple of 3")));
        }
        if length > self.range.len().saturating_mul(EXPANSION) {
            return Err(self.item.fault(format!(
                "{} compressed bytes cannot hold {length} bytes",
                self.range.len()
            )));
        }
        Ok(())
    }

    /// Bytes that it decodes to.
    pub fn decoded_len(&self) -> usize {
        self.stride * self.count
    }

    /// Decode the `bytes` in its range.
    pub fn decode(&self, bytes: &[u8]) -> Result<Vec<u8>, LoadError> {
        let decoded = match self.mode {
            Mode::Attributes => attributes::decode(bytes, self.count, self.stride),
            Mode::Triangles => indices::triangles(bytes, self.count).map(|i| self.narrow(&i)),
            Mode::Indices => indices::sequence(bytes, self.count).map(|i| self.narrow(&i)),
        };
        let mut decoded = decoded.map_err(|problem| {
            self.item.fault(format!(
                "its data is malformed ({problem}); export or copy the file again"
            ))
        })?;
        self.filter.apply(&mut decoded, self.stride);
        Ok(decoded)
    }

    /// Indices in the width that the view asks for; 16 bits wrap around.
    fn narrow(&self, indices: &[u32]) -> Vec<u8> {
        let bytes = indices.iter().map(|index| index.to_le_bytes());
        bytes
            .flat_map(|bytes| bytes.into_iter().take(self.stride))
            .collect()
    }
}
