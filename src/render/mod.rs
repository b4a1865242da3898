//! From a scene to a picture: preparation, upload, the progressive loop, the film.
//!
//! [`Prepared`] -> [`GpuScene`] -> [`Renderer`] -> [`Film`].

mod alias;
mod attach;
mod band;
mod cdf;
mod emission;
mod environment;
mod error;
mod film;
mod flatten;
mod frame;
mod gpu_scene;
pub mod layout;
mod lights;
mod list_wgsl;
mod materials;
mod paged;
mod prepared;
pub mod program;
mod renderer;
mod settings;
pub mod shader_check;
mod sharing;
mod textures;
mod vertex_format;

pub use alias::{AliasEntry, alias_table};
pub use environment::EnvironmentTable;
pub use error::RenderError;
pub use film::Film;
pub use gpu_scene::GpuScene;
pub use paged::large_arrays_wgsl;
pub use prepared::Prepared;
pub use renderer::{Progress, Renderer};
pub use settings::Settings;
pub use sharing::{SharedTree, Sharing};
