//! The `gpu` layer on a real device. Without one these tests fail and say how to get one.

use std::process::Command;
use std::sync::OnceLock;

use etendue::gpu::{
    BindGroup, BindingKind, Bound, Buffer, Device, GpuError, OpenOptions, Pipeline, devices,
};
use naga::back::spv;
use naga::valid::{Capabilities, ValidationFlags, Validator};

/// Adds `parameters.x` to each number, as far as the bound range reaches.
const ADD: &str = "
@group(0) @binding(0) var<uniform> parameters: vec4u;
@group(0) @binding(1) var<storage, read> source: array<u32>;
@group(0) @binding(2) var<storage, read_write> target_: array<u32>;
@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if id.x < arrayLength(&target_) { target_[id.x] = source[id.x] + parameters.x; }
}";

const BINDINGS: [(u32, BindingKind); 3] = [
    (0, BindingKind::Uniform),
    (1, BindingKind::Storage),
    (2, BindingKind::Storage),
];

fn compile(wgsl: &str) -> Vec<u32> {
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
fn device() -> &'static Device {
    static DEVICE: OnceLock<Device> = OnceLock::new();
    DEVICE.get_or_init(|| Device::open(None).unwrap_or_else(|error| panic!("{error}")))
}

/// The same device, with every transfer through the staging buffer.
fn staged() -> Device {
    let options = OpenOptions {
        staging: true,
        ..OpenOptions::default()
    };
    Device::open_with(None, options).unwrap_or_else(|error| panic!("{error}"))
}

fn add_pipeline(device: &Device) -> Pipeline {
    device
        .pipeline("add", &compile(ADD), "main", &BINDINGS, [64, 1, 1])
        .expect("pipeline")
}

fn parameters(device: &Device, add: u32) -> Buffer {
    device
        .buffer_with("parameters", &[add, 0, 0, 0])
        .expect("parameters")
}

/// Bytes without a period that a transfer in pieces could hide.
fn noise(count: usize) -> Vec<u8> {
    (0..count as u64)
        .map(|i| (i.wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 56) as u8)
        .collect()
}

#[test]
fn every_listed_device_has_a_name_a_driver_and_limits() {
    for device in devices().unwrap_or_else(|error| panic!("{error}")) {
        assert!(!device.name.is_empty() && !device.driver.is_empty());
        assert!(device.max_buffers >= 4 && device.max_workgroups_x >= 65_535);
        assert!(device.max_storage_buffer_range >= 1 << 27 && device.memory > 0);
        assert!(device.subgroup_size.is_power_of_two());
    }
}

#[test]
fn a_new_buffer_is_zero_and_of_the_size_asked() {
    for device in [device().clone(), staged()] {
        for bytes in [0, 1, 15, 16, 17, 4099] {
            let buffer = device.buffer("zeros", bytes).expect("buffer");
            assert_eq!(buffer.bytes(), if bytes == 0 { 16 } else { bytes });
            let content = device
                .download(&buffer, 0, buffer.bytes())
                .expect("download");
            assert!(content.iter().all(|&byte| byte == 0));
        }
    }
}

#[test]
fn bytes_come_back_at_any_offset_and_size() {
    for device in [device().clone(), staged()] {
        let buffer = device.buffer("bytes", 1001).expect("buffer");
        let mut expected = vec![0; 1001];
        for (offset, count) in [
            (0, 1001),
            (0, 1),
            (1, 3),
            (7, 64),
            (999, 2),
            (1001, 0),
            (500, 333),
        ] {
            let data = noise(offset + count).split_off(offset);
            expected[offset..offset + count].copy_from_slice(&data);
            device
                .upload(&buffer, offset as u64, &data)
                .expect("upload");
            let back = device
                .download(&buffer, offset as u64, count as u64)
                .expect("download");
            assert_eq!(back, data, "offset {offset}, {count} bytes");
        }
        assert_eq!(
            device.download(&buffer, 0, 1001).expect("download"),
            expected
        );
    }
}

#[test]
fn a_transfer_larger_than_the_staging_buffer_goes_in_pieces() {
    let device = staged();
    let data = noise((32 << 20) + 12_345);
    let buffer = device
        .buffer("large", data.len() as u64 + 3)
        .expect("buffer");
    device.upload(&buffer, 3, &data).expect("upload");
    assert!(
        device
            .download(&buffer, 3, data.len() as u64)
            .expect("download")
            == data
    );
}

