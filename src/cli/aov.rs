//! Further layers of a picture: each integrator that `--aov` names is rendered as the picture is.

use std::ops::ControlFlow;

use anyhow::{Context, Result};

use super::args::RenderArgs;
use super::interrupt::Interrupt;
use super::message::Warnings;
use super::progress::ProgressLine;
use super::report::warn_non_finite;
use super::settings::aov_integrators;
use crate::gpu::Device;
use crate::host::stages::{self, stage};
use crate::render::{Film, GpuScene, Prepared, RenderError, Renderer, Settings, program};
use crate::scene::Scene;
use crate::shader::{ShaderError, ShaderLibrary};

/// What every render of a job shares.
#[derive(Clone, Copy)]
pub struct Stage<'a> {
    /// Where it runs.
    pub device: &'a Device,
    /// The shaders.
    pub library: &'a ShaderLibrary,
    /// The scene.
    pub scene: &'a Scene,
    /// The scene, flat.
    pub prepared: &'a Prepared,
    /// The scene on the device.
    pub gpu_scene: &'a GpuScene,
}

impl<'a> Stage<'a> {
    /// Compiles a shader and makes a film.
    ///
    /// # Errors
    /// As [`Renderer::new`].
    pub fn renderer(&self, settings: &Settings) -> Result<Renderer<'a>, RenderError> {
        Renderer::new(
            self.device,
            self.library,
            self.scene,
            self.prepared,
            self.gpu_scene,
            settings,
        )
    }

    /// Compiles without the driver. Gives the names of the overrides that the shader declares.
    fn compile(&self, settings: &Settings) -> Result<Vec<String>, RenderError> {
        let count_steps = stage("probe", || self.device.probe())?.loop_limit.is_some();
        let files = program::virtual_files(
            self.library,
            settings,
            self.prepared,
            self.gpu_scene,
            count_steps,
            self.device.info().max_shared_memory,
        )?;
        let (_, compiled) = program::build(self.library, &files, settings)?;
        Ok(compiled.overrides.into_iter().map(|o| o.name).collect())
    }

    /// The names of the overrides that the shader declares; none if they cannot be told without
    /// values.
    fn declared(&self, settings: &Settings) -> Result<Option<Vec<String>>, RenderError> {
        let bare = Settings {
            overrides: Vec::new(),
            ..settings.clone()
        };
        match self.compile(&bare) {
            Ok(names) => Ok(Some(names)),
            Err(RenderError::Shader(ShaderError::Override(_))) => Ok(None),
            Err(error) => Err(error),
        }
    }
}

/// The settings of each AOV. All of them are compiled here: a mistake in one must not come to
/// light when the picture is done.
///
/// An override need not be declared by all shaders of the job: each is given its own, and one that
/// none declares stays with the picture's, where it is an error.
///
/// # Errors
/// Any shader error.
pub fn plan(args: &RenderArgs, stage: Stage<'_>, main: &mut Settings) -> Result<Vec<Settings>> {
    let mut aovs: Vec<Settings> = aov_integrators(args)
        .into_iter()
        .map(|integrator| Settings {
            integrator: integrator.clone(),
            stats: false,
            ..main.clone()
        })
        .collect();
    if !aovs.is_empty() && !main.overrides.is_empty() {
        share_overrides(stage, main, &mut aovs)?;
    }
    for aov in &aovs {
        stage.compile(aov).with_context(|| label(aov))?;
    }
    Ok(aovs)
}

fn share_overrides(
    stage: Stage<'_>,
    main: &mut Settings,
    aovs: &mut [Settings],
) -> Result<(), RenderError> {
    let has = |names: &Option<Vec<String>>, name: &String| {
        names.as_ref().is_none_or(|names| names.contains(name))
    };
    let of_main = stage.declared(main)?;
    let mut elsewhere = Vec::new();
    for aov in aovs {
        let of_aov = stage.declared(aov)?;
        aov.overrides.retain(|(name, _)| has(&of_aov, name));
        elsewhere.extend(aov.overrides.iter().map(|(name, _)| name.clone()));
    }
    let is_main = |name: &String| has(&of_main, name) || !elsewhere.contains(name);
    main.overrides.retain(|(name, _)| is_main(name));
    Ok(())
}

/// Films by integrator, and why there are no more of them.
#[derive(Default)]
pub struct Layers {
    /// The AOVs rendered, with the names of their integrators.
    pub films: Vec<(String, Film)>,
    /// What went wrong. It must not cost the picture, which is done by then.
    pub failure: Option<anyhow::Error>,
}

/// Renders the AOVs; an interruption ends it, with what there is.
pub fn render(
    args: &RenderArgs,
    stage: Stage<'_>,
    aovs: &[Settings],
    interrupt: &Interrupt,
    warnings: &mut Warnings,
) -> Layers {
    let mut layers = Layers::default();
    for aov in aovs {
        if interrupt.requested() {
            warnings.add(format!("interrupted before {} was rendered", label(aov)));
            continue;
        }
        let film = render_one(args, stage, aov, interrupt, warnings);
        match film.with_context(|| label(aov)) {
            Ok(film) => layers.films.push((aov.integrator.clone(), film)),
            Err(error) => {
                layers.failure = Some(error);
                break;
            }
        }
    }
    layers
}

fn render_one(
    args: &RenderArgs,
    stage: Stage<'_>,
    aov: &Settings,
    interrupt: &Interrupt,
    warnings: &mut Warnings,
) -> Result<Film, RenderError> {
    let mut renderer = stage.renderer(aov)?;
    if run(&mut renderer, aov, interrupt, args.quiet)?.is_break() {
        warnings.add(format!("interrupted: {} is incomplete", label(aov)));
    }
    let film = renderer.film()?;
    warn_non_finite(&film, &label(aov), warnings);
    Ok(film)
}

/// Renders with a progress line until all is done or the user interrupts.
///
/// # Errors
/// As [`Renderer::render`].
pub fn run(
    renderer: &mut Renderer<'_>,
    settings: &Settings,
    interrupt: &Interrupt,
    quiet: bool,
) -> Result<ControlFlow<()>, RenderError> {
    let mut line = ProgressLine::new(&settings.integrator, settings.spp, quiet);
    renderer.render(&mut |renderer, progress| {
        stages::first_sample();
        line.update(renderer, progress);
        match interrupt.requested() && progress.samples_done < progress.samples_total {
            true => ControlFlow::Break(()),
            false => ControlFlow::Continue(()),
        }
    })
}

fn label(settings: &Settings) -> String {
    format!("AOV \"{}\"", settings.integrator)
}
