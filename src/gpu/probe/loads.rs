//! Whether scattered memory is read faster in words or in double words: which of the two forms of a
//! kernel to compile. No bit of a result depends on it.
//!
//! A driver that runs shaders on a CPU reads lane by lane, or with gather instructions that take as
//! long for 8 bytes as for 4: measured, not guessed from its name.

use std::time::{Duration, Instant};

use super::kernel;
use crate::gpu::pipeline::BindingKind;
use crate::gpu::{Device, DeviceKind, GpuError, compiles_quickly};
use crate::host::Cache;

/// Invocations of a run: some 10 ms of work on two cores, and on a GPU as many as it takes to see more than the dispatch.
const CPU_LANES: u32 = 1 << 12;
const GPU_LANES: u32 = 1 << 14;
/// Bytes that are read from, as in the shader.
const BYTES: u32 = 512 * 64;
/// Runs of each form; the quickest counts.
const RUNS: usize = 5;
/// Double words must save this share of the time to be chosen: taking them apart costs more in a kernel
/// that has other work to do.
const WORTHWHILE: f64 = 0.2;

/// Whether double words are faster; what was measured once for a device and driver is kept.
pub(in crate::gpu) fn prefers_doublewords(
    device: &Device,
    cache: &Cache,
) -> Result<bool, GpuError> {
    if !device.info().int64 {
        return Ok(false);
    }
    let key = key(device);
    if let Some(kept) = cache.get("loads", &key) {
        return Ok(kept == [1]);
    }
    let prefers = measure(device)?;
    cache.put("loads", &key, &[u8::from(prefers)]);
    Ok(prefers)
}

fn key(device: &Device) -> [u8; 32] {
    let info = device.info();
    let mut hasher = blake3::Hasher::new();
    let compiles = if compiles_quickly(info) {
        "quickly"
    } else {
        ""
    };
    for part in [
        &info.name,
        &info.driver,
        include_str!("loads.wgsl"),
        compiles,
    ] {
        hasher.update(part.as_bytes()).update(&[0]);
    }
    *hasher.finalize().as_bytes()
}

fn measure(device: &Device) -> Result<bool, GpuError> {
    let data: Vec<u32> = (0..BYTES / 4)
        .map(|i| i.wrapping_mul(0x9e37_79b9))
        .collect();
    let input = device.buffer_with("probe input", &data)?;
    let lanes = match device.info().kind {
        DeviceKind::Cpu => CPU_LANES,
        _ => GPU_LANES,
    };
    let output = device.buffer("probe output", u64::from(4 * lanes))?;
    let time = |entry: &str, binding: u32| {
        let kinds = [(1, BindingKind::Storage), (binding, BindingKind::Storage)];
        let spirv = kernel::compile(include_str!("loads.wgsl"), entry)?;
        let pipeline = device.pipeline("loads probe", &spirv, entry, &kinds, [64, 1, 1])?;
        let group = device.bind(&pipeline, &[(1, &output, None), (binding, &input, None)])?;
        // The first run compiles.
        device.dispatch(&pipeline, &group, [1, 1, 1])?;
        let mut quickest = Duration::MAX;
        for _ in 0..RUNS {
            let start = Instant::now();
            device.dispatch(&pipeline, &group, [lanes / 64, 1, 1])?;
            quickest = quickest.min(start.elapsed());
        }
        Ok::<f64, GpuError>(quickest.as_secs_f64())
    };
    let words = time("in_words", 0)?;
    let doublewords = time("in_doublewords", 2)?;
    Ok(doublewords < words * (1.0 - WORTHWHILE))
}
