//! The device's queue: record, submit, wait, one piece of work at a time.

use std::sync::Arc;
use std::time::{Duration, Instant};

use ash::vk;
use serde::Serialize;

use super::error::GpuError;
use super::logical::Logical;
use super::memory::{Purpose, RawBuffer};

/// Nanoseconds after which a wait looks again whether the device still lives.
const WAIT_SLICE: u64 = 500_000_000;
/// Bytes of the staging buffer, and so of a piece of a transfer.
pub(super) const STAGING_BYTES: u64 = 32 << 20;

/// How long a piece of work took.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Timing {
    /// From the submission until the host knew of the end.
    pub wall: Duration,
    /// On the device's clock, where its queue has timestamps.
    pub device: Option<Duration>,
}

impl Timing {
    /// The device's time if known, else the wall time.
    pub fn best(&self) -> Duration {
        self.device.unwrap_or(self.wall)
    }
}

/// The queue with one command buffer, one fence, two timestamps and one staging buffer, used again and again.
/// Whoever holds `&mut Queue` knows that the device is idle.
pub(super) struct Queue {
    logical: Arc<Logical>,
    raw: vk::Queue,
    pool: vk::CommandPool,
    commands: vk::CommandBuffer,
    fence: vk::Fence,
    /// Null where the queue has no timestamps.
    stamps: vk::QueryPool,
    staging: Option<RawBuffer>,
    /// The work during which the device was lost.
    lost: Option<String>,
}

impl Queue {
    pub fn new(logical: &Arc<Logical>) -> Result<Self, GpuError> {
        // SAFETY: the device was made with one queue of this family.
        let raw = unsafe { logical.raw.get_device_queue(logical.queue_family, 0) };
        let mut queue = Self {
            logical: Arc::clone(logical),
            raw,
            pool: vk::CommandPool::null(),
            commands: vk::CommandBuffer::null(),
            fence: vk::Fence::null(),
            stamps: vk::QueryPool::null(),
            staging: None,
            lost: None,
        };
        queue.create_commands()?;
        queue.create_sync()?;
        Ok(queue)
    }

    fn create_commands(&mut self) -> Result<(), GpuError> {
        let device = &self.logical.raw;
        let info = vk::CommandPoolCreateInfo::default()
            .flags(vk::CommandPoolCreateFlags::RESET_COMMAND_BUFFER)
            .queue_family_index(self.logical.queue_family);
        // SAFETY: the device is alive and has the family.
        self.pool = unsafe { device.create_command_pool(&info, None) }
            .map_err(|e| GpuError::vulkan("create a command pool", e))?;
        let info = vk::CommandBufferAllocateInfo::default()
            .command_pool(self.pool)
            .level(vk::CommandBufferLevel::PRIMARY)
            .command_buffer_count(1);
        // SAFETY: the pool was just made.
        let made = unsafe { device.allocate_command_buffers(&info) };
        let made = made.map_err(|e| GpuError::vulkan("create a command buffer", e))?;
        self.commands = made.first().copied().unwrap_or_default();
        Ok(())
    }

    fn create_sync(&mut self) -> Result<(), GpuError> {
        let (device, info) = (&self.logical.raw, &self.logical.info);
        // SAFETY: the device is alive.
        self.fence = unsafe { device.create_fence(&vk::FenceCreateInfo::default(), None) }
            .map_err(|e| GpuError::vulkan("create a fence", e))?;
        if info.timestamp_bits == 0 || info.timestamp_period <= 0.0 {
            return Ok(());
        }
        let stamps = vk::QueryPoolCreateInfo::default()
            .query_type(vk::QueryType::TIMESTAMP)
            .query_count(2);
        // SAFETY: the device is alive, and its queue has timestamps.
        self.stamps = unsafe { device.create_query_pool(&stamps, None) }
            .map_err(|e| GpuError::vulkan("create a query pool", e))?;
        Ok(())
    }

    /// Records work, submits it and waits for its end. `doing` names it in errors.
    ///
    /// All that the host or the device wrote before is visible to it, and all that it writes is visible after.
    ///
    /// # Errors
    /// [`GpuError::DeviceLost`], then and at every later call.
    pub fn run(
        &mut self,
        doing: &str,
        record: impl FnOnce(&ash::Device, vk::CommandBuffer),
    ) -> Result<Timing, GpuError> {
        if let Some(doing) = self.lost.clone() {
            return Err(GpuError::DeviceLost { doing });
        }
        self.record(record)
            .map_err(|e| GpuError::vulkan(format!("record '{doing}'"), e))?;
        let start = Instant::now();
        if let Err(error) = self.submit_and_wait() {
            self.lost = Some(doing.to_owned());
            // SAFETY: the device is alive; the wait makes sure that nothing in use is destroyed after the error.
            let _ = unsafe { self.logical.raw.device_wait_idle() };
            return Err(GpuError::vulkan(doing, error));
        }
        let wall = start.elapsed();
        let device = self.stamped().filter(|device| *device <= wall);
        Ok(Timing { wall, device })
    }

