//! What all layers ask of the machine they run on: a place to keep results between runs, and a stopwatch.

pub mod cache;
pub mod stages;

pub use cache::Cache;
