//! What étendue asks of naga, for trusted and for checked kernels.

use naga::Module;
use naga::back::spv;
use naga::proc::{BoundsCheckPolicies, BoundsCheckPolicy};
use naga::valid::{Capabilities, ValidationFlags, Validator};

/// What a shader may use beyond core WGSL: subgroup operations (in Vulkan 1.1; the device says which),
/// half floats packed in u32, and 64-bit integers, which [`Compiled::uses_int64`](super::Compiled)
/// tells, since not every device has them. No f64, f16, float atomics or textures: fewer devices
/// have them, or the `gpu` layer does not bind them.
pub const CAPABILITIES: Capabilities = Capabilities::SUBGROUP
    .union(Capabilities::SHADER_INT64)
    .union(Capabilities::SUBGROUP_BARRIER)
    .union(Capabilities::SHADER_FLOAT16_IN_FLOAT32);

/// SPIR-V 1.3 is the newest that every Vulkan 1.1 device takes without an extension.
const SPIRV_VERSION: (u8, u8) = (1, 3);

pub(super) fn validator() -> Validator {
    Validator::new(ValidationFlags::all(), CAPABILITIES)
}

/// Options of the SPIR-V writer. `checked` turns on everything that makes a wrong shader harmless:
/// loops end, workgroup memory starts as zero, integer division by zero is defined, and an index
/// out of bounds reads zero and writes nothing. (Clamping the index instead would read a plausible
/// neighbour and overwrite it: a wrong picture that looks right.)
///
/// Names are always written, because [`super::no_contraction`] finds functions by them.
pub(super) fn writer_options(module: &Module, checked: bool) -> spv::Options<'static> {
    let policy = match checked {
        true => BoundsCheckPolicy::ReadZeroSkipWrite,
        false => BoundsCheckPolicy::Unchecked,
    };
    let zeroing = match checked {
        true => spv::ZeroInitializeWorkgroupMemoryMode::Polyfill,
        false => spv::ZeroInitializeWorkgroupMemoryMode::None,
    };
    spv::Options {
        lang_version: SPIRV_VERSION,
        flags: spv::WriterFlags::DEBUG,
        fake_missing_bindings: false,
        binding_map: binding_map(module),
        bounds_check_policies: BoundsCheckPolicies {
            index: policy,
            buffer: policy,
            image_load: policy,
            binding_array: policy,
        },
        zero_initialize_workgroup_memory: zeroing,
        force_loop_bounding: checked,
        ray_query_initialization_tracking: checked,
        emit_int_div_checks: checked,
        ..spv::Options::default()
    }
}

/// Groups and bindings stay as the shader has them; naga asks for each to be said.
fn binding_map(module: &Module) -> spv::BindingMap {
    let places = module
        .global_variables
        .iter()
        .filter_map(|(_, v)| v.binding);
    let same = |at: naga::ResourceBinding| {
        let info = spv::BindingInfo {
            descriptor_set: at.group,
            binding: at.binding,
            binding_array_size: None,
        };
        (at, info)
    };
    places.map(same).collect()
}
