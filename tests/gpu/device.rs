//! Devices, memory and the probe on a real device. Without one these tests fail and say how to get one.

use std::process::Command;

use crate::common::{ADD, add_pipeline, compile, device, parameters, staged};
use etendue::gpu::{Device, GpuError, OpenOptions, devices};

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
        device.warm_up(&pipeline, &group).expect("nothing to do");
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
    // Not current_exe: under a private driver that is the dynamic loader (tools/lavapipe).
    let mut child = Command::new(std::env::args_os().next().expect("this test"));
    child.args(["--exact", "device::child_without_a_driver", "--ignored"]);
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
