//! `etendue render`: the way of a picture through the program.

use anyhow::{Context, Result};

use super::aov::{self, Layers};
use super::args::RenderArgs;
use super::bvh_report::BvhReport;
use super::exit::Exit;
use super::guiding_report::GuidingReport;
use super::interrupt::Interrupt;
use super::lights_report::LightsReport;
use super::message::{self, Warnings};
use super::metadata::metadata;
use super::opening::{Loaded, load_and_open, settle_optimization};
use super::optimization::{Optimization, loads};
use super::outputs::Outputs;
use super::progress::ProgressLine;
use super::report::{Report, Seconds, timed};
use super::{camera, settings, shaders};
use crate::gpu::DeviceInfo;
use crate::host::Cache;
use crate::host::stages::{seconds_since_start, stage};
use crate::image::{Channel, Layer, Metadata, Picture};
use crate::render::{
    Film, GpuScene, Guidance, Guiding, Prepared, Renderer, Settings, Stage, Training, train,
};
use crate::scene::{Features, Scene};

/// Integrators that show something in a scene without light.
const NEED_NO_LIGHT: [&str; 4] = ["albedo", "ao", "depth", "normals"];

/// Renders a scene.
///
/// # Errors
/// Bad input, or a device that fails.
pub fn run(args: &RenderArgs) -> Result<Exit> {
    let mut time = Seconds::default();
    let mut warnings = Warnings::new(args.quiet);

    // Refuse what can be refused before any work is done.
    let outputs = Outputs::check(args)?;
    let library = shaders::library(args.shaders.as_deref())?.with_cache(Cache::from_env());
    settings::check_early(args, &library)?;
    let found = settle_optimization(args, &mut time);
    // Starts the second thread.
    let interrupt = Interrupt::install(args.quiet);

    // From files to buffers and a kernel on the device.
    let (loaded, device) = load_and_open(args, found, &mut time, &mut warnings)?;
    let Loaded {
        mut scene,
        mut settings,
        prepared,
    } = loaded;
    settings.loads = stage("loads", || loads(args, &device, library.cache()))?;
    camera::focus(args, &mut scene, &prepared, &settings)?;
    warn_of_scene(&scene, &prepared, args, &mut warnings);
    warn_of_optimization(args, device.info(), &mut warnings);
    let upload = || stage("upload", || GpuScene::upload(&device, &prepared));
    let gpu_scene = timed(&mut time.upload, upload)?;
    let stage = Stage {
        device: &device,
        library: &library,
        scene: &scene,
        prepared: &prepared,
        gpu_scene: &gpu_scene,
    };
    let aovs = aov::plan(args, stage, &mut settings)?;
    let learn = || {
        let mut line = ProgressLine::new("guide", Training::SAMPLES, args.quiet);
        train(stage, &settings, args.guiding, &mut |r, p| {
            line.update(r, p)
        })
    };
    let training = timed(&mut time.guide, learn)?;
    warn_of_guide(args, training.as_ref(), &mut warnings);
    let guidance = training
        .as_ref()
        .map_or(Guidance::default(), Training::guidance);
    let mut renderer = stage.guided_renderer(&settings, guidance)?;
    time.compile = renderer.compile_time().as_secs_f64();
    warnings.add_all(&renderer.warnings());
    if outputs.only_shader {
        return show_shader(args, &renderer).map(|()| Exit::Fine);
    }

    // From samples to a picture.
    interrupt.arm();
    let (film, failure) = draw(&mut renderer, &settings, &interrupt, args.quiet)?;
    let layers = timed(&mut time.aov, || match failure {
        Some(_) => Layers {
            failure,
            ..Layers::default()
        },
        None => aov::render(args, stage, &aovs, &interrupt, &mut warnings),
    });

    // From the picture to files.
    let mut report = Report::new(args, &scene, &settings, device.info());
    report.seconds = time;
    report.bvh = BvhReport::new(args.bvh, &prepared);
    report.lights = LightsReport::new(&prepared);
    report.guiding = GuidingReport::new(args.guiding, training.as_ref());
    report.add_film(&film, &renderer.progress(), args.stats, &mut warnings);
    report.interrupted = interrupt.requested();
    report.device_bytes = device.peak_bytes_in_use();
    report.warnings = warnings.list().to_vec();
    let metadata = metadata(args, &settings, &renderer, &report);
    let picture = picture(args, &film, &layers.films);
    let errors = write(&outputs, &picture, &metadata, &mut report);
    Ok(verdict(&report, layers.failure.into_iter().chain(errors)))
}

