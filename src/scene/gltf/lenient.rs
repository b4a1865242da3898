//! What is done about a texture or a material that is wrong in the file.

use super::error::LoadError;

/// Whether something loud in its place and a warning will do (`--lenient`), or it is an error.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Lenient(pub bool);

impl Lenient {
    /// What was read; or, if it is wrong and that may be, what `replace` makes, with the error's
    /// sentence as a warning.
    pub fn or_else<T>(
        self,
        result: Result<T, LoadError>,
        warnings: &mut Vec<String>,
        replace: impl FnOnce() -> T,
    ) -> Result<T, LoadError> {
        match result {
            Err(error) if self.0 => {
                warnings.push(format!("{error}; magenta is shown instead"));
                Ok(replace())
            }
            result => result,
        }
    }
}
