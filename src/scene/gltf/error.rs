//! What can go wrong while a glTF file is loaded.

use std::io;
use std::path::PathBuf;

use thiserror::Error;

use crate::scene::selector::SelectError;

/// Why a file was refused: one sentence that names the file and the object in it.
#[derive(Debug, Error)]
pub enum LoadError {
    /// The file, or a file that it refers to, cannot be read.
    #[error("{}: cannot read {object}: {source}", path.display())]
    Read {
        /// The scene file.
        path: PathBuf,
        /// What was read, as in `buffer 0 (file "a.bin")`.
        object: String,
        /// The system's reason.
        source: io::Error,
    },
    /// The file is no glTF file, or its binary container is damaged.
    #[error("{}: {problem}", path.display())]
    Container {
        /// The scene file.
        path: PathBuf,
        /// What was expected.
        problem: String,
    },
    /// The file's JSON cannot be parsed.
    #[error("{}: the JSON is malformed: {source}", path.display())]
    Json {
        /// The scene file.
        path: PathBuf,
        /// The parser's reason, with line and column.
        source: serde_json::Error,
    },
    /// An object of the file breaks glTF's rules.
    #[error("{}: {object}: {problem}", path.display())]
    Invalid {
        /// The scene file.
        path: PathBuf,
        /// Index and name of the object, as in `material 3 "glass"`.
        object: String,
        /// What was expected and what was found.
        problem: String,
    },
    /// The file requires an extension that étendue does not support.
    #[error(
        "{}: the file requires the extension {name}, which is not supported ({what}); export the scene without it",
        path.display()
    )]
    Extension {
        /// The scene file.
        path: PathBuf,
        /// Name of the extension.
        name: String,
        /// What the extension does.
        what: String,
    },
    /// A URI is refused.
    #[error("{}: {object}: the URI {uri:?} {problem}", path.display())]
    Uri {
        /// The scene file.
        path: PathBuf,
        /// Index and name of the object that holds the URI.
        object: String,
        /// The URI, shortened.
        uri: String,
        /// Why it is refused and what to do.
        problem: String,
    },
    /// An image cannot be decoded.
    #[error("{}: {object}: {problem}", path.display())]
    Image {
        /// The scene file.
        path: PathBuf,
        /// The image and the texture that needs it.
        object: String,
        /// What was expected and what was found.
        problem: String,
    },
    /// The scene that was asked for does not exist.
    #[error("{}: {source}", path.display())]
    Select {
        /// The scene file.
        path: PathBuf,
        /// What was asked for, and the choices.
        source: SelectError,
    },
}
