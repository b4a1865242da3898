//! The arguments of `etendue render`.

use std::path::PathBuf;

use clap::Args;

use super::camera::CameraArgs;
use super::environment::EnvironmentArg;
use super::load::LoadArgs;
use super::optimization::Optimization;
use super::parse;
use crate::accel::{Instancing, Preset};
use crate::image::ToneMap;
use crate::render::{Guiding, LightSelection};
use crate::scene::Selector;

/// Arguments of `etendue render`. Of a flag that takes one value and is given again, the last counts.
#[derive(Debug, Args)]
#[command(args_override_self = true)]
pub struct RenderArgs {
    /// A .gltf or .glb file
    #[arg(value_name = "SCENE")]
    pub file: PathBuf,

    /// Where the picture goes, by extension: .exr (f32, lossless, with layers and metadata) or
    /// .png (tone-mapped); may be given several times
    #[arg(short, long, value_name = "OUT")]
    pub output: Vec<PathBuf>,

    /// Samples a pixel
    #[arg(long, value_name = "N", default_value_t = 64)]
    pub spp: u64,

    /// Size in pixels, as in 1280x720 [default: 512 along the longer side, in the shape that the
    /// camera asks for, square if it asks for none]
    #[arg(long, value_name = "WxH", value_parser = parse::size)]
    pub size: Option<[u32; 2]>,

    /// Which camera of the scene
    #[arg(long, value_name = "NAME|INDEX", default_value = "0")]
    pub camera: Selector,

    /// Its projection and its lens.
    #[command(flatten)]
    pub camera_args: CameraArgs,

    #[command(flatten)]
    pub load: LoadArgs,

    /// A file in the shader folder `integrator`: path, naive, direct, ao, normals, albedo, depth, ...
    #[arg(long, value_name = "NAME", default_value = "path")]
    pub integrator: String,

    /// A file in the shader folder `sampler`: sobol, independent, ...
    #[arg(long, value_name = "NAME", default_value = "sobol")]
    pub sampler: String,

    /// Edges of the longest path: 1 shows only emitters seen directly, 2 adds direct light, and so on
    #[arg(long, value_name = "N", default_value_t = 8)]
    pub max_depth: u32,

    /// How much time to spend on the acceleration structure: fast, balanced, or best, which pays in
    /// long renders
    #[arg(long, value_name = "NAME", default_value_t)]
    pub bvh: Preset,

    /// What the choice of a light follows: uniform (nothing), power, or tree (what each light may contribute
    /// at the point in question) [default: tree, unless lamps are few]
    #[arg(long, value_name = "NAME")]
    pub lights: Option<LightSelection>,

    /// Whether the diffuse lobe is guided to where a training pass found light: auto (where that says that it pays), on,
    /// off. But for off that pass also says where paths end, and how many light samples their first vertices draw
    #[arg(long, value_name = "NAME", default_value_t)]
    pub guiding: Guiding,

    /// How much the driver optimizes the kernel, where it has a choice (lavapipe of Mesa 25 or newer). quick: it compiles in a
    /// third to a half of the time and draws three to four times as long, the same picture; full; auto: quick up to 49,152
    /// paths (pixels times samples) a thread, so that a scene is sooner seen for the first time
    #[arg(long, value_name = "NAME", default_value_t)]
    pub optimization: Optimization,

    /// Whether instances of a mesh share its geometry: auto (where that saves much memory; rays then
    /// take longer), never, always
    #[arg(long, value_name = "NAME", default_value_t)]
    pub instancing: Instancing,

    /// Seed of the random numbers
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub seed: u32,

    /// Light from all around: an equirectangular .hdr or .exr file, a radiance, or three of them
    /// (linear Rec. 709); replaces that of the scene
    #[arg(
        long = "env",
        value_name = "FILE|VALUE|R,G,B",
        allow_hyphen_values = true
    )]
    pub environment: Option<EnvironmentArg>,

    /// Turns the environment about +Y, counter-clockwise seen from above
    #[arg(long = "env-rotation", value_name = "DEGREES", default_value_t = 0.0,
          value_parser = parse::finite, allow_hyphen_values = true, requires = "environment")]
    pub environment_rotation: f64,

    /// Multiplies the environment's radiance
    #[arg(long = "env-scale", value_name = "FACTOR", default_value_t = 1.0,
          value_parser = parse::not_negative, allow_hyphen_values = true, requires = "environment")]
    pub environment_scale: f64,

    /// Exposure of .png outputs in stops: the radiance is multiplied by 2^EV
    #[arg(long, value_name = "EV", default_value_t = 0.0,
          value_parser = parse::exposure, allow_hyphen_values = true)]
    pub exposure: f32,

    /// Tone map of .png outputs: neutral (Khronos PBR Neutral), agx, aces, none (clipped)
    #[arg(long, value_name = "NAME", default_value = "neutral")]
    pub tonemap: ToneMap,

    /// More layers for .exr outputs, separated by commas: integrators, each rendered with the same
    /// samples into a layer of its name (albedo, normals, depth, ao, direct, or your own), and
    /// `variance`, the estimated variance of the picture's means
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    pub aov: Vec<String>,

    /// The Vulkan device: its number in `etendue devices`, or a part of its name
    /// [default: $ETENDUE_DEVICE, or else the best]
    #[arg(long, value_name = "NAME|INDEX")]
    pub device: Option<String>,

    /// Take all shaders from this folder (see `etendue shaders export`)
    #[arg(long, value_name = "DIR")]
    pub shaders: Option<PathBuf>,

    /// Give an `override` of the shaders a value; may be given several times
    #[arg(long = "set", value_name = "NAME=VALUE", value_parser = parse::assignment)]
    pub set: Vec<(String, f64)>,

    /// Compile features in that the scene does not use, for comparison: `all`, or names that
    /// `etendue info` shows, separated by commas
    #[arg(long, value_name = "all|LIST", value_delimiter = ',', value_parser = parse::feature)]
    pub require: Vec<String>,

    /// Print the WGSL that is compiled, and render nothing
    #[arg(long)]
    pub print_wgsl: bool,

    /// Write the SPIR-V that is compiled, with the names of its functions, and render nothing
    #[arg(long, value_name = "FILE")]
    pub spirv: Option<PathBuf>,

    /// Compile with bounds checks: slower, and a mistake in an edited shader stays harmless
    #[arg(long)]
    pub checked: bool,

    /// Count rays, and the nodes and pairs of triangles that they look at, for the report: costs some time
    #[arg(long)]
    pub stats: bool,

    /// Write a report, as JSON, to a file, or to stdout if it is `-`
    #[arg(long, value_name = "FILE|-")]
    pub json: Option<PathBuf>,

    /// Neither progress nor warnings on stderr (they are in the report); errors stay
    #[arg(short, long)]
    pub quiet: bool,
}
