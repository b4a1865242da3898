//! The probe's shader, compiled here because `gpu` needs it before any layer above has a shader.

use naga::back::spv;
use naga::valid::{Capabilities, ValidationFlags, Validator};

use crate::gpu::GpuError;

/// The SPIR-V of `probe.wgsl`, in the version of Vulkan 1.1.
pub(super) fn spirv() -> Result<Vec<u32>, GpuError> {
    let failed = |error: &dyn std::error::Error| GpuError::Probe {
        reason: format!("its shader does not compile: {error}"),
    };
    let text = include_str!("probe.wgsl");
    let module = naga::front::wgsl::parse_str(text).map_err(|e| failed(&e))?;
    let mut validator = Validator::new(ValidationFlags::all(), Capabilities::empty());
    let info = validator.validate(&module).map_err(|e| failed(&e))?;
    let options = spv::Options {
        lang_version: (1, 3),
        // A bound of naga's own would be measured in place of the driver's.
        force_loop_bounding: false,
        ..spv::Options::default()
    };
    spv::write_vec(&module, &info, &options, None).map_err(|e| failed(&e))
}
