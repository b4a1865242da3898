//! What is read from a scene's file: arguments that `render` and `info` share.

use clap::Args;

use super::parse;
use crate::scene::gltf::LoadOptions;
use crate::scene::{Scene, Selector};

/// Which of the things that a file describes is shown.
#[derive(Debug, Clone, Args)]
pub struct LoadArgs {
    /// Which scene of the file [default: the one that the file shows first]
    #[arg(long, value_name = "NAME|INDEX")]
    pub scene: Option<Selector>,

    /// Which variant of the materials [default: what the file shows without one]
    #[arg(long, value_name = "NAME|INDEX")]
    pub variant: Option<Selector>,

    /// Which animation poses the scene [default: none; the first one if --at is given]
    #[arg(long, value_name = "NAME|INDEX")]
    pub animation: Option<Selector>,

    /// The moment of the animation, in seconds from its beginning; before its first and after its
    /// last key these hold [default: 0]
    #[arg(long, value_name = "SECONDS", value_parser = parse::finite, allow_hyphen_values = true)]
    pub at: Option<f64>,

    /// Show textures (a missing image, an unsupported format, damaged data) and materials that are
    /// wrong in the file as magenta, with a warning, instead of refusing the file
    #[arg(long)]
    pub lenient: bool,
}

impl LoadArgs {
    /// The same for the loader.
    pub fn options(&self) -> LoadOptions {
        LoadOptions {
            scene: self.scene.clone(),
            variant: self.variant.clone(),
            animation: self.animation.clone(),
            at: self.at,
            lenient: self.lenient,
        }
    }
}

/// What a picture's file says about the pose: `1 "walk" at 0.5 s`; none where nothing is posed.
pub fn pose(scene: &Scene) -> Option<String> {
    let played = scene.animation?;
    let name = &scene.animation_names[played.index];
    Some(format!("{} {name:?} at {} s", played.index, played.seconds))
}
