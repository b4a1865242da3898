//! Buffers and buffer views: every range is checked against the bytes that are really there.

use std::ops::Range;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use rayon::prelude::*;

use super::error::LoadError;
use super::files::Files;
use super::json::{Item, counted};
use super::meshopt::{self, Compressed};

/// The file's binary data.
#[derive(Debug)]
pub(super) struct Data<'a> {
    file: PathBuf,
    buffers: Vec<Buffer<'a>>,
    views: Vec<View>,
    budget: AtomicU64,
    pixels: AtomicU64,
    bytes: u64,
}

#[derive(Debug)]
struct Buffer<'a> {
    label: String,
    length: usize,
    bytes: Bytes<'a>,
}

#[derive(Debug)]
enum Bytes<'a> {
    Chunk(&'a [u8]),
    File(Arc<Vec<u8>>),
    Absent,
}

/// A range of a buffer.
#[derive(Debug)]
pub(super) struct View {
    /// Index and name, for messages.
    pub label: String,
    buffer: usize,
    range: Range<usize>,
    /// Bytes from one element to the next, if the file says.
    pub stride: Option<usize>,
    /// The view's bytes, if they are compressed in the file; the range then means nothing but its length.
    decoded: Option<Vec<u8>>,
}

impl View {
    /// Its length in bytes.
    pub fn len(&self) -> usize {
        self.range.len()
    }
}

/// Memory that decoded attributes may take beyond [`EXPANSION`] times the bytes read.
const BASE_BUDGET: u64 = 1 << 30;
/// How many times the bytes read decoded attributes may take: many primitives may share one
/// accessor, but a small file must not ask for all memory.
const EXPANSION: u64 = 64;
/// Pixels that all images together may have beyond [`EXPANSION`] times the bytes read.
const BASE_PIXELS: u64 = 1 << 30;
/// Elements that an accessor without data may have in a small file.
const SMALLEST_ZERO_LIMIT: u64 = 1 << 16;

impl<'a> Data<'a> {
    /// Read all buffers of the file; `chunk` is the binary chunk of a .glb.
    pub fn load(
        root: &Item<'a>,
        files: &mut Files,
        chunk: Option<&'a [u8]>,
    ) -> Result<Self, LoadError> {
        let items = root.items("buffers", "buffer")?;
        let views = root.items("bufferViews", "buffer view")?;
        let needed = needed(&views, items.len())?;
        let buffers: Vec<Buffer> = items
            .iter()
            .enumerate()
            .map(|(index, item)| {
                let chunk = chunk.filter(|_| index == 0);
                load_buffer(item, files, chunk, needed[index])
            })
            .collect::<Result<_, _>>()?;
        let views = views.iter().map(|item| read_view(item, &buffers));
        let views = views.collect::<Result<_, _>>()?;
        let mut data = Self {
            file: root.file().to_owned(),
            views,
            budget: AtomicU64::new(BASE_BUDGET + EXPANSION * files.total_bytes()),
            pixels: AtomicU64::new(BASE_PIXELS + EXPANSION * files.total_bytes()),
            bytes: files.total_bytes(),
            buffers,
        };
        data.decode_views(root)?;
        Ok(data)
    }

    /// Decode the compressed views.
    fn decode_views(&mut self, root: &Item) -> Result<(), LoadError> {
        let items = root.items("bufferViews", "buffer view")?;
        let lengths: Vec<usize> = self.buffers.iter().map(|buffer| buffer.length).collect();
        let mut compressed = Vec::new();
        for (index, item) in items.iter().enumerate() {
            let found = meshopt::read(item, self.views[index].len(), &lengths)?;
            compressed.extend(found.map(|view| (index, view)));
        }
        // Collect first: the error of the first view wins, whatever thread finds it.
        let decoded: Vec<_> = compressed
            .par_iter()
            .map(|(_, view)| self.decode_view(view))
            .collect();
        for ((index, _), decoded) in compressed.iter().zip(decoded) {
            self.views[*index].decoded = Some(decoded?);
        }
        Ok(())
    }

    fn decode_view(&self, view: &Compressed) -> Result<Vec<u8>, LoadError> {
        if !self.charge(view.decoded_len() as u64) {
            return Err(view
                .item
                .fault("there is no memory left for what it decodes to"));
        }
        let bytes = self.buffer(view.buffer, view.item.label())?;
        view.decode(&bytes[view.range.clone()])
    }

    /// All buffer views.
    pub fn views(&self) -> &[View] {
        &self.views
    }

