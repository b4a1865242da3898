//! What to render, and how.

use super::error::RenderError;
use crate::gpu::Loads;

/// Settings of one render. Together with the scene, the shaders, the device and the guidance, which follows from
/// these ([`train`](super::train)), they decide every bit of the picture.
#[derive(Debug, Clone, PartialEq)]
pub struct Settings {
    /// Columns of the picture, 1 to 65,536.
    pub width: u32,
    /// Rows of the picture, 1 to 65,536.
    pub height: u32,
    /// Samples a pixel, 1 to 2³² − 1.
    pub spp: u64,
    /// Index of the first sample, so that a render can be split; 0 for a whole one.
    pub first_sample: u64,
    /// Index into [`crate::scene::Scene::cameras`].
    pub camera: usize,
    /// Name of a file in `shaders/integrator`.
    pub integrator: String,
    /// Name of a file in `shaders/sampler`.
    pub sampler: String,
    /// Edges of the longest path: 1 shows emitters seen directly, 2 adds direct light, and so on.
    pub max_depth: u32,
    /// Seed of the sampler.
    pub seed: u32,
    /// Values for `override` declarations of the shaders.
    pub overrides: Vec<(String, f64)>,
    /// Compile with bounds checks, for edited shaders.
    pub checked: bool,
    /// Count rays, and the elements of the acceleration structure that they look at.
    pub stats: bool,
    /// Keep the names of functions and variables in the SPIR-V.
    pub debug_names: bool,
    /// Tiles of 8 × 8 pixels in a piece of work, instead of as many as take about 200 ms. No bit of
    /// the picture depends on it.
    pub piece_tiles: Option<u32>,
    /// Samples a pixel in a pass over the picture, instead of as many as take about two seconds. No bit
    /// of the picture depends on it.
    pub pass_samples: Option<u64>,
    /// How to read the acceleration structure, the film and other large arrays, where not in words; the device must have it
    /// ([`Device::quickest_loads`](crate::gpu::Device::quickest_loads)). No bit of the picture depends on it.
    pub loads: Loads,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            width: 512,
            height: 512,
            spp: 64,
            first_sample: 0,
            camera: 0,
            integrator: "path".into(),
            sampler: "sobol".into(),
            max_depth: 8,
            seed: 0,
            overrides: Vec::new(),
            checked: false,
            stats: false,
            debug_names: false,
            piece_tiles: None,
            pass_samples: None,
            loads: Loads::default(),
        }
    }
}

impl Settings {
    /// Checks the ranges that the documentation of the fields gives.
    pub fn check(&self) -> Result<(), RenderError> {
        let size_fits = (1..=65_536).contains(&self.width) && (1..=65_536).contains(&self.height);
        if !size_fits {
            return Err(RenderError::Setting(format!(
                "a picture of {} by {} pixels cannot be rendered: each side must be between 1 and 65536",
                self.width, self.height
            )));
        }
        if self.spp == 0 || self.spp > u64::from(u32::MAX) {
            return Err(RenderError::Setting(format!(
                "{} samples a pixel cannot be rendered: ask for 1 to 4294967295",
                self.spp
            )));
        }
        if self.max_depth == 0 {
            return Err(RenderError::Setting(
                "a maximum depth of 0 shows nothing: 1 shows emitters seen directly".into(),
            ));
        }
        Ok(())
    }
}
