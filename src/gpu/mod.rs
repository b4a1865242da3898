//! A compute-only Vulkan device with storage buffers: all of ash, and all `unsafe` of the crate.
//!
//! ```no_run
//! # fn main() -> Result<(), etendue::gpu::GpuError> {
//! # let spirv: Vec<u32> = Vec::new();
//! use etendue::gpu::{BindingKind, Device};
//! let device = Device::open(None)?;
//! let numbers = device.buffer("numbers", 4096)?;
//! let bindings = [(0, BindingKind::Storage)];
//! let pipeline = device.pipeline("double", &spirv, "main", &bindings, [64, 1, 1])?;
//! let group = device.bind(&pipeline, &[(0, &numbers, None)])?;
//! let timing = device.dispatch(&pipeline, &group, [16, 1, 1])?;
//! let result: Vec<f32> = device.read(&numbers, 0, 1024)?;
//! # Ok(()) }
//! ```
//!
//! Every call waits until the device has finished, so the host never races with it. All handles keep
//! the device alive and may be dropped in any order. A [`Device`] may be shared by threads: they take turns.

// Vulkan is a C API: each call through ash is unsafe. This layer is the only one that may make them.
#![allow(unsafe_code)]

mod bind;
mod capacity;
mod device;
mod error;
mod info;
mod instance;
mod llvmpipe;
mod logical;
mod memory;
mod options;
mod pipeline;
mod probe;
mod queue;
mod select;
mod texel_buffers;
mod transfer;
mod validation;

pub use bind::{BindGroup, Bound};
pub use device::{Device, FoundDevice};
pub use error::GpuError;
pub use info::{DeviceInfo, DeviceKind};
pub use instance::devices;
pub use llvmpipe::compiles_quickly;
pub(crate) use llvmpipe::{prefer_widest_vectors, set_optimization, threads};
pub use memory::Buffer;
pub use options::OpenOptions;
pub use pipeline::{BindingKind, Pipeline};
pub use probe::Probe;
pub use probe::loads::Loads;
pub use queue::Timing;
pub use validation::ValidationLog;
