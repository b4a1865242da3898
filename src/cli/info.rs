//! `etendue info`: what is in a scene, and what it requires.

use std::path::PathBuf;

use anyhow::{Context, Result};
use clap::Args;
use serde::Serialize;

use super::bvh_report::{BvhReport, InstancingReport};
use super::exit::Exit;
use super::{info_text, message};
use crate::accel::{BuildOptions, Instancing, Preset};
use crate::render::{Prepared, Sharing};
use crate::scene::{Scene, Selector, Summary, gltf};

/// Arguments of `etendue info`.
#[derive(Debug, Args)]
pub struct InfoArgs {
    /// A .gltf or .glb file
    #[arg(value_name = "SCENE")]
    file: PathBuf,

    /// Which scene of the file [default: the one that the file shows first]
    #[arg(long, value_name = "NAME|INDEX")]
    scene: Option<Selector>,

    /// Build the acceleration structure too, as `etendue render` does with this preset (fast,
    /// balanced or best), and tell its build time and size
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
    let options = gltf::LoadOptions {
        scene: args.scene.clone(),
    };
    let scene = gltf::load(&args.file, &options)?;
    let valid = scene.validate();
    valid.with_context(|| args.file.display().to_string())?;
    let described = Described {
        summary: Summary::of(&scene),
        instancing: InstancingReport::of(&scene, &Sharing::of(&scene, args.instancing)),
        bvh: args
            .bvh
            .map(|preset| build(&scene, preset, args))
            .transpose()?,
    };
    let text = match args.json {
        true => serde_json::to_string_pretty(&described)? + "\n",
        false => info_text::describe(
            &described.summary,
            &described.instancing,
            described.bvh.as_ref(),
        ),
    };
    message::print(&text).map(|()| Exit::Fine)
}

#[derive(Serialize)]
struct Described {
    #[serde(flatten)]
    summary: Summary,
    instancing: InstancingReport,
    #[serde(skip_serializing_if = "Option::is_none")]
    bvh: Option<BvhReport>,
}

fn build(scene: &Scene, preset: Preset, args: &InfoArgs) -> Result<BvhReport> {
    let options = BuildOptions {
        instancing: args.instancing,
        ..BuildOptions::of(preset)
    };
    // The camera is the origin only; the loader sees to it that there is one.
    let prepared = Prepared::new(scene, 0, &options)?;
    Ok(BvhReport::new(preset, &prepared))
}
