//! What the tests of the `gpu` layer share: a device, and a small kernel.

use std::sync::OnceLock;

use etendue::gpu::{BindingKind, Buffer, Device, OpenOptions, Pipeline};
use naga::back::spv;
use naga::valid::{Capabilities, ValidationFlags, Validator};

/// Adds `parameters.x` to each number, as far as the bound range reaches.
pub const ADD: &str = "
@group(0) @binding(0) var<uniform> parameters: vec4u;
@group(0) @binding(1) var<storage, read> source: array<u32>;
@group(0) @binding(2) var<storage, read_write> target_: array<u32>;
@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if id.x < arrayLength(&target_) { target_[id.x] = source[id.x] + parameters.x; }
}";

/// The bindings of [`ADD`].
pub const BINDINGS: [(u32, BindingKind); 3] = [
    (0, BindingKind::Uniform),
    (1, BindingKind::Storage),
    (2, BindingKind::Storage),
];

/// The SPIR-V of a shader.
pub fn compile(wgsl: &str) -> Vec<u32> {
    let module = naga::front::wgsl::parse_str(wgsl).expect("WGSL");
    let mut validator = Validator::new(ValidationFlags::all(), Capabilities::empty());
    let info = validator.validate(&module).expect("valid");
    let options = spv::Options {
        lang_version: (1, 3),
        ..spv::Options::default()
    };
    spv::write_vec(&module, &info, &options, None).expect("SPIR-V")
}

/// One device for all tests, which also shows that threads may share it.
pub fn device() -> &'static Device {
    static DEVICE: OnceLock<Device> = OnceLock::new();
    DEVICE.get_or_init(|| Device::open(None).unwrap_or_else(|error| panic!("{error}")))
}

/// The same device, with every transfer through the staging buffer.
pub fn staged() -> Device {
    let options = OpenOptions {
        staging: true,
        ..OpenOptions::default()
    };
    Device::open_with(None, options).unwrap_or_else(|error| panic!("{error}"))
}

/// The pipeline of [`ADD`].
pub fn add_pipeline(device: &Device) -> Pipeline {
    device
        .pipeline("add", &compile(ADD), "main", &BINDINGS, [64, 1, 1])
        .expect("pipeline")
}

/// The uniform buffer of [`ADD`].
pub fn parameters(device: &Device, add: u32) -> Buffer {
    device
        .buffer_with("parameters", &[add, 0, 0, 0])
        .expect("parameters")
}
