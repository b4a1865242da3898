//! The probes' shaders, compiled here because `gpu` needs them before any layer above has a shader.

use naga::ShaderStage;
use naga::back::spv;
use naga::valid::{Capabilities, ValidationFlags, Validator};

use crate::gpu::GpuError;

/// The SPIR-V of `probe.wgsl`.
pub(super) fn spirv() -> Result<Vec<u32>, GpuError> {
    compile(include_str!("probe.wgsl"))
}

/// The SPIR-V of a shader's entry point `main`, in the version of Vulkan 1.1.
pub(super) fn compile(text: &str) -> Result<Vec<u32>, GpuError> {
    let failed = |error: &dyn std::error::Error| GpuError::Probe {
        reason: format!("its shader does not compile: {error}"),
    };
    let module = naga::front::wgsl::parse_str(text).map_err(|e| failed(&e))?;
    let mut validator = Validator::new(ValidationFlags::all(), Capabilities::SHADER_INT64);
    let info = validator.validate(&module).map_err(|e| failed(&e))?;
    let options = spv::Options {
        lang_version: (1, 3),
        // A bound of naga's own would be measured in place of the driver's.
        force_loop_bounding: false,
        ..spv::Options::default()
    };
    let pipeline = spv::PipelineOptions {
        shader_stage: ShaderStage::Compute,
        entry_point: "main".to_owned(),
    };
    spv::write_vec(&module, &info, &options, Some(&pipeline)).map_err(|e| failed(&e))
}
