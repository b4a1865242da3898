//! What all layers ask of the machine they run on: a place to keep results between runs,
//! a stopwatch, and that a panic stays where it happens.

pub mod cache;
pub mod panics;
pub mod stages;

pub use cache::Cache;
