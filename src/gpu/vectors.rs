//! The width of SIMD of a driver that runs shaders on the CPU.

/// lavapipe's own variable for the bits of its vectors.
const VARIABLE: &str = "LP_NATIVE_VECTOR_WIDTH";

/// Lets lavapipe use vectors of 512 bits where the processor has them: by default it takes 256, and
/// leaves half of each instruction unused. Does nothing where the user has decided.
///
/// To be called at the start of the program, before there is a second thread.
pub fn prefer_widest_vectors() {
    if has_512_bits() && std::env::var_os(VARIABLE).is_none() {
        // SAFETY: no other thread reads or writes the environment, for by this function's contract there is none.
        unsafe { std::env::set_var(VARIABLE, "512") };
    }
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
