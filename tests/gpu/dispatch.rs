//! Pipelines, bindings and dispatches on a real device. Without one these tests fail and say how to get one.

use crate::common::{ADD, BINDINGS, add_pipeline, compile, device, parameters, staged};
use etendue::gpu::{BindGroup, BindingKind, Bound, Buffer, Device, GpuError, Pipeline};

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
