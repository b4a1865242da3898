//! From a scene to a picture: preparation, upload, the progressive loop, the film.
//!
//! [`Prepared`] -> [`GpuScene`] -> [`Renderer`] -> [`Film`].

mod albedo;
mod alias;
mod array_wgsl;
mod attach;
mod band;
mod cdf;
mod emission;
mod environment;
mod error;
mod film;
mod flatten;
mod focus;
mod frame;
mod gpu_scene;
mod guide;
mod hull;
pub mod layout;
mod light_selection;
mod light_tree;
mod lights;
mod list_wgsl;
mod material_fields;
mod materials;
mod media;
mod microfacets;
mod pace;
mod paged;
mod plain_fields;
mod prepared;
pub mod program;
mod reading;
mod renderer;
mod settings;
pub mod shader_check;
mod sharing;
mod short_tables;
mod solids;
mod spectrum;
mod stage;
mod stretched;
mod textures;
mod vertex_format;
mod wgsl_structs;

pub use albedo::BsdfTables;
pub use alias::{AliasEntry, alias_table};
pub use environment::EnvironmentTable;
pub use error::RenderError;
pub use film::Film;
pub use focus::distance_at;
pub use gpu_scene::GpuScene;
pub use guide::{
    Effort, Guidance, GuideTable, Guiding, Lesson, LightSamples, Roulette, Training, train,
};
pub use light_selection::LightSelection;
pub use light_tree::{Cone, LightBounds, LightTree};
pub use lights::Lights;
pub use pace::Progress;
pub use prepared::Prepared;
pub use reading::{Reading, large_arrays_wgsl};
pub use renderer::Renderer;
pub use settings::Settings;
pub use sharing::{SharedTree, Sharing};
pub use short_tables::{long_tables, table_files};
pub use stage::Stage;
