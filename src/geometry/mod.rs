//! Rays, boxes and triangles in f32, with their rounding errors accounted for.
//!
//! What runs on the device too (the triangle test, the box test) is written so that the WGSL under
//! `shaders/geometry` and `shaders/accel` does the same operations in the same order: on a device
//! whose f32 arithmetic is IEEE's the two agree bit for bit.
//!
//! `u` below and in the other files is the unit round-off of f32, 2⁻²⁴.

pub mod aabb;
pub mod exact;
pub mod ray;
pub mod t_bounds;
pub mod triangle;

pub use aabb::Aabb;
pub use ray::Ray;
pub use triangle::{RaySetup, TriangleHit};
