//! Further layers of a picture: each integrator that `--aov` names is rendered as the picture is.

use std::ops::ControlFlow;

use anyhow::{Context, Result};

use super::args::RenderArgs;
use super::interrupt::Interrupt;
use super::message::Warnings;
use super::progress::ProgressLine;
use super::report::warn_non_finite;
use super::settings::aov_integrators;
use crate::host::stages;
use crate::render::{Film, RenderError, Renderer, Settings, Stage};
use crate::shader::ShaderError;

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

/// The names of the overrides that the shader declares; none if they cannot be told without values.
fn declared(stage: Stage<'_>, settings: &Settings) -> Result<Option<Vec<String>>, RenderError> {
    let bare = Settings {
        overrides: Vec::new(),
        ..settings.clone()
    };
    match stage.compile(&bare) {
        Ok(names) => Ok(Some(names)),
        Err(RenderError::Shader(ShaderError::Override(_))) => Ok(None),
        Err(error) => Err(error),
    }
}

fn share_overrides(
    stage: Stage<'_>,
    main: &mut Settings,
    aovs: &mut [Settings],
) -> Result<(), RenderError> {
    let has = |names: &Option<Vec<String>>, name: &String| {
        names.as_ref().is_none_or(|names| names.contains(name))
    };
    let of_main = declared(stage, main)?;
    let mut elsewhere = Vec::new();
    for aov in aovs {
        let of_aov = declared(stage, aov)?;
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