#[test]
fn transfers_outside_the_buffer_are_refused() {
    for device in [device().clone(), staged()] {
        let buffer = device.buffer("small", 8).expect("buffer");
        for (offset, bytes) in [(0, 9), (8, 1), (9, 0), (u64::MAX, 2), (4, u64::MAX)] {
            let error = device
                .download(&buffer, offset, bytes)
                .expect_err("outside");
            assert!(matches!(error, GpuError::OutOfRange { .. }), "{error}");
        }
        let error = device.upload(&buffer, 4, &[0; 5]).expect_err("outside");
        assert!(error.to_string().contains("'small'"), "{error}");
        assert!(device.read::<u64>(&buffer, 0, u64::MAX / 2).is_err());
    }
}

#[test]
fn a_dispatch_runs_as_many_groups_as_asked() {
    for device in [device().clone(), staged()] {
        let pipeline = add_pipeline(&device);
        let source: Vec<u32> = (0..64 * 1000).collect();
        let input = device.buffer_with("source", &source).expect("source");
        let parameters = parameters(&device, 5);
        for groups in [0, 1, 2, 7, 1000_u32] {
            let output = device
                .buffer("target", 4 * source.len() as u64)
                .expect("target");
            let buffers = [
                (0, &parameters, None),
                (1, &input, None),
                (2, &output, None),
            ];
            let group = device.bind(&pipeline, &buffers).expect("bind");
            device
                .dispatch(&pipeline, &group, [groups, 1, 1])
                .expect("dispatch");
            let done = device
                .read::<u32>(&output, 0, source.len() as u64)
                .expect("read");
            let reached = 64 * groups;
            let expected = |i: u32| if i < reached { i + 5 } else { 0 };
            assert!(
                source.iter().all(|&i| done[i as usize] == expected(i)),
                "{groups} groups"
            );
        }
    }
}

#[test]
fn a_dispatch_sees_what_the_last_one_wrote() {
    let (device, pipeline) = (device(), add_pipeline(device()));
    let [a, b] = ["a", "b"].map(|name| device.buffer(name, 4 * 640).expect("buffer"));
    let one = parameters(device, 1);
    let bind = |from, to| {
        device
            .bind(
                &pipeline,
                &[(0, &one, None), (1, from, None), (2, to, None)],
            )
            .expect("bind")
    };
    let groups = [bind(&a, &b), bind(&b, &a)];
    for group in groups.iter().cycle().take(100) {
        device
            .dispatch(&pipeline, group, [10, 1, 1])
            .expect("dispatch");
    }
    assert_eq!(device.read::<u32>(&a, 0, 640).expect("read"), [100; 640]);
}

#[test]
fn a_range_confines_a_binding() {
    let (device, pipeline) = (device(), add_pipeline(device()));
    let alignment = device.info().storage_offset_alignment;
    let offset = 256_u64.next_multiple_of(alignment);
    let input = device
        .buffer_with("source", &vec![1_u32; 4096])
        .expect("source");
    let output = device.buffer("target", 4 * 4096).expect("target");
    let six = parameters(device, 6);
    let range = Some((offset, 400));
    let buffers = [(2, &output, range), (1, &input, None), (0, &six, None)];
    let group = device.bind(&pipeline, &buffers).expect("bind");
    device
        .dispatch(&pipeline, &group, [64, 1, 1])
        .expect("dispatch");
    let first = offset as usize / 4;
    let done = device.read::<u32>(&output, 0, 4096).expect("read");
    let inside = first..first + 100;
    assert!((0..4096).all(|i| done[i] == if inside.contains(&i) { 7 } else { 0 }));
}

#[test]
fn handles_may_be_dropped_in_any_order() {
    let device = staged();
    let pipeline = add_pipeline(&device);
    let output = device.buffer("target", 256).expect("target");
    let group = {
        let input = device.buffer_with("source", &[3_u32; 64]).expect("source");
        let four = parameters(&device, 4);
        device.bind(
            &pipeline,
            &[(0, &four, None), (1, &input, None), (2, &output, None)],
        )
    };
    let group = group.expect("bind");
    device
        .dispatch(&pipeline, &group, [1, 1, 1])
        .expect("dispatch");
    assert_eq!(device.read::<u32>(&output, 0, 64).expect("read"), [7; 64]);
    drop(device);
    drop(pipeline);
    drop(output);
    drop(group);
}

#[test]
fn threads_share_a_device() {
    std::thread::scope(|scope| {
        for add in 1..=4 {
            scope.spawn(move || {
                let pipeline = add_pipeline(device());
                let (a, b) = (
                    parameters(device(), add),
                    device().buffer("sum", 16).expect("sum"),
                );
                let buffers = [(0, &a, None), (1, &a, None), (2, &b, None)];
                let group = device().bind(&pipeline, &buffers).expect("bind");
                for _ in 0..20 {
                    device()
                        .dispatch(&pipeline, &group, [1, 1, 1])
                        .expect("dispatch");
                    let sum = device().read::<u32>(&b, 0, 4).expect("read");
                    assert_eq!(sum, [2 * add, add, add, add]);
                }
            });
        }
    });
}

