//! The report that `--json` asks for.

use std::time::Instant;

use serde::{Serialize, Serializer};

use super::args::RenderArgs;
use super::bvh_report::BvhReport;
use super::guiding_report::GuidingReport;
use super::lights_report::LightsReport;
use super::load;
use super::message::Warnings;
use super::optimization::Optimization;
use crate::gpu::{DeviceInfo, Loads};
use crate::host::stages::{Startup, startup};
use crate::render::{Film, Progress, Settings};
use crate::scene::Scene;

/// Everything that a script may want to know about a render.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Report {
    /// Of étendue.
    pub version: &'static str,
    /// The scene's file.
    pub scene: String,
    /// BLAKE3 over all bytes read for it.
    pub scene_hash: String,
    /// Index, name and moment of the animation; null where none poses the scene.
    pub animation: Option<String>,
    /// Index and name of the camera.
    pub camera: String,
    /// Radius of its lens, metres; only where it has one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lens_radius: Option<f64>,
    /// Distance of the plane in focus, metres; only where it has a lens, null if far away.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub focus_distance: Option<f64>,
    /// The device's name.
    pub device: String,
    /// Its driver.
    pub driver: String,
    /// How much it optimizes kernels: `quick` or `full`.
    pub optimization: &'static str,
    /// What kernels read memory in where not in words, as a measurement has it.
    pub loads: Loads,
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Samples a pixel; after an interruption the mean of what was reached.
    pub spp: Spp,
    /// As asked for.
    pub seed: u32,
    /// As asked for.
    pub integrator: String,
    /// As asked for.
    pub sampler: String,
    /// As asked for.
    pub max_depth: u32,
    /// Wall time by phase.
    pub seconds: Seconds,
    /// Where the time goes until the first samples are finished.
    pub startup: Startup,
    /// Samples per second of the render phase; three to four times as many where `optimization` is `full`.
    pub paths_per_second: f64,
    /// With `--stats` only.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rays: Option<Rays>,
    /// Both kinds together, over the render phase; with `--stats` only.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rays_per_second: Option<f64>,
    /// Of all instances.
    pub triangles: u64,
    /// The acceleration structure.
    pub bvh: BvhReport,
    /// The lights, and how one is chosen.
    pub lights: LightsReport,
    /// Whether paths were guided.
    pub guiding: GuidingReport,
    /// Most bytes of device memory held at once.
    pub device_bytes: u64,
    /// Mean over the picture, W·sr⁻¹·m⁻², linear Rec. 709.
    pub mean_radiance: [f64; 3],
    /// [`Film::relative_error`]; null where it has no meaning.
    pub relative_error: Option<f64>,
    /// Samples with a NaN or infinite radiance; they are in no mean.
    pub non_finite_samples: u64,
    /// Whether the user stopped it.
    pub interrupted: bool,
    /// Pictures written.
    pub outputs: Vec<String>,
    /// All warnings.
    pub warnings: Vec<String>,
}

/// Wall time of each phase, seconds. The device is opened while the scene is read, and found before where the kernel may be
/// compiled quickly.
#[derive(Debug, Clone, Copy, Default, Serialize)]
pub struct Seconds {
    /// Reading the scene and the environment.
    pub load: f64,
    /// Flattening the scene and building its acceleration structure.
    pub accel: f64,
    /// Opening the device.
    pub device: f64,
    /// Copying the scene to it.
    pub upload: f64,
    /// The training pass of a guide, its compilation included.
    pub guide: f64,
    /// Composing and compiling the shader, the driver's part included.
    pub compile: f64,
    /// Drawing the picture's samples.
    pub render: f64,
    /// Compiling and rendering the AOVs.
    pub aov: f64,
    /// Writing the pictures.
    pub write: f64,
    /// From the start of the program to the report.
    pub total: f64,
}

/// Rays traced.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Rays {
    /// For the closest hit.
    pub closest: u64,
    /// For any hit: shadow rays.
    pub any: u64,
    /// Nodes of the acceleration structure that a ray of either kind looks at, on average; null
    /// without a ray, and none in a list of triangles.
    pub nodes_per_ray: Option<f64>,
    /// Pairs of triangles likewise: those tested, or all of a list.
    pub pairs_per_ray: Option<f64>,
}

impl Rays {
    fn of(film: &Film) -> Self {
        let (closest, any) = film.rays();
        let rays = closest + any;
        let share = |n: u64| (rays > 0).then(|| n as f64 / rays as f64);
        Self {
            closest,
            any,
            nodes_per_ray: share(film.steps.nodes),
            pairs_per_ray: share(film.steps.pairs),
        }
    }
}

/// Samples a pixel: a whole number unless the render was interrupted.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Spp(pub f64);

impl std::fmt::Display for Spp {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        self.0.fmt(f)
    }
}

impl Serialize for Spp {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self.0.fract() == 0.0 {
            true => serializer.serialize_u64(self.0 as u64),
            false => serializer.serialize_f64(self.0),
        }
    }
}

impl Report {
    /// What is known before rendering.
    pub fn new(args: &RenderArgs, scene: &Scene, settings: &Settings, device: &DeviceInfo) -> Self {
        let lens = scene.cameras[settings.camera].lens;
        let hex = |hash: &[u8]| hash.iter().map(|byte| format!("{byte:02x}")).collect();
        Self {
            version: env!("CARGO_PKG_VERSION"),
            scene: args.file.display().to_string(),
            scene_hash: hex(&scene.hash),
            animation: load::pose(scene),
            camera: format!(
                "{} {:?}",
                settings.camera, scene.cameras[settings.camera].name
            ),
            lens_radius: lens.map(|lens| lens.radius),
            focus_distance: lens.map(|lens| lens.focus_distance),
            device: device.name.clone(),
            driver: device.driver.clone(),
            optimization: Optimization::of(device).name(),
            loads: settings.loads,
            width: settings.width,
            height: settings.height,
            seed: settings.seed,
            integrator: settings.integrator.clone(),
            sampler: settings.sampler.clone(),
            max_depth: settings.max_depth,
            triangles: scene.triangle_count(),
            ..Self::default()
        }
    }

    /// Adds what the film says, and a warning where it says something bad.
    pub fn add_film(
        &mut self,
        film: &Film,
        progress: &Progress,
        stats: bool,
        warnings: &mut Warnings,
    ) {
        self.spp = Spp(film.samples() as f64 / film.pixels.len() as f64);
        self.seconds.render = progress.elapsed.as_secs_f64();
        self.startup = startup();
        self.paths_per_second = progress.paths_per_second;
        self.mean_radiance = film.mean_radiance();
        self.relative_error = film.relative_error();
        self.non_finite_samples = film.non_finite_samples();
        warn_non_finite(film, "the picture", warnings);
        if stats {
            let rays = Rays::of(film);
            let traced = (rays.closest + rays.any) as f64;
            self.rays = Some(rays);
            self.rays_per_second = Some(traced / self.seconds.render.max(1e-9));
        }
    }
}

/// Warns of samples that are in no mean.
pub fn warn_non_finite(film: &Film, what: &str, warnings: &mut Warnings) {
    let count = film.non_finite_samples();
    if count > 0 {
        warnings.add(format!(
            "{count} of {} samples of {what} were NaN or infinite and are in no mean: a bug of the shader, or of étendue",
            film.samples()
        ));
    }
}

/// Runs `work` and adds its wall time to a phase.
pub fn timed<T>(seconds: &mut f64, work: impl FnOnce() -> T) -> T {
    let start = Instant::now();
    let result = work();
    *seconds += start.elapsed().as_secs_f64();
    result
}
