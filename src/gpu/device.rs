//! The device: what the layers above see of Vulkan.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use ash::vk;
use bytemuck::Pod;

use super::bind::{BindGroup, Bound};
use super::error::{GpuError, check_limit};
use super::info::DeviceInfo;
use super::instance::{Candidate, Instance};
use super::logical::Logical;
use super::memory::{Buffer, Purpose, RawBuffer};
use super::options::OpenOptions;
use super::pipeline::{BindingKind, Pipeline};
use super::probe::loads::Loads;
use super::probe::{self, Probe};
use super::queue::{Queue, Timing};
use super::select::select;
use super::transfer;
use super::validation::ValidationLog;
use crate::host::Cache;
use crate::host::stages::stage;

/// An open device. Clones are the same device; threads that share it take turns.
#[derive(Clone)]
pub struct Device {
    logical: Arc<Logical>,
    queue: Arc<Mutex<Queue>>,
}

/// A device that was chosen and is not open yet.
pub struct FoundDevice {
    instance: Instance,
    candidate: Candidate,
    options: OpenOptions,
}

impl FoundDevice {
    /// Chooses the device that `selector` means, as [`Device::open`] does.
    ///
    /// # Errors
    /// As [`Device::open`].
    pub fn find(selector: Option<&str>, options: OpenOptions) -> Result<Self, GpuError> {
        let instance = stage("instance", || Instance::new(options.validation))?;
        let mut candidates = stage("devices", || instance.candidates())?;
        let infos: Vec<_> = candidates.iter().map(|found| &found.info).collect();
        let chosen = select(&infos, selector)?;
        Ok(Self {
            instance,
            candidate: candidates.swap_remove(chosen),
            options,
        })
    }

    /// Name, driver and limits.
    pub fn info(&self) -> &DeviceInfo {
        &self.candidate.info
    }

    /// Opens it.
    ///
    /// # Errors
    /// What the driver says.
    pub fn open(self) -> Result<Device, GpuError> {
        let create = || Logical::new(self.instance, self.candidate, self.options.staging);
        let logical = Arc::new(stage("device", create)?);
        let queue = Arc::new(Mutex::new(Queue::new(&logical)?));
        Ok(Device { logical, queue })
    }
}

impl Device {
    /// Opens the device that `selector` means: an index in [`devices`](super::devices), or a part of a name in
    /// any case; without one the best of discrete, integrated, virtual, CPU. The environment variable
    /// `ETENDUE_VALIDATION=1` turns the validation layer on.
    ///
    /// # Errors
    /// No loader, driver or device, each with advice; [`GpuError::UnknownDevice`], which lists the devices;
    /// [`GpuError::NoValidation`].
    pub fn open(selector: Option<&str>) -> Result<Self, GpuError> {
        Self::open_with(selector, OpenOptions::from_env())
    }

    /// As [`Device::open`], without a look at the environment.
    ///
    /// # Errors
    /// As [`Device::open`].
    pub fn open_with(selector: Option<&str>, options: OpenOptions) -> Result<Self, GpuError> {
        FoundDevice::find(selector, options)?.open()
    }

    /// Name, driver and limits.
    pub fn info(&self) -> &DeviceInfo {
        &self.logical.info
    }

    /// Bytes of device memory that the buffers hold now (the staging buffer of 32 MiB included, once there).
    pub fn bytes_in_use(&self) -> u64 {
        self.logical.in_use()
    }

    /// The most bytes of device memory that were ever held at once.
    pub fn peak_bytes_in_use(&self) -> u64 {
        self.logical.peak()
    }

    /// The validation layer's log, if the layer is on. It outlives the device and so sees what was not freed.
    pub fn validation(&self) -> Option<ValidationLog> {
        self.logical.instance.log.clone()
    }

    /// The validation layer's first messages; empty without the layer.
    pub fn validation_messages(&self) -> Vec<String> {
        self.validation()
            .map(|log| log.messages())
            .unwrap_or_default()
    }

    /// Measured behaviour of the device's shaders; the first call runs a tiny kernel, later ones remember.
    ///
    /// # Errors
    /// Any of the calls for it, or [`GpuError::Probe`] when the results make no sense.
    pub fn probe(&self) -> Result<Probe, GpuError> {
        if let Some(known) = self.logical.probe.get() {
            return Ok(*known);
        }
        let measured = probe::run(self)?;
        Ok(*self.logical.probe.get_or_init(|| measured))
    }