#[test]
fn too_much_memory_is_an_error_that_says_how_much_and_for_what() {
    let error = device()
        .buffer("textures", 1 << 50)
        .expect_err("a pebibyte");
    assert!(
        matches!(error, GpuError::OutOfMemory { bytes, .. } if bytes == 1 << 50),
        "{error}"
    );
    let text = error.to_string();
    assert!(text.contains("'textures' needs 1.0 PiB"), "{text}");
    assert!(device().buffer("all", u64::MAX).is_err());
}

#[test]
fn memory_in_use_is_counted() {
    let device = staged();
    let before = device.bytes_in_use();
    let buffer = device.buffer("counted", 1 << 20).expect("buffer");
    assert!(device.bytes_in_use() >= before + (1 << 20));
    drop(buffer);
    assert_eq!(device.bytes_in_use(), before);
    assert!(device.peak_bytes_in_use() >= before + (1 << 20));
}

#[test]
fn an_unknown_device_is_an_error_that_lists_the_devices() {
    let error = Device::open(Some("no such device")).expect_err("unknown");
    let text = error.to_string();
    assert!(
        text.contains(&format!("0: {}", devices().expect("devices")[0].name)),
        "{text}"
    );
    let part = device().info().name[..4].to_uppercase();
    assert!(Device::open(Some(&part)).is_ok());
}

#[test]
fn more_bindings_than_allowed_are_refused() {
    let count = device().info().max_buffers + 1;
    if count > 4096 {
        return; // Some drivers allow millions.
    }
    let bindings: Vec<_> = (0..count)
        .map(|number| (number, BindingKind::Storage))
        .collect();
    let made = device().pipeline("greedy", &compile(ADD), "main", &bindings, [64, 1, 1]);
    let error = made.expect_err("too many");
    assert!(
        error
            .to_string()
            .contains("maxPerStageDescriptorStorageBuffers"),
        "{error}"
    );
}

#[test]
fn a_binding_that_does_not_fit_is_refused() {
    let (device, pipeline) = (device(), add_pipeline(device()));
    let [a, b, c] = ["a", "b", "c"].map(|name| device.buffer(name, 1024).expect("buffer"));
    let refused = |buffers: &[Bound<'_>]| {
        device
            .bind(&pipeline, buffers)
            .expect_err("does not fit")
            .to_string()
    };
    assert!(refused(&[(0, &a, None), (1, &b, None)]).contains("[0, 1, 2]"));
    refused(&[(0, &a, None), (1, &b, None), (1, &c, None)]);
    refused(&[(0, &a, None), (1, &b, None), (2, &c, None), (3, &c, None)]);
    refused(&[(0, &a, None), (1, &b, None), (2, &c, Some((0, 1025)))]);
    refused(&[(0, &a, None), (1, &b, None), (2, &c, Some((0, 0)))]);
    refused(&[(0, &a, None), (1, &b, None), (2, &c, Some((1, 4)))]);
    let foreign = staged().buffer("foreign", 1024).expect("buffer");
    refused(&[(0, &a, None), (1, &b, None), (2, &foreign, None)]);
    assert!(device.upload(&foreign, 0, &[1]).is_err());
}

#[test]
fn a_range_above_the_limit_is_refused() {
    let (device, pipeline) = (device(), add_pipeline(device()));
    let limit = device.info().max_storage_buffer_range;
    if limit > 1 << 30 {
        return; // Not worth so much memory.
    }
    let small = parameters(device, 0);
    let large = device.buffer("large", limit + 16).expect("buffer");
    let bind = |range| {
        device.bind(
            &pipeline,
            &[(0, &small, None), (1, &small, None), (2, &large, range)],
        )
    };
    let error = bind(None).expect_err("too large");
    assert!(
        error.to_string().contains("maxStorageBufferRange"),
        "{error}"
    );
    assert!(bind(Some((0, limit))).is_ok());
}

