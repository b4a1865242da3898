//! What all layers ask of the machine they run on: a place to keep results between runs, a
//! stopwatch, and a net under code that may panic; and of its user: choices by name.

pub mod cache;
pub mod guard;
pub mod names;
pub mod stages;

pub use cache::Cache;
