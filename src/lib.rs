//! Étendue: a headless, physically based path tracer for any Vulkan device.
//!
//! The layers import only downwards: [`host`], [`geometry`], [`accel`], [`scene`],
//! [`shader`], [`gpu`], [`image`], [`render`], [`study`], [`cli`].
//! `ARCHITECTURE.md` describes what each one owns.

pub mod accel;
pub mod cli;
pub mod geometry;
pub mod gpu;
pub mod host;
pub mod image;
pub mod render;
pub mod scene;
pub mod shader;
pub mod study;
