//! How lavapipe, the driver that runs shaders on the CPU, compiles them. It listens to variables of the environment.

use std::num::NonZero;
use std::thread::available_parallelism;

use super::info::DeviceInfo;

/// The bits of its vectors.
const VECTOR_WIDTH: &str = "LP_NATIVE_VECTOR_WIDTH";

/// A list of what it may do to be faster, or not; it is read when the first device of a process is opened.
const PERFORMANCE: &str = "GALLIVM_PERF";
/// The entry that leaves out nearly all of LLVM's optimization.
const NO_OPTIMIZATION: &str = "nopt";

/// Its number of threads, and how many it has at most.
const THREADS: &str = "LP_NUM_THREADS";
const MOST_THREADS: usize = 32;

/// The driver's name, and the first version that compiles quickly without optimization: that of Debian 12, 22.3.6, then
/// takes minutes for what takes it seconds (docs/kernel.md).
const DRIVER: &str = "llvmpipe, Mesa ";
const FIRST_QUICK: u32 = 25;

/// Lets lavapipe use vectors of 512 bits where the processor has them: by default it takes 256, and
/// leaves half of each instruction unused. Does nothing where the user has decided.
///
/// To be called at the start of the program, before there is a second thread.
pub(crate) fn prefer_widest_vectors() {
    if has_512_bits() && std::env::var_os(VECTOR_WIDTH).is_none() {
        // SAFETY: no other thread reads or writes the environment, for by this function's contract there is none.
        unsafe { std::env::set_var(VECTOR_WIDTH, "512") };
    }
}

/// Lets lavapipe compile without optimization, or with it: without, kernels are there in a third to a half of the time, and
/// run three to four times as long. They compute the same to the bit, as the order of operations on floats is not LLVM's to change.
///
/// To be called before a device is opened, while the program has no second thread.
pub(crate) fn set_optimization(is_on: bool) {
    if is_on != is_optimization_off() {
        return;
    }
    let list = std::env::var(PERFORMANCE).unwrap_or_default();
    let mut entries: Vec<_> = entries(&list).filter(|e| *e != NO_OPTIMIZATION).collect();
    if !is_on {
        entries.push(NO_OPTIMIZATION);
    }
    // SAFETY: by this function's contract no thread of ours reads or writes the environment, and a driver that has been
    // asked for its devices at most does nothing by itself.
    unsafe { std::env::set_var(PERFORMANCE, entries.join(",")) };
}

/// Whether the driver of a device can compile without optimization, and is quick about it.
pub(super) fn can_compile_quickly(driver: &str) -> bool {
    let version = driver.strip_prefix(DRIVER).unwrap_or_default();
    let major = version.split('.').next().unwrap_or_default();
    major.parse().is_ok_and(|major: u32| major >= FIRST_QUICK)
}

/// Whether a device compiles without optimization, if it was opened since the environment last changed.
pub fn compiles_quickly(device: &DeviceInfo) -> bool {
    device.driver.starts_with(DRIVER) && is_optimization_off()
}

fn is_optimization_off() -> bool {
    let list = std::env::var(PERFORMANCE).unwrap_or_default();
    entries(&list).any(|entry| entry == NO_OPTIMIZATION)
}

/// The entries of such a list, taken apart as Mesa does.
fn entries(list: &str) -> impl Iterator<Item = &str> {
    let is_word = |c: char| c.is_ascii_alphanumeric() || c == '_';
    list.split(move |c| !is_word(c)).filter(|e| !e.is_empty())
}

/// Threads on which lavapipe runs shaders.
pub(crate) fn threads() -> usize {
    let asked = std::env::var(THREADS).ok().and_then(|n| n.parse().ok());
    let cores = || available_parallelism().map_or(1, NonZero::get);
    asked.unwrap_or_else(cores).clamp(1, MOST_THREADS)
}

#[cfg(target_arch = "x86_64")]
fn has_512_bits() -> bool {
    // What LLVM needs to use them for all that a shader does.
    is_x86_feature_detected!("avx512f")
        && is_x86_feature_detected!("avx512bw")
        && is_x86_feature_detected!("avx512dq")
        && is_x86_feature_detected!("avx512vl")
}

#[cfg(not(target_arch = "x86_64"))]
fn has_512_bits() -> bool {
    false
}

#[cfg(test)]
mod tests {
    use super::{can_compile_quickly, entries};

    #[test]
    fn lavapipe_since_mesa_25_compiles_quickly() {
        for driver in [
            "llvmpipe, Mesa 25.0.7-2~bpo12+1 (LLVM 15.0.6)",
            "llvmpipe, Mesa 26.2.0-devel (git-0123456789) (LLVM 19.1.7)",
        ] {
            assert!(can_compile_quickly(driver), "{driver}");
        }
        for driver in [
            "llvmpipe, Mesa 22.3.6 (LLVM 15.0.6)",
            "NVIDIA, 580.65.06",
            "radv, Mesa 26.1.6",
            "llvmpipe, Mesa",
            "",
        ] {
            assert!(!can_compile_quickly(driver), "{driver}");
        }
    }

    #[test]
    fn lists_are_taken_apart_as_mesa_does() {
        let list: Vec<_> = entries("nopt, rho_approx;no_quad_lod,").collect();
        assert_eq!(list, ["nopt", "rho_approx", "no_quad_lod"]);
    }
}
