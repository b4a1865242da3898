//! The bytes that a scene is made of, each file read and hashed once.

use std::collections::HashMap;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::error::LoadError;
use super::json::{Item, shorten};
use super::uri::{self, Target};

/// Reads external files and keeps the hash over everything read.
#[derive(Debug)]
pub(super) struct Files {
    hasher: blake3::Hasher,
    read: HashMap<PathBuf, Arc<Vec<u8>>>,
    bytes: u64,
}

impl Files {
    /// A reader that has already read the scene file itself.
    pub fn new(scene_file: &[u8]) -> Self {
        let mut hasher = blake3::Hasher::new();
        hasher.update(scene_file);
        Self {
            hasher,
            read: HashMap::new(),
            bytes: scene_file.len() as u64,
        }
    }

    /// The bytes behind the `uri` of `item`.
    pub fn load(&mut self, item: &Item, uri: &str) -> Result<Arc<Vec<u8>>, LoadError> {
        let path = match uri::resolve(item, uri)? {
            Target::Data(bytes) => return Ok(Arc::new(bytes)),
            Target::File(path) => path,
        };
        if let Some(bytes) = self.read.get(&path) {
            return Ok(Arc::clone(bytes));
        }
        let bytes = fs::read(&path).map_err(|source| LoadError::Read {
            path: item.file().to_owned(),
            object: format!("{} (file {:?})", item.label(), shorten(uri)),
            source,
        })?;
        self.hasher.update(&bytes);
        self.bytes += bytes.len() as u64;
        let bytes = Arc::new(bytes);
        self.read.insert(path, Arc::clone(&bytes));
        Ok(bytes)
    }

    /// Bytes read from all files so far.
    pub fn total_bytes(&self) -> u64 {
        self.bytes
    }

    /// BLAKE3 over all files, in the order of their first use.
    pub fn hash(&self) -> [u8; 32] {
        *self.hasher.finalize().as_bytes()
    }
}

/// Read the scene file itself.
pub(super) fn read_scene(path: &Path) -> Result<Vec<u8>, LoadError> {
    let read_error = |source: io::Error| LoadError::Read {
        path: path.to_owned(),
        object: "the file".to_owned(),
        source,
    };
    if path.is_dir() {
        return Err(read_error(io::Error::new(
            io::ErrorKind::IsADirectory,
            "it is a folder; name the .gltf or .glb file in it",
        )));
    }
    fs::read(path).map_err(read_error)
}
