//! `etendue render`: the way of a picture through the program.

use std::time::Instant;

use anyhow::{Context, Result};

use super::aov::{self, Stage};
use super::args::RenderArgs;
use super::exit::Exit;
use super::interrupt::Interrupt;
use super::message::{self, Warnings};
use super::metadata::metadata;
use super::outputs::{Outputs, Written};
use super::report::{Report, Seconds, timed, warn_non_finite};
use super::{environment, settings, shaders};
use crate::accel::BuildOptions;
use crate::gpu::Device;
use crate::image::{Channel, Layer, Picture};
use crate::render::{Film, GpuScene, Prepared};
use crate::scene::{Features, Scene, gltf};

/// Integrators that show something in a scene without light.
const NEED_NO_LIGHT: [&str; 4] = ["albedo", "ao", "depth", "normals"];

/// Renders a scene.
///
/// # Errors
/// Bad input, or a device that fails.
pub fn run(args: &RenderArgs) -> Result<Exit> {
    let start = Instant::now();
    let mut time = Seconds::default();
    let mut warnings = Warnings::new(args.quiet);
    let interrupt = Interrupt::install(args.quiet);

    // Refuse what can be refused before any work is done.
    let outputs = Outputs::check(args)?;
    let library = shaders::library(args.shaders.as_deref())?;
    settings::check_early(args, &library)?;

    // From files to buffers and a kernel on the device.
    let scene = timed(&mut time.load, || load(args, &mut warnings))?;
    let mut settings = settings::of(args, &scene)?;
    let device = timed(&mut time.device, || open_device(args))?;
    let options = BuildOptions::default();
    let prepared = timed(&mut time.accel, || {
        Prepared::new(&scene, settings.camera, &options)
    })?;
    warn_of_scene(&scene, &prepared, args, &mut warnings);
    let gpu_scene = timed(&mut time.upload, || GpuScene::upload(&device, &prepared))?;
    let stage = Stage {
        device: &device,
        library: &library,
        scene: &scene,
        prepared: &prepared,
        gpu_scene: &gpu_scene,
    };
    let aovs = aov::plan(args, stage, &mut settings)?;
    let mut renderer = stage.renderer(&settings)?;
    time.compile = renderer.compile_time().as_secs_f64();
    warnings.add_all(&renderer.warnings());
    if args.print_wgsl {
        return message::print(renderer.wgsl()).map(|()| Exit::Fine);
    }

    // From samples to a picture.
    interrupt.arm();
    let _ = aov::run(&mut renderer, &settings, &interrupt, args.quiet)?;
    let film = renderer.film()?;
    let layers = timed(&mut time.aov, || {
        aov::render(args, stage, &aovs, &interrupt, &mut warnings)
    })?;

    // From the picture to files.
    let mut report = Report::new(args, &scene, &settings, device.info());
    report.add_film(&film, &renderer.progress(), args.stats, &mut warnings);
    report.interrupted = interrupt.requested();
    report.device_bytes = device.peak_bytes_in_use();
    let metadata = metadata(args, &settings, &renderer, &report);
    let picture = picture(args, &film, layers, &mut warnings);
    let written = timed(&mut time.write, || outputs.write(&picture, &metadata));
    time.render = report.seconds.render;
    time.total = start.elapsed().as_secs_f64();
    report.seconds = time;
    report.outputs.clone_from(&written.paths);
    report.warnings = warnings.list().to_vec();
    let reported = outputs.write_report(&report);
    Ok(verdict(&report, &written, reported))
}

fn load(args: &RenderArgs, warnings: &mut Warnings) -> Result<Scene> {
    // The environment first: it is read faster, so a mistake in it is found sooner.
    let environment = environment::load(args, warnings)?;
    let options = gltf::LoadOptions {
        scene: args.scene.clone(),
    };
    let mut scene = gltf::load(&args.file, &options)?;
    if environment.is_some() {
        scene.environment = environment;
    }
    let valid = scene.validate();
    valid.with_context(|| args.file.display().to_string())?;
    Ok(scene)
}

fn open_device(args: &RenderArgs) -> Result<Device> {
    let from_variable = || {
        std::env::var("ETENDUE_DEVICE")
            .ok()
            .filter(|s| !s.is_empty())
    };
    let selector = args.device.clone().or_else(from_variable);
    Ok(Device::open(selector.as_deref())?)
}

fn warn_of_scene(scene: &Scene, prepared: &Prepared, args: &RenderArgs, warnings: &mut Warnings) {
    warnings.add_all(&scene.warnings);
    warnings.add_all(&prepared.warnings);
    let dark = !has_light(&prepared.features);
    if dark && !NEED_NO_LIGHT.contains(&args.integrator.as_str()) {
        warnings.add(
            "the scene has no light (no emission, no punctual light, no environment), so the \
             picture will be black: add light from all around with `--env 1`",
        );
    }
}

fn has_light(f: &Features) -> bool {
    let punctual = f.point_light || f.spot_light || f.directional_light;
    punctual || f.emissive || f.environment || f.unlit
}

/// The layers of the file: the picture, the AOVs, the variance.
fn picture(
    args: &RenderArgs,
    film: &Film,
    aovs: Vec<(String, Film)>,
    warnings: &mut Warnings,
) -> Picture {
    let mut picture = Picture::new(film.width as usize, film.height as usize);
    picture.layers.push(layer("", film.channels()));
    for (name, film) in aovs {
        warn_non_finite(&film, &format!("AOV \"{name}\""), warnings);
        picture.layers.push(layer(&name, film.channels()));
    }
    if args.aov.iter().any(|name| name == settings::VARIANCE) {
        let variance = film.variance_channels();
        picture.layers.push(layer(settings::VARIANCE, variance));
    }
    picture
}

fn layer(name: &str, channels: [Vec<f32>; 3]) -> Layer {
    let named = ["R", "G", "B"].into_iter().zip(channels);
    Layer {
        name: name.into(),
        channels: named
            .map(|(name, samples)| Channel {
                name: name.into(),
                samples,
            })
            .collect(),
    }
}

/// Says which outputs failed, and how the program ends.
fn verdict(report: &Report, written: &Written, reported: Result<()>) -> Exit {
    let failed = reported.err();
    written
        .errors
        .iter()
        .chain(&failed)
        .for_each(message::error);
    if !written.errors.is_empty() || failed.is_some() {
        Exit::BadInput
    } else if report.interrupted {
        Exit::Interrupted
    } else {
        Exit::Fine
    }
}
