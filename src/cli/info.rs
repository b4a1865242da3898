//! `etendue info`: what is in a scene, and what it requires.

use std::path::PathBuf;

use anyhow::{Context, Result};
use clap::Args;
use serde::Serialize;

use super::bvh_report::{BvhReport, InstancingReport};
use super::exit::Exit;
use super::lights_report::LightsReport;
use super::load::LoadArgs;
use super::{info_text, message};
use crate::accel::{BuildOptions, Instancing, Preset};
use crate::render::{Prepared, Sharing};
use crate::scene::{Scene, Summary, gltf};

/// Arguments of `etendue info`.
#[derive(Debug, Args)]
pub struct InfoArgs {
    /// A .gltf or .glb file
    #[arg(value_name = "SCENE")]
    file: PathBuf,

    #[command(flatten)]
    load: LoadArgs,

    /// Build the acceleration structure too, as `etendue render` does with this preset (fast,
    /// balanced or best), and tell its build time and size, and how lights would be chosen
    #[arg(long, value_name = "NAME")]
    bvh: Option<Preset>,

    /// Whether instances of a mesh share its geometry: auto (where that saves much memory), never,
    /// always
    #[arg(long, value_name = "NAME", default_value_t)]
    instancing: Instancing,

    /// Print it as JSON
    #[arg(long)]
    json: bool,
}

/// Describes a scene. Needs no device.
///
/// # Errors
/// The file is malformed.
pub fn run(args: &InfoArgs) -> Result<Exit> {
    let scene = gltf::load(&args.file, &args.load.options())?;
    let valid = scene.validate();
    valid.with_context(|| args.file.display().to_string())?;
    let described = Described {
        summary: Summary::of(&scene),
        instancing: InstancingReport::of(&scene, &Sharing::of(&scene, args.instancing)),
        built: args
            .bvh
            .map(|preset| build(&scene, preset, args))
            .transpose()?,
    };
    let text = match args.json {
        true => serde_json::to_string_pretty(&described)? + "\n",
        false => info_text::describe(
            &described.summary,
            &described.instancing,
            described.built.as_ref(),
        ),
    };
    message::print(&text).map(|()| Exit::Fine)
}

#[derive(Serialize)]
struct Described {
    #[serde(flatten)]
    summary: Summary,
    instancing: InstancingReport,
    #[serde(flatten)]
    built: Option<Built>,
}

/// What a render would build.
#[derive(Serialize)]
pub struct Built {
    /// The acceleration structure.
    pub bvh: BvhReport,
    /// How lights are chosen.
    pub light_selection: LightsReport,
}

fn build(scene: &Scene, preset: Preset, args: &InfoArgs) -> Result<Built> {
    let options = BuildOptions {
        instancing: args.instancing,
        ..BuildOptions::of(preset)
    };
    // The camera is the origin only; the loader sees to it that there is one.
    let prepared = Prepared::new(scene, 0, &options)?;
    Ok(Built {
        bvh: BvhReport::new(preset, &prepared),
        light_selection: LightsReport::new(&prepared),
    })
}
