//! A picture file's bytes.

use std::fs::{self, File};
use std::io::Read;
use std::path::Path;

use super::ImageError;

/// Reads a regular file whole. A pipe or a device, which need not end, is refused.
pub(super) fn read(path: &Path) -> Result<Vec<u8>, ImageError> {
    let metadata = fs::metadata(path).map_err(|e| ImageError::io(path, "open", e))?;
    if !metadata.is_file() {
        return Err(ImageError::NotAFile {
            path: path.to_owned(),
        });
    }
    let mut bytes = Vec::new();
    File::open(path)
        .map_err(|e| ImageError::io(path, "open", e))?
        // A file that grows while it is read ends where it ended at first.
        .take(metadata.len())
        .read_to_end(&mut bytes)
        .map_err(|e| ImageError::io(path, "read", e))?;
    Ok(bytes)
}
