//! The built program, as people and scripts run it.

mod common;
mod errors;
mod info;
mod interrupt;
mod lights;
mod render;
mod report;
mod shaders;
mod startup;
