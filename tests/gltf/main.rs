//! Loading glTF: well-formed files, malformed ones, real ones and mutated ones.

mod animation;
mod assets;
mod attributes;
mod codecs;
mod common;
mod draco;
mod errors_data;
mod errors_files;
mod errors_values;
mod features;
mod files;
mod fuzz;
mod geometry;
mod image_light;
mod instancing;
mod large;
mod lenient;
mod materials;
mod meshopt_codec;
mod meshopt_data;
mod morph;
mod mutate;
mod pictures;
mod placement;
mod seeds;
mod skin;