    /// How its shaders read scattered memory fastest: measured, and kept in `cache` for the next time.
    ///
    /// # Errors
    /// Any of the calls for the measurement.
    pub fn quickest_loads(&self, cache: &Cache) -> Result<Loads, GpuError> {
        probe::loads::quickest(self, cache)
    }

    /// The same as far as it was measured before, or all that its shaders can do: for what is done before a measurement
    /// is. That is compiled in the least time, too.
    #[must_use]
    pub fn likely_loads(&self, cache: &Cache) -> Loads {
        let possible = || Loads::possible(self.info());
        probe::loads::kept(self, cache).unwrap_or_else(possible)
    }

    /// Makes a buffer of `bytes` bytes (16 for 0), filled with zeros.
    ///
    /// # Errors
    /// [`GpuError::OutOfMemory`]; [`GpuError::Limit`] when the device allows no buffer of that size.
    pub fn buffer(&self, label: &str, bytes: u64) -> Result<Buffer, GpuError> {
        let raw = RawBuffer::new(&self.logical, label, bytes, Purpose::Work)?;
        transfer::clear(&mut self.lock(), &raw)?;
        Ok(Buffer(Arc::new(raw)))
    }

    /// Makes a buffer that holds `data`.
    ///
    /// # Errors
    /// As [`Device::buffer`] and [`Device::upload`].
    pub fn buffer_with<T: Pod>(&self, label: &str, data: &[T]) -> Result<Buffer, GpuError> {
        let data: &[u8] = bytemuck::cast_slice(data);
        if data.is_empty() {
            return self.buffer(label, 0);
        }
        // Not filled with zeros first: the data covers it, and touching a gibibyte takes seconds on a slow host.
        let raw = RawBuffer::new(&self.logical, label, data.len() as u64, Purpose::Work)?;
        transfer::upload(&mut self.lock(), &raw, 0, data)?;
        Ok(Buffer(Arc::new(raw)))
    }

    /// Writes `data` into a buffer from byte `offset` on. Any offset and length will do.
    ///
    /// # Errors
    /// [`GpuError::OutOfRange`], [`GpuError::DeviceLost`].
    pub fn upload(&self, buffer: &Buffer, offset: u64, data: &[u8]) -> Result<(), GpuError> {
        self.check_owner(buffer)?;
        transfer::upload(&mut self.lock(), &buffer.0, offset, data)
    }

    /// Reads `bytes` bytes of a buffer from byte `offset` on. Any offset and length will do.
    ///
    /// # Errors
    /// [`GpuError::OutOfRange`], [`GpuError::OutOfHostMemory`], [`GpuError::DeviceLost`].
    pub fn download(&self, buffer: &Buffer, offset: u64, bytes: u64) -> Result<Vec<u8>, GpuError> {
        self.read(buffer, offset, bytes)
    }

    /// Reads `count` values of a buffer from byte `offset` on.
    ///
    /// # Errors
    /// As [`Device::download`].
    pub fn read<T: Pod>(
        &self,
        buffer: &Buffer,
        offset: u64,
        count: u64,
    ) -> Result<Vec<T>, GpuError> {
        self.check_owner(buffer)?;
        let bytes = count.saturating_mul(size_of::<T>() as u64);
        buffer.0.check_range(offset, bytes)?;
        let label = buffer.label().to_owned();
        let mut values = Vec::new();
        let reserved = values.try_reserve_exact(count as usize);
        reserved.map_err(|_| GpuError::OutOfHostMemory { label, bytes })?;
        values.resize(count as usize, T::zeroed());
        self.download_into(buffer, offset, bytemuck::cast_slice_mut(&mut values))?;
        Ok(values)
    }

    /// Fills `out` from a buffer, from byte `offset` on.
    ///
    /// # Errors
    /// [`GpuError::OutOfRange`], [`GpuError::DeviceLost`].
    pub fn download_into(
        &self,
        buffer: &Buffer,
        offset: u64,
        out: &mut [u8],
    ) -> Result<(), GpuError> {
        self.check_owner(buffer)?;
        transfer::download(&mut self.lock(), &buffer.0, offset, out)
    }

