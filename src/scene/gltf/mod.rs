//! Loading glTF 2.0: the only place that knows the format.
//!
//! Nothing in a file is trusted: every index, range and count is checked before it is used, and no
//! allocation is larger than a fixed multiple of the bytes that are really there.

mod accessor;
mod animation;
mod attributes;
mod buffer;
mod camera;
mod container;
mod cube;
mod draco;
mod elements;
mod error;
mod extensions;
mod files;
mod framing;
mod image;
mod image_light;
mod instancing;
mod json;
mod keyframes;
mod lenient;
mod light;
mod loader;
mod material;
mod material_extensions;
mod meshes;
mod meshopt;
mod morph;
mod node;
mod pose;
mod primitive;
mod skin;
mod tangent_faces;
mod tangents;
mod texture;
mod texture_info;
mod texture_sampler;
mod topology;
mod transform;
mod uri;
mod variants;
mod vertices;

pub use error::LoadError;
pub use extensions::SUPPORTED;

use std::path::Path;

use super::Scene;
use super::selector::Selector;
use crate::host::stages::stage;

/// What to load from a file.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct LoadOptions {
    /// Which of the file's scenes; else the file's default, else the first.
    pub scene: Option<Selector>,
    /// Which variant of the materials (KHR_materials_variants); else what the file shows without one.
    pub variant: Option<Selector>,
    /// Show a texture or a material that is wrong in the file in magenta, with a warning, instead of
    /// refusing the file.
    pub lenient: bool,
    /// Which animation poses the nodes; none, unless there is a moment: then the first one does.
    pub animation: Option<Selector>,
    /// The moment of the animation, seconds from its beginning, finite; before the first and after the last key
    /// these hold. None: 0.
    pub at: Option<f64>,
}

/// Load a scene from a .gltf or .glb file; its content decides which it is.
///
/// # Errors
/// [`LoadError`]: one sentence that names the file and the object in it.
pub fn load(path: &Path, options: &LoadOptions) -> Result<Scene, LoadError> {
    let bytes = stage("read", || files::read_scene(path))?;
    load_slice(path, &bytes, options)
}

/// Load a scene from `bytes` as if they were the content of the file `path`, which gives the
/// folder of external files and the name in messages.
///
/// # Errors
/// As [`load`].
pub fn load_slice(path: &Path, bytes: &[u8], options: &LoadOptions) -> Result<Scene, LoadError> {
    let container = container::split(path, bytes)?;
    let json = stage("parse", || container::parse(path, &bytes[container.json]))?;
    let binary = container.binary.map(|range| &bytes[range]);
    loader::load(path, bytes, &json, binary, options)
}
