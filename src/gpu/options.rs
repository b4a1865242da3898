//! How a device is opened.

/// How to open a device.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct OpenOptions {
    /// Whether the Khronos validation layer checks every call (slow).
    pub validation: bool,
    /// Whether data goes through a staging buffer even where the device shares the host's memory: for tests of
    /// the way that discrete GPUs need, on a machine without one.
    pub staging: bool,
}

impl OpenOptions {
    /// Validation if the environment variable `ETENDUE_VALIDATION` is neither empty nor "0".
    pub fn from_env() -> Self {
        let value = std::env::var_os("ETENDUE_VALIDATION");
        let validation = value.is_some_and(|value| !value.is_empty() && value != "0");
        Self {
            validation,
            staging: false,
        }
    }
}
