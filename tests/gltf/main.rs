//! Loading glTF: well-formed files, malformed ones, real ones and mutated ones.

mod assets;
mod attributes;
mod codecs;
mod common;
mod errors_data;
mod errors_files;
mod errors_values;
mod features;
mod files;
mod fuzz;
mod geometry;
mod image_light;
mod large;
mod lenient;
mod materials;
mod mutate;
mod pictures;
mod placement;
mod seeds;