    fn record(
        &mut self,
        record: impl FnOnce(&ash::Device, vk::CommandBuffer),
    ) -> Result<(), vk::Result> {
        let (device, commands) = (&self.logical.raw, self.commands);
        let info = vk::CommandBufferBeginInfo::default()
            .flags(vk::CommandBufferUsageFlags::ONE_TIME_SUBMIT);
        // SAFETY: the last submission has ended, so the command buffer may be recorded anew; the caller's closure
        // records only commands on objects that it holds alive until `run` returns.
        unsafe {
            device.begin_command_buffer(commands, &info)?;
            if self.stamps != vk::QueryPool::null() {
                device.cmd_reset_query_pool(commands, self.stamps, 0, 2);
            }
            self.barrier(vk::PipelineStageFlags::ALL_COMMANDS | vk::PipelineStageFlags::HOST);
            self.stamp(vk::PipelineStageFlags::TOP_OF_PIPE, 0);
            record(device, commands);
            self.stamp(vk::PipelineStageFlags::BOTTOM_OF_PIPE, 1);
            self.barrier(vk::PipelineStageFlags::ALL_COMMANDS);
            device.end_command_buffer(commands)
        }
    }

    /// Makes all earlier writes visible to all later commands and to the host.
    fn barrier(&self, from: vk::PipelineStageFlags) {
        let to = vk::PipelineStageFlags::ALL_COMMANDS | vk::PipelineStageFlags::HOST;
        let memory = vk::MemoryBarrier::default()
            .src_access_mask(vk::AccessFlags::MEMORY_WRITE)
            .dst_access_mask(vk::AccessFlags::MEMORY_READ | vk::AccessFlags::MEMORY_WRITE);
        let none = vk::DependencyFlags::empty();
        // SAFETY: called while the command buffer is being recorded.
        unsafe {
            let device = &self.logical.raw;
            device.cmd_pipeline_barrier(self.commands, from, to, none, &[memory], &[], &[]);
        }
    }

    fn stamp(&self, stage: vk::PipelineStageFlags, index: u32) {
        if self.stamps != vk::QueryPool::null() {
            // SAFETY: called while the command buffer is being recorded, after the reset of both queries.
            unsafe {
                let device = &self.logical.raw;
                device.cmd_write_timestamp(self.commands, stage, self.stamps, index);
            }
        }
    }

    fn submit_and_wait(&mut self) -> Result<(), vk::Result> {
        let (device, fences) = (&self.logical.raw, [self.fence]);
        let commands = [self.commands];
        let submit = [vk::SubmitInfo::default().command_buffers(&commands)];
        // SAFETY: the fence is unused and the command buffer recorded; `&mut self` keeps others from the queue.
        unsafe {
            device.reset_fences(&fences)?;
            device.queue_submit(self.raw, &submit, self.fence)?;
            loop {
                match device.wait_for_fences(&fences, true, WAIT_SLICE) {
                    Err(vk::Result::TIMEOUT) => {}
                    other => return other,
                }
            }
        }
    }

    /// The device's time between the two timestamps of the work that just ended.
    fn stamped(&self) -> Option<Duration> {
        if self.stamps == vk::QueryPool::null() {
            return None;
        }
        let mut ticks = [0_u64; 2];
        let flags = vk::QueryResultFlags::TYPE_64;
        // SAFETY: both queries were written by the work that just ended.
        let result = unsafe {
            let device = &self.logical.raw;
            device.get_query_pool_results(self.stamps, 0, &mut ticks, flags)
        };
        result.ok()?;
        let unused = 64_u32.saturating_sub(self.logical.info.timestamp_bits);
        let mask = u64::MAX.checked_shr(unused).unwrap_or(0);
        let elapsed = ticks[1].wrapping_sub(ticks[0]) & mask;
        let nanoseconds = elapsed as f64 * f64::from(self.logical.info.timestamp_period);
        Some(Duration::from_nanos(nanoseconds as u64))
    }

    /// Lends the staging buffer to `work`; made at first need.
    pub fn with_staging<T>(
        &mut self,
        work: impl FnOnce(&mut Self, &RawBuffer) -> Result<T, GpuError>,
    ) -> Result<T, GpuError> {
        let staging = match self.staging.take() {
            Some(staging) => staging,
            None => RawBuffer::new(&self.logical, "staging", STAGING_BYTES, Purpose::Staging)?,
        };
        let result = work(self, &staging);
        self.staging = Some(staging);
        result
    }
}

impl Drop for Queue {
    fn drop(&mut self) {
        let device = &self.logical.raw;
        // SAFETY: every submission was waited for, so nothing is in use; null handles are ignored.
        unsafe {
            device.destroy_query_pool(self.stamps, None);
            device.destroy_fence(self.fence, None);
            device.destroy_command_pool(self.pool, None);
        }
    }
}
