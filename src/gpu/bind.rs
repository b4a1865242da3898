//! Bind groups: which buffers a pipeline's bindings are.

use std::sync::Arc;

use ash::vk;

use super::error::{GpuError, check_limit};
use super::memory::{Buffer, RawBuffer};
use super::pipeline::{BindingKind, Layout, Pipeline};
use super::texel_buffers::TexelView;

/// A binding number, its buffer, and the range (offset, bytes) of it that the shader sees; `None` is the whole.
pub type Bound<'a> = (u32, &'a Buffer, Option<(u64, u64)>);

/// The buffers of a pipeline's descriptor set 0. It holds them alive, and fits every pipeline with equal bindings.
pub struct BindGroup {
    pub(super) layout: Arc<Layout>,
    pub(super) set: vk::DescriptorSet,
    pool: vk::DescriptorPool,
    views: Vec<TexelView>,
    _buffers: Vec<Arc<RawBuffer>>,
}

impl BindGroup {
    /// See [`Device::bind`](super::Device::bind).
    pub(super) fn new(pipeline: &Pipeline, buffers: &[Bound<'_>]) -> Result<Self, GpuError> {
        let label = pipeline.label();
        check_complete(pipeline, buffers)?;
        let mut group = Self {
            layout: Arc::clone(&pipeline.layout),
            set: vk::DescriptorSet::null(),
            pool: vk::DescriptorPool::null(),
            views: Vec::new(),
            _buffers: buffers
                .iter()
                .map(|(_, buffer, _)| Arc::clone(&buffer.0))
                .collect(),
        };
        group
            .create()
            .map_err(|e| GpuError::vulkan(format!("bind '{label}'"), e))?;
        for bound in buffers {
            group.write(label, bound)?;
        }
        Ok(group)
    }

    fn create(&mut self) -> Result<(), vk::Result> {
        let device = &self.layout.logical.raw;
        let size = |(_, kind): &(u32, BindingKind)| {
            vk::DescriptorPoolSize::default()
                .ty(kind.descriptor())
                .descriptor_count(1)
        };
        let sizes: Vec<_> = self.layout.bindings.iter().map(size).collect();
        let info = vk::DescriptorPoolCreateInfo::default()
            .pool_sizes(&sizes)
            .max_sets(1);
        // SAFETY: the device is alive; `sizes` lives until the call returns.
        self.pool = unsafe { device.create_descriptor_pool(&info, None)? };
        let layouts = [self.layout.set];
        let info = vk::DescriptorSetAllocateInfo::default()
            .descriptor_pool(self.pool)
            .set_layouts(&layouts);
        // SAFETY: pool and layout are alive, and the pool has room for exactly this set.
        let sets = unsafe { device.allocate_descriptor_sets(&info)? };
        self.set = sets.first().copied().unwrap_or_default();
        Ok(())
    }

    fn write(&mut self, label: &str, &(number, buffer, range): &Bound<'_>) -> Result<(), GpuError> {
        let kind = self
            .layout
            .bindings
            .iter()
            .find(|(have, _)| *have == number);
        let Some(&(_, kind)) = kind else {
            return Ok(());
        };
        let (offset, bytes) = range.unwrap_or((0, buffer.bytes()));
        self.check_range(label, kind, buffer, (offset, bytes))?;
        let info = [vk::DescriptorBufferInfo {
            buffer: buffer.0.raw,
            offset,
            range: bytes,
        }];
        let mut views = [vk::BufferView::null()];
        let write = vk::WriteDescriptorSet::default()
            .dst_set(self.set)
            .dst_binding(number)
            .descriptor_type(kind.descriptor());
        let write = match kind {
            BindingKind::Texels { words } => {
                let view = TexelView::new(&self.layout.logical, buffer, (offset, bytes), words)?;
                views[0] = view.raw;
                self.views.push(view);
                write.texel_buffer_view(&views)
            }
            BindingKind::Storage | BindingKind::Uniform => write.buffer_info(&info),
        };
        // SAFETY: the set is not in use yet, the binding exists with this type, the range lies inside the
        // buffer and within the limits, and the group holds the buffer and its view alive.
        unsafe {
            self.layout
                .logical
                .raw
                .update_descriptor_sets(&[write], &[])
        };
        Ok(())
    }

    fn check_range(
        &self,
        label: &str,
        kind: BindingKind,
        buffer: &Buffer,
        (offset, bytes): (u64, u64),
    ) -> Result<(), GpuError> {
        if !buffer.0.belongs_to(&self.layout.logical) {
            let reason = format!("buffer '{}' belongs to another device", buffer.label());
            return Err(GpuError::misuse(label, reason));
        }
        buffer.0.check_range(offset, bytes)?;
        let info = &self.layout.logical.info;
        let (what, limit, alignment) = match kind {
            BindingKind::Storage => (
                "bytes in one storage binding (maxStorageBufferRange)",
                info.max_storage_buffer_range,
                info.storage_offset_alignment,
            ),
            BindingKind::Uniform => (
                "bytes in one uniform binding (maxUniformBufferRange)",
                info.max_uniform_buffer_range,
                info.uniform_offset_alignment,
            ),
            BindingKind::Texels { words } => (
                "bytes in one texel buffer (maxTexelBufferElements)",
                4 * u64::from(words) * info.max_texels,
                info.texel_offset_alignment,
            ),
        };
        check_limit(buffer.label(), what, bytes, limit)?;
        if bytes == 0 || offset % alignment != 0 {
            let reason = format!(
                "the range of '{}' has offset {offset} and {bytes} bytes; it must not be empty, and its \
                 offset a multiple of {alignment}",
                buffer.label()
            );
            return Err(GpuError::misuse(label, reason));
        }
        Ok(())
    }
}

impl Drop for BindGroup {
    fn drop(&mut self) {
        // SAFETY: every dispatch was waited for; destroying the pool frees its set; null is ignored.
        unsafe {
            self.layout
                .logical
                .raw
                .destroy_descriptor_pool(self.pool, None)
        };
    }
}

impl std::fmt::Debug for BindGroup {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "BindGroup({:?})", self.layout.numbers())
    }
}

/// Fails unless each binding of the pipeline is given exactly once.
fn check_complete(pipeline: &Pipeline, buffers: &[Bound<'_>]) -> Result<(), GpuError> {
    let mut given: Vec<u32> = buffers.iter().map(|(number, ..)| *number).collect();
    given.sort_unstable();
    let wanted = pipeline.layout.numbers();
    if given == wanted {
        return Ok(());
    }
    let reason = format!("it has the bindings {wanted:?}, and {given:?} are given");
    Err(GpuError::misuse(pipeline.label(), reason))
}
