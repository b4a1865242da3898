//! What a render begins with: the scene from its files, and the device.

use std::panic::resume_unwind;

use anyhow::{Context, Result};

use super::args::RenderArgs;
use super::message::Warnings;
use super::optimization::Optimization;
use super::report::{Seconds, timed};
use super::{camera, environment, parse, settings};
use crate::accel::BuildOptions;
use crate::gpu::{Device, FoundDevice, OpenOptions, set_optimization};
use crate::host::stages::stage;
use crate::render::{Prepared, Settings};
use crate::scene::{Features, Scene, gltf};

/// Settles how the driver compiles, for which its version must be known where that may be quickly: then gives the device.
/// To be called while the program has no second thread.
pub fn settle_optimization(args: &RenderArgs, time: &mut Seconds) -> Option<Result<FoundDevice>> {
    if args.optimization == Optimization::Full {
        set_optimization(true);
    }
    Optimization::wants_quick(args).then(|| {
        let found = timed(&mut time.device, || find_device(args));
        if found
            .as_ref()
            .is_ok_and(|found| found.info().can_compile_quickly)
        {
            set_optimization(false);
        }
        found
    })
}

/// A scene, how it is to be rendered, and what the host makes of it.
pub struct Loaded {
    pub scene: Scene,
    pub settings: Settings,
    pub prepared: Prepared,
}

/// Reads and prepares the scene while the device is opened, that is found here if it was not before.
///
/// # Errors
/// Bad input, or no device. If both fail, it is the scene's error that counts.
pub fn load_and_open(
    args: &RenderArgs,
    found: Option<Result<FoundDevice>>,
    time: &mut Seconds,
    warnings: &mut Warnings,
) -> Result<(Loaded, Device)> {
    std::thread::scope(|scope| {
        let Seconds {
            device,
            load,
            accel,
            ..
        } = time;
        let find = || found.unwrap_or_else(|| find_device(args));
        let opening = scope.spawn(|| timed(device, || open_device(find()?)));
        let scene = timed(load, || read(args, warnings));
        let loaded = scene.and_then(|scene| timed(accel, || prepare(args, scene)));
        let device = opening.join().unwrap_or_else(|panic| resume_unwind(panic));
        Ok((loaded?, device?))
    })
}

fn prepare(args: &RenderArgs, scene: Scene) -> Result<Loaded> {
    let settings = settings::of(args, &scene)?;
    let options = BuildOptions {
        instancing: args.instancing,
        ..BuildOptions::of(args.bvh)
    };
    let prepared = Prepared::with_lights(&scene, settings.camera, &options, args.lights)?;
    Ok(Loaded {
        scene,
        settings,
        prepared,
    })
}

fn read(args: &RenderArgs, warnings: &mut Warnings) -> Result<Scene> {
    // The environment first: it is read faster, so a mistake in it is found sooner.
    let environment = stage("environment", || environment::load(args, warnings))?;
    let mut scene = gltf::load(&args.file, &args.load.options())?;
    if environment.is_some() {
        scene.environment = environment;
    }
    scene.required_features = required_features(args);
    camera::apply(args, &mut scene)?;
    let valid = stage("validate", || scene.validate());
    valid.with_context(|| args.file.display().to_string())?;
    Ok(scene)
}

fn required_features(args: &RenderArgs) -> Vec<String> {
    match args.require.iter().any(|name| name == parse::ALL) {
        true => Features::names().into_iter().map(String::from).collect(),
        false => args.require.clone(),
    }
}

fn find_device(args: &RenderArgs) -> Result<FoundDevice> {
    let from_variable = || {
        std::env::var("ETENDUE_DEVICE")
            .ok()
            .filter(|s| !s.is_empty())
    };
    let selector = args.device.clone().or_else(from_variable);
    let options = OpenOptions::from_env();
    Ok(FoundDevice::find(selector.as_deref(), options)?)
}

fn open_device(found: FoundDevice) -> Result<Device> {
    let device = found.open()?;
    // Measured here, beside the loading; the device remembers.
    stage("probe", || device.probe())?;
    Ok(device)
}
