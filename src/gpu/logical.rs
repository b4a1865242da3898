//! The logical device, and the account of its memory.

use std::sync::OnceLock;
use std::sync::atomic::{AtomicU64, Ordering};

use ash::vk;

use super::error::GpuError;
use super::info::{DeviceInfo, DeviceKind, has_device_extension};
use super::instance::{Candidate, Instance};
use super::probe::Probe;

/// A logical device with one queue. Everything made from it holds it by `Arc`, so it is destroyed last.
pub(super) struct Logical {
    pub raw: ash::Device,
    pub info: DeviceInfo,
    pub queue_family: u32,
    pub memory: vk::PhysicalDeviceMemoryProperties,
    /// Whether buffers are mapped: the device's memory is the host's, and nobody asked for staging.
    pub mapped: bool,
    pub probe: OnceLock<Probe>,
    in_use: AtomicU64,
    peak: AtomicU64,
    // Dropped after the device, which `drop` destroys.
    pub instance: Instance,
}

impl Logical {
    /// Creates the device with 64-bit integers and floats where it has them, and no other feature.
    pub fn new(instance: Instance, candidate: Candidate, staging: bool) -> Result<Self, GpuError> {
        let Candidate {
            physical,
            queue_family,
            info,
        } = candidate;
        let raw = create(&instance.raw, physical, queue_family, &info)?;
        // SAFETY: `physical` comes from `instance`.
        let memory = unsafe { instance.raw.get_physical_device_memory_properties(physical) };
        let shared = matches!(info.kind, DeviceKind::Cpu | DeviceKind::Integrated);
        let mapped = shared && !staging;
        Ok(Self {
            raw,
            info,
            queue_family,
            memory,
            mapped,
            probe: OnceLock::new(),
            in_use: AtomicU64::new(0),
            peak: AtomicU64::new(0),
            instance,
        })
    }

    /// Bytes of device memory that buffers hold now.
    pub fn in_use(&self) -> u64 {
        self.in_use.load(Ordering::Relaxed)
    }

    /// The largest value that [`Self::in_use`] has had.
    pub fn peak(&self) -> u64 {
        self.peak.load(Ordering::Relaxed)
    }

    pub fn add_use(&self, bytes: u64) {
        let now = self.in_use.fetch_add(bytes, Ordering::Relaxed) + bytes;
        self.peak.fetch_max(now, Ordering::Relaxed);
    }

    pub fn remove_use(&self, bytes: u64) {
        self.in_use.fetch_sub(bytes, Ordering::Relaxed);
    }
}

impl Drop for Logical {
    fn drop(&mut self) {
        // SAFETY: all objects made from the device held it by `Arc` and are gone; waiting may fail on a
        // lost device, which may be destroyed all the same.
        unsafe {
            let _ = self.raw.device_wait_idle();
            self.raw.destroy_device(None);
        }
    }
}

fn create(
    instance: &ash::Instance,
    physical: vk::PhysicalDevice,
    queue_family: u32,
    info: &DeviceInfo,
) -> Result<ash::Device, GpuError> {
    let queue = vk::DeviceQueueCreateInfo::default()
        .queue_family_index(queue_family)
        .queue_priorities(&[1.0]);
    let features = vk::PhysicalDeviceFeatures::default()
        .shader_int64(info.int64)
        .shader_float64(info.float64)
        .shader_storage_image_extended_formats(info.max_texel_buffers > 0);
    // The specification asks that this extension be enabled wherever it is present.
    let subset = ash::khr::portability_subset::NAME;
    let mut extensions = Vec::new();
    if has_device_extension(instance, physical, subset)? {
        extensions.push(subset.as_ptr());
    }
    let queues = [queue];
    let info = vk::DeviceCreateInfo::default()
        .queue_create_infos(&queues)
        .enabled_extension_names(&extensions)
        .enabled_features(&features);
    // SAFETY: `physical` comes from `instance`, the family is one of its own, the features and extensions are
    // ones that it has, and the pointers reach locals that live until the call returns.
    unsafe { instance.create_device(physical, &info, None) }
        .map_err(|e| GpuError::vulkan("create the device", e))
}
