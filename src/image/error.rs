//! What can go wrong with a picture file.

use std::io;
use std::path::{Path, PathBuf};

/// An error of the image layer; each names the file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ImageError {
    /// The operating system refused.
    #[error("{}: cannot {action}: {source}", .path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What was tried, as an infinitive: "open", "write" …
        action: &'static str,
        /// The system's own reason.
        source: io::Error,
    },
    /// The path is a folder, a device or a pipe.
    #[error("{}: not a regular file", .path.display())]
    NotAFile {
        /// The path.
        path: PathBuf,
    },
    /// The first bytes are of no format that is read here.
    #[error("{}: neither an OpenEXR nor a Radiance HDR file", .path.display())]
    UnknownFormat {
        /// The file.
        path: PathBuf,
    },
    /// The file breaks the rules of its format.
    #[error("{}: malformed {format} file: {reason}", .path.display())]
    Malformed {
        /// The file.
        path: PathBuf,
        /// Name of the format.
        format: &'static str,
        /// Which rule.
        reason: String,
    },
    /// The file is sound, but uses what this program does not read.
    #[error("{}: {format} feature not supported: {reason}", .path.display())]
    Unsupported {
        /// The file.
        path: PathBuf,
        /// Name of the format.
        format: &'static str,
        /// Which feature.
        reason: String,
    },
    /// The header claims more than the file can hold or than this program reads.
    #[error(
        "{}: the {format} header claims {width}x{height} pixels ({bytes} bytes in memory), \
         more than the {limit} bytes that a file of this length may need",
        .path.display()
    )]
    TooLarge {
        /// The file.
        path: PathBuf,
        /// Name of the format.
        format: &'static str,
        /// Columns claimed.
        width: u64,
        /// Rows claimed.
        height: u64,
        /// Bytes that the claim would need.
        bytes: u64,
        /// Bytes that are allowed.
        limit: u64,
    },
    /// The picture to be written contradicts itself.
    #[error("{}: cannot write layer \"{layer}\", channel \"{channel}\": {reason}", .path.display())]
    InvalidPicture {
        /// The file that was to be written.
        path: PathBuf,
        /// Name of the layer, empty for the main one.
        layer: String,
        /// Name of the channel, empty where the layer as a whole is meant.
        channel: String,
        /// What is wrong.
        reason: String,
    },
    /// A metadata entry cannot be stored.
    #[error("{}: cannot write metadata \"{key}\": {reason}", .path.display())]
    InvalidMetadata {
        /// The file that was to be written.
        path: PathBuf,
        /// The entry's name.
        key: String,
        /// What is wrong.
        reason: String,
    },
    /// There is no colour where colour is needed.
    #[error("{}: no layer with channels R, G, B (or Y); the file has {found}", .path.display())]
    NoColour {
        /// The file.
        path: PathBuf,
        /// The channels that are there.
        found: String,
    },
}

impl ImageError {
    pub(super) fn io(path: &Path, action: &'static str, source: io::Error) -> Self {
        ImageError::Io {
            path: path.to_owned(),
            action,
            source,
        }
    }

    pub(super) fn malformed(path: &Path, format: &'static str, reason: impl ToString) -> Self {
        ImageError::Malformed {
            path: path.to_owned(),
            format,
            reason: reason.to_string(),
        }
    }

    pub(super) fn unsupported(path: &Path, format: &'static str, reason: impl ToString) -> Self {
        ImageError::Unsupported {
            path: path.to_owned(),
            format,
            reason: reason.to_string(),
        }
    }

    pub(super) fn picture(path: &Path, layer: &str, channel: &str, reason: &str) -> Self {
        ImageError::InvalidPicture {
            path: path.to_owned(),
            layer: layer.to_owned(),
            channel: channel.to_owned(),
            reason: reason.to_owned(),
        }
    }
}
