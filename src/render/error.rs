//! What can go wrong between a scene and its picture.

use crate::gpu::GpuError;
use crate::shader::ShaderError;

/// An error of the render layer.
#[derive(Debug, thiserror::Error)]
pub enum RenderError {
    /// The device failed or lacks memory.
    #[error(transparent)]
    Gpu(#[from] GpuError),
    /// A shader does not compile.
    #[error(transparent)]
    Shader(#[from] ShaderError),
    /// A name that no file of the shader library has.
    #[error("no {kind} is named \"{name}\": {folder} has {known}")]
    Unknown {
        /// "integrator" or "sampler".
        kind: &'static str,
        /// What was asked for.
        name: String,
        /// The folder that was searched.
        folder: String,
        /// The names that exist.
        known: String,
    },
    /// A setting outside of its range.
    #[error("{0}")]
    Setting(String),
    /// The scene has more of something than indices can count.
    #[error(
        "the scene has {count} {what}, but at most {limit} can be rendered: simplify the scene"
    )]
    TooMany {
        /// What there are too many of.
        what: &'static str,
        /// How many there are.
        count: u64,
        /// How many there may be.
        limit: u64,
    },
    /// The shader uses 64-bit integers.
    #[error("the shader uses 64-bit integers (u64 or i64), which {device} does not have")]
    NoInt64 {
        /// The device's name.
        device: String,
    },
    /// One path needs more loop iterations than the driver allows.
    #[error(
        "a path needs more than {limit} loop iterations, at which {driver} silently ends loops: \
         lower --max-depth or use a newer driver (Mesa 25 or later has no such limit)"
    )]
    LoopLimit {
        /// Iterations that the driver allows.
        limit: u32,
        /// The driver.
        driver: String,
    },
}
