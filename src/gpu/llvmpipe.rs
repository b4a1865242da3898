//! How lavapipe, the driver that runs shaders on the CPU, compiles them. It listens to variables of the environment.

use super::info::DeviceInfo;

/// The bits of its vectors.
const VECTOR_WIDTH: &str = "LP_NATIVE_VECTOR_WIDTH";

/// A list of what it may do to be faster, or not; read when a device is opened.
const PERFORMANCE: &str = "GALLIVM_PERF";
/// The entry that leaves out nearly all of LLVM's optimization.
const NO_OPTIMIZATION: &str = "nopt";

/// The driver's name, and the first version that compiles quickly without optimization: that of Debian 12, 22.3.6, then
/// takes minutes for what takes it seconds (docs/kernel.md).
const DRIVER: &str = "llvmpipe, Mesa ";
const FIRST_QUICK: u32 = 25;

/// Lets lavapipe use vectors of 512 bits where the processor has them: by default it takes 256, and
/// leaves half of each instruction unused. Does nothing where the user has decided.
///
/// To be called at the start of the program, before there is a second thread.
pub fn prefer_widest_vectors() {
    if has_512_bits() && std::env::var_os(VECTOR_WIDTH).is_none() {
        // SAFETY: no other thread reads or writes the environment, for by this function's contract there is none.
        unsafe { std::env::set_var(VECTOR_WIDTH, "512") };
    }
}

/// Lets lavapipe compile without optimization: kernels are there in a fraction of the time, and run several times as long.
/// They compute the same to the bit, as the order of operations on floats is not LLVM's to change.
///
/// To be called before a device is opened, while no other thread reads or writes the environment.
pub fn compile_quickly() {
    if !is_variable_set() {
        let others = std::env::var(PERFORMANCE).map(|list| list + ",");
        let list = others.unwrap_or_default() + NO_OPTIMIZATION;
        // SAFETY: no other thread reads or writes the environment, for by this function's contract there is none.
        unsafe { std::env::set_var(PERFORMANCE, list) };
    }
}

/// Whether the driver of a device can compile without optimization, and is quick about it.
pub(super) fn can_compile_quickly(driver: &str) -> bool {
    let version = driver.strip_prefix(DRIVER).unwrap_or_default();
    let major = version.split('.').next().unwrap_or_default();
    major.parse().is_ok_and(|major: u32| major >= FIRST_QUICK)
}

/// Whether a device that is opened now compiles so.
pub fn compiles_quickly(device: &DeviceInfo) -> bool {
    device.driver.starts_with(DRIVER) && is_variable_set()
}

fn is_variable_set() -> bool {
    let list = std::env::var(PERFORMANCE).unwrap_or_default();
    list.split(',').any(|entry| entry.trim() == NO_OPTIMIZATION)
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
    use super::can_compile_quickly;

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
}
