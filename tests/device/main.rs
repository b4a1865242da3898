//! Pieces of the shader library by themselves on a device.

#[path = "../accel_common/mod.rs"]
mod accel_common;
mod bsdf;
mod common;
mod counts;
mod environment;
mod guide;
mod instances;
mod light_tree;
mod lights;
mod math;
mod samplers;
mod sampling;
mod tables;
mod textures;
mod traversal;
mod validation;
