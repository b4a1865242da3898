//! Acceleration structures on the host.

#[path = "../accel_common/mod.rs"]
mod accel_common;
mod binary;
mod build;
mod instances;
mod traversal;
mod watertight;
