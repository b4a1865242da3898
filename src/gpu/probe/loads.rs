//! How scattered memory is read fastest: which of the forms of a kernel to compile. No bit of a result depends on it.
//!
//! A driver that runs shaders on a CPU reads a storage buffer lane by lane, or with gather instructions that take as
//! long for 8 bytes as for 4, and a texel of 16 bytes with one load: measured, not guessed from its name.

use std::time::{Duration, Instant};

use serde::Serialize;

use super::kernel;
use crate::gpu::pipeline::BindingKind;
use crate::gpu::{Buffer, Device, DeviceInfo, DeviceKind, GpuError, compiles_quickly};
use crate::host::Cache;

/// Invocations of a run: some 5 ms of work on two cores, and on a GPU as many as it takes to see more than the dispatch.
const CPU_LANES: u32 = 1 << 11;
const GPU_LANES: u32 = 1 << 14;
/// Bytes that are read from, as in the shader.
const BYTES: u32 = 512 * 64;
/// Runs of each form; the quickest counts.
const RUNS: usize = 4;
/// A form must save this share of the time of those before it to be chosen: in a kernel that has other work to do its
/// pieces cost more.
const WORTHWHILE: f64 = 0.2;
/// What is the same in all forms.
const LOOP: &str = include_str!("loads.wgsl");
const WORDS: &str = "
@group(0) @binding(0) var<storage, read> memory: array<vec4u>;
fn mixed(place: u32) -> vec4u {
    let at = 4u * place;
    return (memory[at] ^ memory[at + 1u]) + (memory[at + 2u] ^ memory[at + 3u]);
}
";
const DOUBLE_WORDS: &str = "
@group(0) @binding(0) var<storage, read> memory: array<u64>;
fn both(at: u32) -> vec4u {
    let a = memory[at];
    let b = memory[at + 1u];
    return vec4u(u32(a), u32(a >> 32u), u32(b), u32(b >> 32u));
}
fn mixed(place: u32) -> vec4u {
    let at = 8u * place;
    return (both(at) ^ both(at + 2u)) + (both(at + 4u) ^ both(at + 6u));
}
";
const TEXELS: &str = "
@group(0) @binding(0) var memory: texture_storage_1d<rgba32uint, read>;
fn mixed(place: u32) -> vec4u {
    let at = 4u * place;
    return (textureLoad(memory, at) ^ textureLoad(memory, at + 1u))
        + (textureLoad(memory, at + 2u) ^ textureLoad(memory, at + 3u));
}
";
/// Texel buffers that a device must allow, to be asked: as many as a scene's arrays may have pages.
const TEXEL_BUFFERS: u32 = 64;

/// Which forms are faster than words in storage buffers.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
pub struct Loads {
    /// 64-bit integers in storage buffers.
    pub doublewords: bool,
    /// Texel buffers: faster than both, so what can be one is one.
    pub texels: bool,
}

impl Loads {
    /// What a device can do, faster or not.
    pub fn possible(info: &DeviceInfo) -> Self {
        Self {
            doublewords: info.int64,
            texels: info.max_texel_buffers >= TEXEL_BUFFERS,
        }
    }

    /// The same without texels: what is mostly at one place for all lanes is quicker in a storage buffer.
    pub fn without_texels(self) -> Self {
        Self {
            texels: false,
            ..self
        }
    }
}

/// The forms that are faster; what was measured once for a device and driver is kept.
pub(in crate::gpu) fn quickest(device: &Device, cache: &Cache) -> Result<Loads, GpuError> {
    if Loads::possible(device.info()) == Loads::default() {
        return Ok(Loads::default());
    }
    if let Some(known) = kept(device, cache) {
        return Ok(known);
    }
    let loads = Measurement::new(device)?.quickest()?;
    let kept = [u8::from(loads.doublewords), u8::from(loads.texels)];
    cache.put("loads", &key(device), &kept);
    Ok(loads)
}

/// What was measured before, if that was kept.
pub(in crate::gpu) fn kept(device: &Device, cache: &Cache) -> Option<Loads> {
    match cache.get("loads", &key(device)).as_deref() {
        Some(&[doublewords, texels]) => Some(Loads {
            doublewords: doublewords == 1,
            texels: texels == 1,
        }),
        _ => None,
    }
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
        LOOP,
        WORDS,
        DOUBLE_WORDS,
        TEXELS,
        compiles,
    ] {
        hasher.update(part.as_bytes()).update(&[0]);
    }
    *hasher.finalize().as_bytes()
}

struct Measurement<'a> {
    device: &'a Device,
    lanes: u32,
    input: Buffer,
    output: Buffer,
}

impl<'a> Measurement<'a> {
    fn new(device: &'a Device) -> Result<Self, GpuError> {
        let data: Vec<u32> = (0..BYTES / 4)
            .map(|i| i.wrapping_mul(0x9e37_79b9))
            .collect();
        let lanes = match device.info().kind {
            DeviceKind::Cpu => CPU_LANES,
            _ => GPU_LANES,
        };
        Ok(Self {
            device,
            lanes,
            input: device.buffer_with("probe input", &data)?,
            output: device.buffer("probe output", u64::from(4 * lanes))?,
        })
    }

    fn quickest(&self) -> Result<Loads, GpuError> {
        let possible = Loads::possible(self.device.info());
        let mut best = self.seconds(WORDS, BindingKind::Storage)?;
        let mut is_worth = |seconds: f64| {
            let is_worth = seconds < best * (1.0 - WORTHWHILE);
            best = best.min(seconds);
            is_worth
        };
        let mut loads = Loads::default();
        if possible.doublewords {
            let kind = BindingKind::Storage;
            loads.doublewords = is_worth(self.seconds(DOUBLE_WORDS, kind)?);
        }
        if possible.texels {
            let kind = BindingKind::Texels { words: 4 };
            loads.texels = is_worth(self.seconds(TEXELS, kind)?);
        }
        Ok(loads)
    }

    /// What the quickest run of a form takes.
    fn seconds(&self, form: &str, kind: BindingKind) -> Result<f64, GpuError> {
        let device = self.device;
        let kinds = [(0, kind), (1, BindingKind::Storage)];
        let spirv = kernel::compile(&format!("{form}{LOOP}"))?;
        let pipeline = device.pipeline("loads probe", &spirv, "main", &kinds, [64, 1, 1])?;
        let buffers = [(0, &self.input, None), (1, &self.output, None)];
        let group = device.bind(&pipeline, &buffers)?;
        // The first run compiles.
        device.dispatch(&pipeline, &group, [1, 1, 1])?;
        let mut quickest = Duration::MAX;
        for _ in 0..RUNS {
            let start = Instant::now();
            device.dispatch(&pipeline, &group, [self.lanes / 64, 1, 1])?;
            quickest = quickest.min(start.elapsed());
        }
        Ok(quickest.as_secs_f64())
    }
}
