//! The bytes that a scene is made of, each file read and hashed once.

use std::collections::HashMap;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use rayon::prelude::*;

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
        hasher.update_rayon(scene_file);
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
        let bytes = read_whole(&path).map_err(|source| LoadError::Read {
            path: item.file().to_owned(),
            object: format!("{} (file {:?})", item.label(), shorten(uri)),
            source,
        })?;
        self.hasher.update_rayon(&bytes);
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
    read_whole(path).map_err(read_error)
}

/// Bytes of a file that a thread reads at a time.
const PIECE: usize = 8 << 20;

/// Reads a file into memory. (A map of it would save the copy, but a file that another process changes or cuts
/// off meanwhile would then be undefined behaviour.)
#[cfg(unix)]
fn read_whole(path: &Path) -> io::Result<Vec<u8>> {
    use std::os::unix::fs::FileExt;
    let file = fs::File::open(path)?;
    let about = file.metadata()?;
    if !about.is_file() || about.len() <= 2 * PIECE as u64 {
        return fs::read(path);
    }
    let length = usize::try_from(about.len()).map_err(|_| io::ErrorKind::OutOfMemory)?;
    let mut bytes = Vec::new();
    bytes.try_reserve_exact(length)?;
    bytes.resize(length, 0);
    // Most of the time goes into making the memory, not into copying: several threads do both.
    let pieces = bytes.par_chunks_mut(PIECE).enumerate();
    pieces.try_for_each(|(piece, bytes)| file.read_exact_at(bytes, (piece * PIECE) as u64))?;
    Ok(bytes)
}

#[cfg(not(unix))]
fn read_whole(path: &Path) -> io::Result<Vec<u8>> {
    fs::read(path)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn large_files_are_read_as_small_ones_are() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("file");
        for length in [
            0,
            1,
            2 * PIECE,
            2 * PIECE + 1,
            3 * PIECE,
            3 * PIECE + 12_345,
        ] {
            let content: Vec<u8> = (0..length).map(|i| (i * 7 + i / 251) as u8).collect();
            fs::write(&path, &content).expect("written");
            assert!(
                read_whole(&path).expect("read") == content,
                "{length} bytes"
            );
        }
        assert!(read_whole(&folder.path().join("none")).is_err());
    }
}