    /// The bytes of a view.
    pub fn view(&self, index: usize) -> Result<&[u8], LoadError> {
        let view = &self.views[index];
        match &view.decoded {
            Some(bytes) => Ok(bytes),
            None => Ok(&self.buffer(view.buffer, &view.label)?[view.range.clone()]),
        }
    }

    /// The bytes of a buffer, at least as many as its length says, for the object called `user`.
    fn buffer(&self, index: usize, user: &str) -> Result<&[u8], LoadError> {
        let buffer = &self.buffers[index];
        match &buffer.bytes {
            Bytes::Chunk(bytes) => Ok(bytes),
            Bytes::File(bytes) => Ok(bytes),
            Bytes::Absent => Err(LoadError::Invalid {
                path: self.file.clone(),
                object: user.to_owned(),
                problem: format!(
                    "it needs {}, which has neither a URI nor a binary chunk",
                    buffer.label
                ),
            }),
        }
    }

    /// Largest number of elements that an accessor without data may have.
    pub fn zero_limit(&self) -> u64 {
        self.bytes.max(SMALLEST_ZERO_LIMIT)
    }

    /// Take `bytes` from what decoded attributes may use; false if nothing is left.
    pub fn charge(&self, bytes: u64) -> bool {
        take(&self.budget, bytes)
    }

    /// Bytes that decoded attributes may still use.
    pub fn budget_left(&self) -> u64 {
        self.budget.load(Ordering::Relaxed)
    }

    /// Take `pixels` from what images may use; false if nothing is left.
    pub fn charge_pixels(&self, pixels: u64) -> bool {
        take(&self.pixels, pixels)
    }
}

fn take(budget: &AtomicU64, amount: u64) -> bool {
    let rest = |left: u64| left.checked_sub(amount);
    budget
        .fetch_update(Ordering::Relaxed, Ordering::Relaxed, rest)
        .is_ok()
}

/// Which buffers are read. Those to which nothing but compressed views refers are copies for programs that cannot
/// decode: they need not be there.
fn needed(views: &[Item], buffers: usize) -> Result<Vec<bool>, LoadError> {
    let mut copy = vec![false; buffers];
    let mut needed = vec![false; buffers];
    for item in views {
        let own = item.index("buffer", "buffer", buffers)?;
        let extension = meshopt::extension(item)?;
        let compressed = match &extension {
            Some(extension) => extension.index("buffer", "buffer", buffers)?,
            None => None,
        };
        if let Some(buffer) = own {
            match extension {
                Some(_) => copy[buffer] = true,
                None => needed[buffer] = true,
            }
        }
        if let Some(buffer) = compressed {
            needed[buffer] = true;
        }
    }
    let both = needed.iter().zip(&copy);
    Ok(both.map(|(&needed, &copy)| needed || !copy).collect())
}

fn load_buffer<'a>(
    item: &Item<'a>,
    files: &mut Files,
    chunk: Option<&'a [u8]>,
    needed: bool,
) -> Result<Buffer<'a>, LoadError> {
    let length = item.required_count("byteLength")?;
    let bytes = match (item.text("uri")?, chunk) {
        _ if !needed => Bytes::Absent,
        (Some(uri), _) => Bytes::File(files.load(item, uri)?),
        (None, Some(chunk)) => Bytes::Chunk(chunk),
        (None, None) => Bytes::Absent,
    };
    let available = match &bytes {
        Bytes::Chunk(bytes) => bytes.len(),
        Bytes::File(bytes) => bytes.len(),
        Bytes::Absent => length,
    };
    if available < length {
        return Err(item.fault(format!(
            "`byteLength` promises {}, but there are only {available}; export or copy the file again",
            counted(length, "byte")
        )));
    }
    Ok(Buffer {
        label: item.label().to_owned(),
        length,
        bytes,
    })
}

fn read_view(item: &Item, buffers: &[Buffer]) -> Result<View, LoadError> {
    let buffer = item
        .index("buffer", "buffer", buffers.len())?
        .ok_or_else(|| item.fault("`buffer` is missing"))?;
    let start = item.count("byteOffset")?.unwrap_or(0);
    let length = item.required_count("byteLength")?;
    let end = start.checked_add(length);
    let end = end.filter(|&end| end <= buffers[buffer].length);
    let end = end.ok_or_else(|| {
        item.fault(format!(
            "{length} bytes from byte {start} on do not fit in {}, which has {}",
            buffers[buffer].label, buffers[buffer].length
        ))
    })?;
    Ok(View {
        label: item.label().to_owned(),
        buffer,
        range: start..end,
        stride: item.count("byteStride")?.filter(|&stride| stride > 0),
        decoded: None,
    })
}