/// Prints the WGSL and writes the SPIR-V, in words of this machine's byte order.
fn show_shader(args: &RenderArgs, renderer: &Renderer<'_>) -> Result<()> {
    if let Some(path) = &args.spirv {
        std::fs::write(path, bytemuck::cast_slice(renderer.spirv()))
            .with_context(|| format!("{}: cannot write", path.display()))?;
    }
    match args.print_wgsl {
        true => message::print(renderer.wgsl()),
        false => Ok(()),
    }
}

/// Draws the samples. Should the device give up on the way, what it has drawn until then is worth
/// keeping: gives the film and the reason.
fn draw(
    renderer: &mut Renderer<'_>,
    settings: &Settings,
    interrupt: &Interrupt,
    quiet: bool,
) -> Result<(Film, Option<anyhow::Error>)> {
    match aov::run(renderer, settings, interrupt, quiet) {
        Ok(_) => Ok((renderer.film()?, None)),
        Err(error) => match renderer.film() {
            Ok(film) if film.samples() > 0 => Ok((film, Some(error.into()))),
            _ => Err(error.into()),
        },
    }
}

/// Writes all that was asked for. An output that fails does not keep the others from being written.
fn write(
    outputs: &Outputs,
    picture: &Picture,
    metadata: &Metadata,
    report: &mut Report,
) -> Vec<anyhow::Error> {
    let mut written = timed(&mut report.seconds.write, || {
        outputs.write(picture, metadata)
    });
    report.outputs = written.paths;
    report.seconds.total = seconds_since_start();
    written.errors.extend(outputs.write_report(report).err());
    written.errors
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

fn warn_of_optimization(args: &RenderArgs, device: &DeviceInfo, warnings: &mut Warnings) {
    let is_missed =
        args.optimization == Optimization::Quick && Optimization::of(device) != Optimization::Quick;
    if is_missed {
        warnings.add(format!(
            "the kernel is optimized in full: --optimization quick takes lavapipe of Mesa 25 or newer, and the driver is {}",
            device.driver
        ));
    }
}

fn warn_of_guide(args: &RenderArgs, training: Option<&Training>, warnings: &mut Warnings) {
    let is_missed = args.guiding == Guiding::On && training.is_none_or(|t| t.guide.is_none());
    if is_missed {
        warnings.add(
            "paths are not guided: that takes an integrator of paths with at least three edges (--max-depth 3), which \
             meet a diffuse surface",
        );
    }
}

fn has_light(f: &Features) -> bool {
    let there = |(name, on): (&str, bool)| on && !f.is_asked_for(name);
    const LIGHTS: [&str; 6] = [
        "point_light",
        "spot_light",
        "directional_light",
        "emissive",
        "environment",
        "unlit",
    ];
    let mut flags = f.flags().into_iter();
    flags.any(|flag| LIGHTS.contains(&flag.0) && there(flag))
}

/// The layers of the file: the picture, the AOVs, the variance.
fn picture(args: &RenderArgs, film: &Film, aovs: &[(String, Film)]) -> Picture {
    let mut picture = Picture::new(film.width as usize, film.height as usize);
    picture.layers.push(layer("", film.channels()));
    for (name, film) in aovs {
        picture.layers.push(layer(name, film.channels()));
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

/// Says what failed, and how the program ends.
fn verdict(report: &Report, errors: impl Iterator<Item = anyhow::Error>) -> Exit {
    let usual = match report.interrupted {
        true => Exit::Interrupted,
        false => Exit::Fine,
    };
    // The first failure decides.
    errors.fold(usual, |exit, error| {
        message::error(&error);
        match exit {
            Exit::Fine | Exit::Interrupted => Exit::of(&error),
            failed => failed,
        }
    })
}
