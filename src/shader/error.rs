//! What can go wrong between a shader's text and its SPIR-V.

use std::path::PathBuf;

use thiserror::Error;

use super::Diagnostic;

/// An error of the shader layer.
///
/// The variants that carry a [`Diagnostic`] display as a whole report, which begins with
/// `error: `; [`ShaderError::report`] gives the others the same beginning.
#[derive(Debug, Error)]
pub enum ShaderError {
    /// An `#include` line is malformed, or names a file that is missing or forbidden.
    #[error("{0}")]
    Include(Box<Diagnostic>),
    /// The text is not WGSL: a syntax error, an unknown identifier, most type errors.
    #[error("{0}")]
    Parse(Box<Diagnostic>),
    /// The text is WGSL, but not a valid program, or not one that étendue can run.
    #[error("{0}")]
    Validation(Box<Diagnostic>),
    /// A value for an `override` is unknown, missing or outside its type.
    #[error("{0}")]
    Override(Box<Diagnostic>),
    /// A struct differs from the one that the host writes.
    #[error("{0}")]
    Layout(Box<Diagnostic>),
    /// The shader compiler itself failed.
    #[error("{0}")]
    Backend(Box<Diagnostic>),
    /// A path that a shader library does not hold, or may not.
    #[error("shader `{path}` in {library}: {reason}")]
    Library {
        /// The path, relative to the library's root.
        path: String,
        /// The library, in words.
        library: String,
        /// What is wrong with it.
        reason: String,
    },
    /// A file could not be read or written.
    #[error("cannot {action} `{}`: {source}", path.display())]
    Io {
        /// "read", "write", ...
        action: &'static str,
        /// The file or folder.
        path: PathBuf,
        /// The system's reason.
        source: std::io::Error,
    },
}

impl ShaderError {
    /// The position, the line and the notes, where the error has them.
    pub fn diagnostic(&self) -> Option<&Diagnostic> {
        match self {
            Self::Include(d)
            | Self::Parse(d)
            | Self::Validation(d)
            | Self::Override(d)
            | Self::Layout(d)
            | Self::Backend(d) => Some(d),
            Self::Library { .. } | Self::Io { .. } => None,
        }
    }

    /// The report to print: `error: message`, then position, line and caret where there are any.
    pub fn report(&self) -> String {
        match self.diagnostic() {
            Some(diagnostic) => diagnostic.to_string(),
            None => format!("error: {self}\n"),
        }
    }
}
