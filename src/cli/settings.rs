//! From arguments to [`Settings`].

use anyhow::{Context, Result};

use super::args::RenderArgs;
use crate::render::{Settings, program};
use crate::scene::{Camera, Projection, Scene};
use crate::shader::ShaderLibrary;

/// Pixels along the longer side, unless `--size` is given.
const DEFAULT_SIDE: f64 = 512.0;
/// The AOV that is no integrator.
pub const VARIANCE: &str = "variance";

/// Refuses what needs no scene to be refused: ranges, unknown integrators and samplers.
///
/// # Errors
/// The first of them.
pub fn check_early(args: &RenderArgs, library: &ShaderLibrary) -> Result<()> {
    let settings = with_camera(args, 0, &Camera::default());
    settings.check()?;
    program::choice_files(library, &settings)?;
    for integrator in aov_integrators(args) {
        let aov = Settings {
            integrator: integrator.clone(),
            ..settings.clone()
        };
        program::choice_files(library, &aov).context("--aov")?;
    }
    Ok(())
}

/// The settings for a loaded scene.
///
/// # Errors
/// The scene has no such camera.
pub fn of(args: &RenderArgs, scene: &Scene) -> Result<Settings> {
    let found = scene.find_camera(&args.camera);
    let camera = found.with_context(|| args.file.display().to_string())?;
    Ok(with_camera(args, camera, &scene.cameras[camera]))
}

/// Paths of the picture, at most: how many they are may depend on the scene's camera.
pub fn most_paths(args: &RenderArgs) -> u64 {
    let [width, height] = args.size.unwrap_or([DEFAULT_SIDE as u32; 2]);
    (u64::from(width) * u64::from(height)).saturating_mul(args.spp)
}

/// The integrators that `--aov` names, each once.
pub fn aov_integrators(args: &RenderArgs) -> Vec<&String> {
    let mut names: Vec<&String> = Vec::new();
    for name in args.aov.iter().filter(|name| *name != VARIANCE) {
        if !names.contains(&name) {
            names.push(name);
        }
    }
    names
}

fn with_camera(args: &RenderArgs, camera: usize, placed: &Camera) -> Settings {
    let [width, height] = args
        .size
        .unwrap_or_else(|| default_size(&placed.projection));
    Settings {
        width,
        height,
        spp: args.spp,
        camera,
        integrator: args.integrator.clone(),
        sampler: args.sampler.clone(),
        max_depth: args.max_depth,
        seed: args.seed,
        overrides: args.set.clone(),
        checked: args.checked,
        stats: args.stats,
        debug_names: args.spirv.is_some(),
        ..Settings::default()
    }
}

/// 512 pixels along the longer side, in the camera's shape.
fn default_size(projection: &Projection) -> [u32; 2] {
    let aspect = match *projection {
        Projection::Perspective { aspect, .. } => aspect.unwrap_or(1.0),
        Projection::Orthographic { xmag, ymag } => (xmag / ymag).abs(),
        Projection::Panorama => 2.0,
    };
    let side = |share: f64| (DEFAULT_SIDE * share).round().clamp(1.0, DEFAULT_SIDE) as u32;
    match aspect.is_finite() && aspect > 0.0 {
        true => [side(aspect.min(1.0)), side((1.0 / aspect).min(1.0))],
        false => [side(1.0); 2],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_default_size_has_the_camera_s_shape() {
        let size = |aspect| default_size(&Projection::Perspective { yfov: 1.0, aspect });
        assert_eq!(size(None), [512, 512]);
        assert_eq!(size(Some(2.0)), [512, 256]);
        assert_eq!(size(Some(0.5)), [256, 512]);
        assert_eq!(size(Some(1e9)), [512, 1]);
        assert_eq!(size(Some(f64::NAN)), [512, 512]);
    }
}
