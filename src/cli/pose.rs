//! `--animation` and `--at`: the moment that a scene is shown in.

use clap::Args;

use super::parse;
use crate::scene::{Scene, Selector};

/// Which pose of the nodes is shown.
#[derive(Debug, Clone, Args)]
pub struct PoseArgs {
    /// Which animation poses the scene [default: none; the first one if --at is given]
    #[arg(long, value_name = "NAME|INDEX")]
    pub animation: Option<Selector>,

    /// The moment of the animation, in seconds from its beginning; before its first and after its
    /// last key these hold [default: 0]
    #[arg(long, value_name = "SECONDS", value_parser = parse::finite, allow_hyphen_values = true)]
    pub at: Option<f64>,
}

/// What a picture's file says about the pose: `1 "walk" at 0.5 s`; none where nothing is posed.
pub fn describe(scene: &Scene) -> Option<String> {
    let played = scene.animation?;
    let name = &scene.animation_names[played.index];
    Some(format!("{} {name:?} at {} s", played.index, played.seconds))
}
