//! The scene: plain data, independent of the file it came from and of any device.
//!
//! The folder `gltf` is the only place that knows glTF. The file `features` says what a scene requires of the shader.

mod bounds;
pub mod camera;
pub mod environment;
mod feature_bytes;
pub mod features;
pub mod gltf;
pub mod light;
pub mod material;
pub mod mesh;
pub mod selector;
pub mod summary;
pub mod texture;
mod validate;

pub use camera::{Camera, Lens, Projection};
pub use environment::{Environment, EnvironmentImage};
pub use features::{FeatureReason, Features};
pub use light::{LightKind, PunctualLight};
pub use material::{AlphaMode, Material, TextureSlot};
pub use mesh::{Instance, Mesh};
pub use selector::{SelectError, Selector};
pub use summary::Summary;
pub use texture::{Filter, Image, Sampler, Texels, Texture, Wrap};
pub use validate::SceneError;

use std::path::PathBuf;

/// Everything that a picture depends on but the camera choice, the settings and the shader.
///
/// Every index in it is valid and every number finite once [`Scene::validate`] has passed:
/// release kernels run without bounds checks and rely on it.
#[derive(Debug, Clone, Default)]
pub struct Scene {
    /// The file that the scene was read from.
    pub source: PathBuf,
    /// BLAKE3 over all bytes read: the file itself, then every external file in the order of its use.
    pub hash: [u8; 32],
    /// Names of the scenes in the file, in the order of the file (empty string if unnamed).
    pub scene_names: Vec<String>,
    /// Which of them this is.
    pub scene_index: usize,
    /// Names of the animations in the file, in the order of the file (empty string if unnamed).
    pub animation_names: Vec<String>,
    /// The animation that poses the nodes, if one was asked for.
    pub animation: Option<PlayedAnimation>,
    /// Cameras that the scene's nodes place, in the order of the node walk; never empty after
    /// loading, since a camera that frames the scene is added where the file has none.
    pub cameras: Vec<Camera>,
    /// Triangle meshes in their own space, one a glTF primitive.
    pub meshes: Vec<Mesh>,
    /// Placements of meshes in the world.
    pub instances: Vec<Instance>,
    /// Materials; index 0.. as in the file, then the default material if a mesh needs it.
    pub materials: Vec<Material>,
    /// Textures: an image with a sampler.
    pub textures: Vec<Texture>,
    /// Decoded images.
    pub images: Vec<Image>,
    /// Punctual lights, placed in the world.
    pub lights: Vec<PunctualLight>,
    /// Light from infinitely far away.
    pub environment: Option<Environment>,
    /// Names of features that the shader shall have, needed or not, for comparison ([`Features::names`]).
    pub required_features: Vec<String>,
    /// Names of the variants of materials that the file has.
    pub variant_names: Vec<String>,
    /// Extensions that the file names.
    pub extensions: Vec<ExtensionUse>,
    /// Sentences about what was skipped or assumed, each naming its object.
    pub warnings: Vec<String>,
    /// Sentences about choices that need no action, as the camera of a file without one.
    pub notes: Vec<String>,
}

/// A moment of an animation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlayedAnimation {
    /// Index into [`Scene::animation_names`].
    pub index: usize,
    /// Seconds from the animation's beginning.
    pub seconds: f64,
}

/// An extension that a file lists.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ExtensionUse {
    /// Its name, as in `KHR_lights_punctual`.
    pub name: String,
    /// Whether the file lists it in `extensionsRequired`.
    pub required: bool,
    /// Whether étendue renders what it says.
    pub supported: bool,
}