    /// Makes a pipeline of a compute shader whose descriptor set 0 has exactly `bindings`.
    ///
    /// `spirv` must be what naga made of a validated shader, in at most the SPIR-V version of
    /// [`DeviceInfo::spirv_version`]: drivers trust it, and there are no bounds checks but its own.
    /// `workgroup` is the shader's workgroup size.
    ///
    /// # Errors
    /// [`GpuError::Limit`], [`GpuError::Misuse`], or the driver's compiler fails.
    pub fn pipeline(
        &self,
        label: &str,
        spirv: &[u32],
        entry_point: &str,
        bindings: &[(u32, BindingKind)],
        workgroup: [u32; 3],
    ) -> Result<Pipeline, GpuError> {
        Pipeline::new(
            &self.logical,
            label,
            spirv,
            entry_point,
            bindings,
            workgroup,
        )
    }

    /// Chooses the buffers of a pipeline's bindings, each as (binding, buffer, range as offset and bytes).
    /// The group holds the buffers alive and fits every pipeline with equal bindings.
    ///
    /// # Errors
    /// [`GpuError::Misuse`] unless each binding is given once and each offset is aligned,
    /// [`GpuError::OutOfRange`], [`GpuError::Limit`].
    pub fn bind(&self, pipeline: &Pipeline, buffers: &[Bound<'_>]) -> Result<BindGroup, GpuError> {
        BindGroup::new(pipeline, buffers)
    }

    /// Runs `groups` workgroups and waits for their end. Nothing runs when one of the three numbers is 0.
    ///
    /// # Errors
    /// [`GpuError::Limit`], [`GpuError::Misuse`], [`GpuError::DeviceLost`] with the pipeline's label.
    pub fn dispatch(
        &self,
        pipeline: &Pipeline,
        group: &BindGroup,
        groups: [u32; 3],
    ) -> Result<Timing, GpuError> {
        self.check_dispatch(pipeline, group, groups)?;
        let (layout, sets) = (pipeline.layout.pipeline, [group.set]);
        self.lock().run(pipeline.label(), |device, commands| {
            let point = vk::PipelineBindPoint::COMPUTE;
            // SAFETY: called while recording; pipeline, layout and set are of this device, fit each other and are
            // borrowed until the work has ended; the numbers are within the limits.
            unsafe {
                device.cmd_bind_pipeline(commands, point, pipeline.raw);
                device.cmd_bind_descriptor_sets(commands, point, layout, 0, &sets, &[]);
                device.cmd_dispatch(commands, groups[0], groups[1], groups[2]);
            }
        })
    }

    /// Makes the driver compile the pipeline by a dispatch of no groups; returns the time that took.
    ///
    /// Lavapipe compiles at the first dispatch (measured on 22.3.6: even one of no groups), so without this
    /// call the compilation counts into the first piece of work.
    ///
    /// # Errors
    /// As [`Device::dispatch`].
    pub fn warm_up(&self, pipeline: &Pipeline, group: &BindGroup) -> Result<Duration, GpuError> {
        Ok(self.dispatch(pipeline, group, [0; 3])?.wall)
    }

    fn check_dispatch(
        &self,
        pipeline: &Pipeline,
        group: &BindGroup,
        groups: [u32; 3],
    ) -> Result<(), GpuError> {
        let label = pipeline.label();
        for (count, limit) in groups.into_iter().zip(self.info().max_workgroups) {
            let what = "workgroups along an axis (maxComputeWorkGroupCount)";
            check_limit(label, what, count.into(), limit.into())?;
        }
        if !Arc::ptr_eq(&pipeline.layout.logical, &self.logical) {
            return Err(GpuError::misuse(
                label,
                "the pipeline belongs to another device",
            ));
        }
        if !pipeline.layout.accepts(&group.layout) {
            let reason = format!("{group:?} has other bindings or belongs to another device");
            return Err(GpuError::misuse(label, reason));
        }
        Ok(())
    }

    fn check_owner(&self, buffer: &Buffer) -> Result<(), GpuError> {
        if buffer.0.belongs_to(&self.logical) {
            return Ok(());
        }
        Err(GpuError::misuse(
            buffer.label(),
            "the buffer belongs to another device",
        ))
    }

    fn lock(&self) -> MutexGuard<'_, Queue> {
        // A panic of another thread leaves no work pending: each call waits for its own.
        self.queue.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl std::fmt::Debug for Device {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Device({:?})", self.logical.info.name)
    }
}
