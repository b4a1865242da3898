//! Compute pipelines with one descriptor set of buffers.

use std::borrow::Cow;
use std::ffi::CString;
use std::sync::Arc;
use std::time::{Duration, Instant};

use ash::vk;

use super::error::{GpuError, check_limit};
use super::logical::Logical;
use super::texel_buffers::images_to_buffers;

/// What a binding of descriptor set 0 is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BindingKind {
    /// A storage buffer, read-only or not.
    Storage,
    /// A uniform buffer.
    Uniform,
    /// A storage texel buffer that is only read, its texels of one, two or four 32-bit words.
    Texels {
        /// Words of a texel.
        words: u8,
    },
}

impl BindingKind {
    pub(super) fn descriptor(self) -> vk::DescriptorType {
        match self {
            Self::Storage => vk::DescriptorType::STORAGE_BUFFER,
            Self::Uniform => vk::DescriptorType::UNIFORM_BUFFER,
            Self::Texels { .. } => vk::DescriptorType::STORAGE_TEXEL_BUFFER,
        }
    }

    fn is_texels(self) -> bool {
        matches!(self, Self::Texels { .. })
    }
}

/// A compute shader, ready to dispatch.
pub struct Pipeline {
    pub(super) layout: Arc<Layout>,
    pub(super) raw: vk::Pipeline,
    label: String,
    creation: Duration,
}

impl Pipeline {
    /// See [`Device::pipeline`](super::Device::pipeline).
    pub(super) fn new(
        logical: &Arc<Logical>,
        label: &str,
        spirv: &[u32],
        entry_point: &str,
        bindings: &[(u32, BindingKind)],
        workgroup: [u32; 3],
    ) -> Result<Self, GpuError> {
        check_shader(logical, label, spirv, workgroup)?;
        let entry = CString::new(entry_point);
        let entry = entry.map_err(|_| GpuError::misuse(label, "entry point with a NUL"))?;
        let start = Instant::now();
        let layout = Layout::new(logical, label, bindings)?;
        let mut pipeline = Self {
            layout: Arc::new(layout),
            raw: vk::Pipeline::null(),
            label: label.to_owned(),
            creation: Duration::ZERO,
        };
        pipeline.create(spirv, &entry)?;
        pipeline.creation = start.elapsed();
        Ok(pipeline)
    }

    /// The name given at creation.
    pub fn label(&self) -> &str {
        &self.label
    }

    /// How long the creation took. Lavapipe compiles at the first dispatch instead.
    pub fn creation_time(&self) -> Duration {
        self.creation
    }

    fn create(&mut self, spirv: &[u32], entry: &std::ffi::CStr) -> Result<(), GpuError> {
        let device = &self.layout.logical.raw;
        let spirv = if self
            .layout
            .bindings
            .iter()
            .any(|(_, kind)| kind.is_texels())
        {
            Cow::Owned(images_to_buffers(spirv))
        } else {
            Cow::Borrowed(spirv)
        };
        let info = vk::ShaderModuleCreateInfo::default().code(&spirv);
        // SAFETY: the words come from naga, which emits valid SPIR-V of the validated shader.
        let module = unsafe { device.create_shader_module(&info, None) }
            .map_err(|e| GpuError::vulkan(format!("load the shader of '{}'", self.label), e))?;
        let stage = vk::PipelineShaderStageCreateInfo::default()
            .stage(vk::ShaderStageFlags::COMPUTE)
            .module(module)
            .name(entry);
        let info = vk::ComputePipelineCreateInfo::default()
            .stage(stage)
            .layout(self.layout.pipeline);
        // SAFETY: module and layout were made by this device and are alive; a pipeline does not need its module.
        let made = unsafe {
            let made = device.create_compute_pipelines(vk::PipelineCache::null(), &[info], None);
            device.destroy_shader_module(module, None);
            made
        };
        let made =
            made.map_err(|(_, e)| GpuError::vulkan(format!("compile '{}'", self.label), e))?;
        self.raw = made.first().copied().unwrap_or_default();
        Ok(())
    }
}

impl Drop for Pipeline {
    fn drop(&mut self) {
        // SAFETY: every dispatch was waited for; null is ignored.
        unsafe { self.layout.logical.raw.destroy_pipeline(self.raw, None) };
    }
}

impl std::fmt::Debug for Pipeline {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Pipeline({:?})", self.label)
    }
}

/// Which bindings a pipeline has.
pub(super) struct Layout {
    pub logical: Arc<Logical>,
    pub bindings: Vec<(u32, BindingKind)>,
    pub set: vk::DescriptorSetLayout,
    pub pipeline: vk::PipelineLayout,
}

