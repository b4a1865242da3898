//! The two forms of a glTF file: JSON text, and the binary container (.glb).
//!
//! glTF 2.0 specification, section 4 "GLB File Format Specification".

use std::ops::Range;
use std::path::Path;

use serde_json::Value;

use super::error::LoadError;

const MAGIC: &[u8; 4] = b"glTF";
const JSON_CHUNK: u32 = 0x4E4F_534A;
const BIN_CHUNK: u32 = 0x004E_4942;
const HEADER: usize = 12;
const CHUNK_HEADER: usize = 8;

/// The parts of a file, as ranges of its bytes: nothing is copied.
#[derive(Debug)]
pub(super) struct Container {
    /// The JSON text.
    pub json: Range<usize>,
    /// The binary chunk that buffer 0 may refer to.
    pub binary: Option<Range<usize>>,
}

/// Find the parts of a file; its first bytes decide which form it has.
pub(super) fn split(path: &Path, bytes: &[u8]) -> Result<Container, LoadError> {
    if bytes.starts_with(MAGIC) {
        return split_binary(bytes).map_err(|problem| LoadError::Container {
            path: path.to_owned(),
            problem,
        });
    }
    const BYTE_ORDER_MARK: &[u8] = b"\xEF\xBB\xBF";
    let start = match bytes.starts_with(BYTE_ORDER_MARK) {
        true => BYTE_ORDER_MARK.len(),
        false => 0,
    };
    let first = bytes[start..]
        .iter()
        .find(|byte| !byte.is_ascii_whitespace());
    if first != Some(&b'{') {
        return Err(LoadError::Container {
            path: path.to_owned(),
            problem: "not a glTF file: expected JSON text that begins with `{`, or a binary \
                      container that begins with `glTF`"
                .to_owned(),
        });
    }
    Ok(Container {
        json: start..bytes.len(),
        binary: None,
    })
}

fn split_binary(bytes: &[u8]) -> Result<Container, String> {
    let (Some(version), Some(length)) = (word(bytes, 4), word(bytes, 8)) else {
        return Err("the GLB header is cut off; export or copy the file again".to_owned());
    };
    if version != 2 {
        return Err(format!(
            "the GLB container has version {version}, expected 2"
        ));
    }
    let length = length as usize;
    if length > bytes.len() || length < HEADER {
        return Err(format!(
            "the GLB header promises {length} bytes, but the file has {}; export or copy it again",
            bytes.len()
        ));
    }
    let json = chunk(&bytes[..length], HEADER, 0)?;
    let Some((JSON_CHUNK, json)) = json else {
        return Err("the first GLB chunk must be JSON".to_owned());
    };
    let binary = chunk(&bytes[..length], padded(json.end), 1)?;
    let binary = binary.and_then(|(kind, range)| (kind == BIN_CHUNK).then_some(range));
    Ok(Container { json, binary })
}

/// Kind and content of the chunk whose header begins at `at`; none at the end of the file.
fn chunk(bytes: &[u8], at: usize, number: usize) -> Result<Option<(u32, Range<usize>)>, String> {
    let (Some(length), Some(kind)) = (word(bytes, at), word(bytes, at + 4)) else {
        return Ok(None);
    };
    let start = at + CHUNK_HEADER;
    let left = bytes.len() - start;
    if length as usize > left {
        return Err(format!(
            "GLB chunk {number} promises {length} bytes, but {left} are left; export or copy the file again"
        ));
    }
    Ok(Some((kind, start..start + length as usize)))
}

/// Chunks begin at multiples of 4.
fn padded(at: usize) -> usize {
    at.next_multiple_of(4)
}

fn word(bytes: &[u8], at: usize) -> Option<u32> {
    let word = bytes.get(at..at.checked_add(4)?)?;
    word.try_into().ok().map(u32::from_le_bytes)
}

/// Parse the JSON text.
pub(super) fn parse(path: &Path, json: &[u8]) -> Result<Value, LoadError> {
    // Some exporters pad the chunk with zeros instead of spaces.
    let end = json
        .iter()
        .rposition(|&byte| byte != 0)
        .map_or(0, |at| at + 1);
    serde_json::from_slice(&json[..end]).map_err(|source| LoadError::Json {
        path: path.to_owned(),
        source,
    })
}