#[test]
fn a_dispatch_that_does_not_fit_is_refused() {
    let (device, pipeline) = (device(), add_pipeline(device()));
    let one = parameters(device, 1);
    let group = |device: &Device, pipeline: &Pipeline, one: &Buffer| -> BindGroup {
        device
            .bind(pipeline, &[(0, one, None), (1, one, None), (2, one, None)])
            .expect("bind")
    };
    let fitting = group(device, &pipeline, &one);
    for (axis, limit) in device.info().max_workgroups.into_iter().enumerate() {
        let mut groups = [1; 3];
        groups[axis] = limit.saturating_add(1);
        if groups[axis] > limit {
            let error = device
                .dispatch(&pipeline, &fitting, groups)
                .expect_err("too many groups");
            assert!(
                error.to_string().contains("maxComputeWorkGroupCount"),
                "{error}"
            );
        }
    }
    let other = staged();
    let foreign = group(&other, &add_pipeline(&other), &parameters(&other, 1));
    assert!(device.dispatch(&pipeline, &foreign, [1, 1, 1]).is_err());
    assert!(other.dispatch(&pipeline, &fitting, [1, 1, 1]).is_err());
    assert!(
        device
            .pipeline("noise", &[1, 2, 3], "main", &BINDINGS, [64, 1, 1])
            .is_err()
    );
    let huge = device.pipeline("huge", &compile(ADD), "main", &BINDINGS, [u32::MAX; 3]);
    assert!(matches!(huge, Err(GpuError::Limit { .. })));
}

#[test]
fn a_timing_is_positive_and_the_device_is_not_slower_than_the_host_saw() {
    let (device, pipeline) = (device(), add_pipeline(device()));
    let one = parameters(device, 1);
    let group = device.bind(
        &pipeline,
        &[(0, &one, None), (1, &one, None), (2, &one, None)],
    );
    let timing = device
        .dispatch(&pipeline, &group.expect("bind"), [1000, 1, 1])
        .expect("dispatch");
    assert!(!timing.wall.is_zero());
    assert!(timing.device.is_none_or(|device| device <= timing.wall));
}

#[test]
fn the_probe_is_consistent() {
    let probe = device().probe().unwrap_or_else(|error| panic!("{error}"));
    println!(
        "{} ({}): {probe:?}",
        device().info().name,
        device().info().driver
    );
    assert_eq!(device().probe().expect("remembered"), probe);
    assert_eq!(staged().probe().expect("measured anew"), probe);
    assert!(probe.loop_limit.is_none_or(|limit| limit > 1000));
    let spans = probe.limit_spans_loops || probe.limit_spans_lanes;
    assert!(probe.loop_limit.is_some() || !spans);
}

#[test]
fn the_validation_layer_has_nothing_to_say() {
    for staging in [false, true] {
        let options = OpenOptions {
            validation: true,
            staging,
        };
        let device = Device::open_with(None, options).unwrap_or_else(|error| panic!("{error}"));
        let log = device.validation().expect("the layer is on");
        device.probe().expect("probe");
        let pipeline = add_pipeline(&device);
        let (one, sum) = (
            parameters(&device, 1),
            device.buffer("sum", 1024).expect("sum"),
        );
        let group = device.bind(
            &pipeline,
            &[(0, &one, None), (1, &one, None), (2, &sum, None)],
        );
        let group = group.expect("bind");
        device
            .dispatch(&pipeline, &group, [2, 1, 1])
            .expect("dispatch");
        device
            .dispatch(&pipeline, &group, [0, 1, 1])
            .expect("nothing to do");
        assert_eq!(device.read::<u32>(&sum, 0, 1).expect("read"), [2]);
        drop((one, sum, device, group, pipeline));
        assert_eq!(log.count(), 0, "{:#?}", log.messages());
    }
}

#[test]
fn the_validation_layer_is_heard() {
    let options = OpenOptions {
        validation: true,
        ..OpenOptions::default()
    };
    let device = Device::open_with(None, options).unwrap_or_else(|error| panic!("{error}"));
    // The shader has three bindings, the layout none.
    let _ = device.pipeline("bare", &compile(ADD), "main", &[], [64, 1, 1]);
    assert!(device.validation().expect("the layer is on").count() > 0);
    assert!(device.validation_messages()[0].contains("VUID"));
}

#[test]
fn without_a_driver_the_error_says_what_to_install() {
    let mut child = Command::new(std::env::current_exe().expect("this test"));
    child.args(["--exact", "child_without_a_driver", "--ignored"]);
    child
        .env("VK_ICD_FILENAMES", "/nonexistent.json")
        .env("VK_DRIVER_FILES", "/nonexistent.json");
    let output = child.output().expect("run this test again");
    let text = String::from_utf8_lossy(&output.stdout);
    assert!(
        output.status.success() && text.contains("1 passed"),
        "{text}"
    );
}

#[test]
#[ignore = "run by without_a_driver_the_error_says_what_to_install"]
fn child_without_a_driver() {
    let error = devices().expect_err("no driver");
    assert!(
        matches!(error, GpuError::NoDriver | GpuError::NoDevice),
        "{error}"
    );
    assert!(error.to_string().contains("apt install"), "{error}");
    assert!(Device::open(None).is_err());
}
