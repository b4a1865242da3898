//! `etendue info`: what is in a scene, and what it requires.

use std::path::PathBuf;

use anyhow::{Context, Result};
use clap::Args;

use super::exit::Exit;
use super::{info_text, message};
use crate::scene::{Selector, Summary, gltf};

/// Arguments of `etendue info`.
#[derive(Debug, Args)]
pub struct InfoArgs {
    /// A .gltf or .glb file
    #[arg(value_name = "SCENE")]
    file: PathBuf,

    /// Which scene of the file [default: the one that the file shows first]
    #[arg(long, value_name = "NAME|INDEX")]
    scene: Option<Selector>,

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
    let summary = Summary::of(&scene);
    let text = match args.json {
        true => serde_json::to_string_pretty(&summary)? + "\n",
        false => info_text::describe(&summary),
    };
    message::print(&text).map(|()| Exit::Fine)
}