impl Layout {
    fn new(
        logical: &Arc<Logical>,
        label: &str,
        bindings: &[(u32, BindingKind)],
    ) -> Result<Self, GpuError> {
        check_bindings(logical, label, bindings)?;
        let mut layout = Self {
            logical: Arc::clone(logical),
            bindings: bindings.to_vec(),
            set: vk::DescriptorSetLayout::null(),
            pipeline: vk::PipelineLayout::null(),
        };
        layout.bindings.sort_unstable_by_key(|(number, _)| *number);
        layout
            .create()
            .map_err(|e| GpuError::vulkan(format!("lay out '{label}'"), e))?;
        Ok(layout)
    }

    fn create(&mut self) -> Result<(), vk::Result> {
        let device = &self.logical.raw;
        let describe = |&(number, kind): &(u32, BindingKind)| {
            vk::DescriptorSetLayoutBinding::default()
                .binding(number)
                .descriptor_type(kind.descriptor())
                .descriptor_count(1)
                .stage_flags(vk::ShaderStageFlags::COMPUTE)
        };
        let bindings: Vec<_> = self.bindings.iter().map(describe).collect();
        let info = vk::DescriptorSetLayoutCreateInfo::default().bindings(&bindings);
        // SAFETY: the device is alive; `bindings` lives until the call returns.
        self.set = unsafe { device.create_descriptor_set_layout(&info, None)? };
        let sets = [self.set];
        let info = vk::PipelineLayoutCreateInfo::default().set_layouts(&sets);
        // SAFETY: the set layout was just made.
        self.pipeline = unsafe { device.create_pipeline_layout(&info, None)? };
        Ok(())
    }

    /// Whether a bind group of `other` fits this layout.
    pub fn accepts(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.logical, &other.logical) && self.bindings == other.bindings
    }

    /// The numbers of the bindings, for an error's text.
    pub fn numbers(&self) -> Vec<u32> {
        self.bindings.iter().map(|(number, _)| *number).collect()
    }
}

impl Drop for Layout {
    fn drop(&mut self) {
        // SAFETY: the pipeline and the bind groups made from it hold it by `Arc` and are gone; null is ignored.
        unsafe {
            self.logical
                .raw
                .destroy_pipeline_layout(self.pipeline, None);
            self.logical
                .raw
                .destroy_descriptor_set_layout(self.set, None);
        }
    }
}

/// Fails on what is no SPIR-V at all, and on a workgroup that the device does not allow.
fn check_shader(
    logical: &Logical,
    label: &str,
    spirv: &[u32],
    workgroup: [u32; 3],
) -> Result<(), GpuError> {
    const MAGIC: u32 = 0x0723_0203;
    if spirv.first() != Some(&MAGIC) || spirv.len() < 5 {
        return Err(GpuError::misuse(label, "the words are not SPIR-V"));
    }
    let info = &logical.info;
    for (size, limit) in workgroup.into_iter().zip(info.max_workgroup_size) {
        let what = "invocations along an axis of a workgroup (maxComputeWorkGroupSize)";
        check_limit(label, what, size.into(), limit.into())?;
    }
    let all = workgroup
        .iter()
        .try_fold(1_u64, |all, &size| all.checked_mul(size.into()));
    let what = "invocations in a workgroup (maxComputeWorkGroupInvocations)";
    let limit = info.max_workgroup_invocations.into();
    check_limit(label, what, all.unwrap_or(u64::MAX), limit)
}

/// Fails on a binding given twice, and on more bindings than the device allows.
fn check_bindings(
    logical: &Logical,
    label: &str,
    bindings: &[(u32, BindingKind)],
) -> Result<(), GpuError> {
    for (i, (number, _)) in bindings.iter().enumerate() {
        if bindings[..i].iter().any(|(earlier, _)| earlier == number) {
            let reason = format!("binding {number} is given twice");
            return Err(GpuError::misuse(label, reason));
        }
    }
    let count = |kind| bindings.iter().filter(|(_, have)| *have == kind).count() as u64;
    let what = "storage buffers (maxPerStageDescriptorStorageBuffers)";
    let limit = logical.info.max_buffers.into();
    check_limit(label, what, count(BindingKind::Storage), limit)?;
    let what = "uniform buffers (maxPerStageDescriptorUniformBuffers)";
    let limit = logical.info.max_uniform_buffers.into();
    check_limit(label, what, count(BindingKind::Uniform), limit)?;
    let texels = bindings.iter().filter(|(_, have)| have.is_texels()).count() as u64;
    let what = "texel buffers (maxPerStageDescriptorStorageImages)";
    let limit = logical.info.max_texel_buffers.into();
    check_limit(label, what, texels, limit)
}
