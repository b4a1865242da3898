//! How much the driver optimizes kernels, where it has a choice: a picture that is drawn in less time than its kernel
//! takes to compile had better have one that is there sooner. And whether it is worth a measurement.

use std::str::FromStr;

use super::args::RenderArgs;
use super::settings;
use crate::gpu::{Device, DeviceInfo, GpuError, Loads, compiles_quickly, threads};
use crate::host::{Cache, names};

/// How much kernels are optimized. What they compute is the same to the bit.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Optimization {
    /// Little for pictures of few paths.
    #[default]
    Auto,
    /// As little as possible.
    Quick,
    /// As the driver does by itself.
    Full,
}

/// Paths for each thread of the driver up to which a kernel that is compiled quickly is asked for. Drawing the picture
/// and compiling take as long in both ways at 1.1 to 24 times as many, by scene and driver (docs/kernel.md).
const QUICK_PATHS: u64 = 3 << 14;

/// Paths for each thread that are drawn before it is measured how memory is read fastest: on two threads without AVX-512
/// in 0.02 to 0.14 s, where the measurement takes 0.14 to 0.17 s.
const UNMEASURED_PATHS: u64 = QUICK_PATHS / 8;

/// Whether a picture has so few paths.
fn is_drawn_at_once(args: &RenderArgs) -> bool {
    settings::most_paths(args) <= UNMEASURED_PATHS * threads() as u64
}

/// How a picture's kernel reads memory: as was measured, if it has paths enough.
///
/// # Errors
/// As [`Device::quickest_loads`].
pub fn loads(args: &RenderArgs, device: &Device, cache: &Cache) -> Result<Loads, GpuError> {
    match is_drawn_at_once(args) {
        true => Ok(device.likely_loads(cache)),
        false => device.quickest_loads(cache),
    }
}

impl Optimization {
    /// Its name: `auto`, `quick` or `full`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Auto => "auto",
            Self::Quick => "quick",
            Self::Full => "full",
        }
    }

    /// Whether a render wants a kernel that is compiled quickly, if the driver can do that.
    pub fn wants_quick(args: &RenderArgs) -> bool {
        match args.optimization {
            Self::Auto => settings::most_paths(args) <= QUICK_PATHS * threads() as u64,
            Self::Quick => true,
            Self::Full => false,
        }
    }

    /// What a device that has been opened does: `quick` or `full`.
    pub fn of(device: &DeviceInfo) -> Self {
        match compiles_quickly(device) {
            true => Self::Quick,
            false => Self::Full,
        }
    }
}

impl std::fmt::Display for Optimization {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for Optimization {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        let all = [Self::Auto, Self::Quick, Self::Full];
        names::find(&all, Self::name, name)
    }
}

#[cfg(test)]
mod tests {
    use clap::Parser;

    use super::*;

    #[derive(Parser)]
    struct Line {
        #[command(flatten)]
        args: RenderArgs,
    }

    fn args(line: &str) -> RenderArgs {
        let words = ["render", "scene.gltf"].into_iter().chain(line.split(' '));
        Line::parse_from(words).args
    }

    #[test]
    fn few_paths_want_a_quick_kernel() {
        let wants = |line: &str| Optimization::wants_quick(&args(line));
        let many = (QUICK_PATHS * threads() as u64).to_string();
        assert!(wants("--size 64x64 --spp 16"));
        assert!(wants(&format!("--size 1x1 --spp {many}")));
        assert!(!wants(&format!("--size 2x1 --spp {many}")));
        assert!(!wants(&format!("--size 4096x4096 --spp {}", u64::MAX)));
        assert!(!wants("--size 64x64 --spp 16 --optimization full"));
        assert!(wants("--size 4096x4096 --optimization quick"));
    }

    #[test]
    fn few_paths_are_drawn_at_once() {
        let at_once = |line: &str| is_drawn_at_once(&args(line));
        assert!(at_once("--size 64x64 --spp 1"));
        assert!(at_once(&format!("--size 64x96 --spp {}", threads())));
        assert!(!at_once(&format!("--size 64x97 --spp {}", threads())));
    }
}
