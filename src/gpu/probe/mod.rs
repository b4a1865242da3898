//! What the driver does that no property tells: measured by a tiny kernel.

mod kernel;
pub(super) mod loads;

use bytemuck::{Pod, Zeroable};
use serde::Serialize;

use super::device::Device;
use super::error::GpuError;
use super::pipeline::BindingKind;

/// Trips that the loop under test is asked for.
const TRIPS: u32 = 200_000;
/// Trips of each of the two loops that together exceed a limit of 65,535, but not for any one invocation.
const UNEVEN: u32 = 40_000;
const SEED: u32 = 12_345;
/// Invocations of a workgroup, and words that each writes.
const LANES: usize = 16;
const WORDS: usize = 8;

/// Measured behaviour of a device's shaders.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Probe {
    /// Trips after which a loop ends although its condition still holds; `None` if 200,000 trips really ran.
    /// Mesa's lavapipe before 25.0 has such a limit and says nothing.
    pub loop_limit: Option<u32>,
    /// Whether all loops that an invocation runs in a dispatch draw on one such limit.
    pub limit_spans_loops: bool,
    /// Whether the invocations of a SIMD group draw on one such limit, so that a trip of one counts for all.
    /// On lavapipe 22.3.6 each SIMD group of each workgroup has a budget of its own.
    pub limit_spans_lanes: bool,
    /// Whether `fma(a, b, c)` rounds once.
    pub fused_fma: bool,
    /// Whether the driver turns `a * b + c` into a fused operation.
    pub contracts: bool,
    /// Whether a result below 2⁻¹²⁶ becomes zero.
    pub flushes_denormals: bool,
}

#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct Inputs {
    trips: [u32; 8],
    seed: u32,
    near_one: f32,
    minus_square: f32,
    smallest: f32,
    half: f32,
}

impl Inputs {
    const ALL: Self = Self {
        trips: [
            // Workgroup 0: every invocation runs both loops to the full.
            TRIPS, TRIPS, TRIPS, TRIPS,
            // Workgroup 1: even invocations run the first loop, odd ones the second.
            UNEVEN, 0, 0, UNEVEN,
        ],
        seed: SEED,
        near_one: 1.0 + 1.0 / 4096.0,
        minus_square: -(1.0 + 1.0 / 2048.0),
        smallest: f32::MIN_POSITIVE,
        half: 0.5,
    };
}

/// Runs the kernel. See [`Device::probe`].
pub(super) fn run(device: &Device) -> Result<Probe, GpuError> {
    let inputs = device.buffer_with("probe inputs", &[Inputs::ALL])?;
    let words = 2 * LANES * WORDS;
    let results = device.buffer("probe results", 4 * words as u64)?;
    let bindings = [(0, BindingKind::Storage), (1, BindingKind::Storage)];
    let workgroup = [LANES as u32, 1, 1];
    let pipeline = device.pipeline("probe", &kernel::spirv()?, "main", &bindings, workgroup)?;
    let group = device.bind(&pipeline, &[(0, &inputs, None), (1, &results, None)])?;
    device.dispatch(&pipeline, &group, [2, 1, 1])?;
    evaluate(&device.read(&results, 0, words as u64)?)
}

/// What the words of all invocations say.
fn evaluate(words: &[u32]) -> Result<Probe, GpuError> {
    let row = |workgroup: usize, lane: usize| &words[WORDS * (LANES * workgroup + lane)..][..WORDS];
    let (full, odd) = (row(0, 0), row(1, 1));
    let first = trips(full[0])?;
    let loop_limit = (first < TRIPS).then_some(first);
    Ok(Probe {
        loop_limit,
        limit_spans_loops: loop_limit.is_some() && trips(full[1])? < first,
        limit_spans_lanes: loop_limit.is_some() && trips(odd[1])? < UNEVEN,
        fused_fma: f32::from_bits(full[2]) == (-24_f32).exp2(),
        contracts: f32::from_bits(full[3]) == (-24_f32).exp2(),
        flushes_denormals: f32::from_bits(full[4]) == 0.0,
    })
}

/// How many steps of the generator lead from the seed to `state`.
fn trips(state: u32) -> Result<u32, GpuError> {
    let step = |state: &u32| Some(state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223));
    let mut states = std::iter::successors(Some(SEED), step).take(TRIPS as usize + 1);
    let found = states.position(|reached| reached == state);
    found
        .map(|count| count as u32)
        .ok_or_else(|| GpuError::Probe {
            reason: format!("no number of loop trips leads to the result {state:#x}"),
        })
}

#[cfg(test)]
mod tests {
    use super::{LANES, SEED, WORDS, evaluate, kernel, trips};

    #[test]
    fn the_kernel_compiles_without_a_device() {
        assert!(kernel::spirv().expect("valid WGSL").len() > 5);
    }

    #[test]
    fn the_state_tells_the_trips() {
        assert_eq!(trips(SEED).expect("no trip"), 0);
        assert_eq!(
            trips(SEED.wrapping_mul(1_664_525).wrapping_add(1_013_904_223)).expect("one"),
            1
        );
        assert!(trips(SEED.wrapping_sub(1)).is_err());
    }

    #[test]
    fn a_kernel_that_did_not_run_is_an_error() {
        assert!(evaluate(&[0; 2 * LANES * WORDS]).is_err());
    }
}
