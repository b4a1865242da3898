//! The command line: a file per subcommand.
//!
//! [`main`] parses, runs and turns what happened into an exit code; `exit` lists the codes.

mod aov;
mod args;
mod bvh_report;
mod camera;
mod devices;
mod environment;
mod exit;
mod guiding_report;
mod info;
mod info_text;
mod interrupt;
mod lights_report;
mod load;
mod message;
mod metadata;
mod opening;
mod optimization;
mod outputs;
mod parse;
mod progress;
mod render;
mod report;
mod settings;
mod shaders;

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::process::ExitCode;

use clap::{Parser, Subcommand};

use crate::host::stages;
use exit::Exit;

/// What `--help` says about the environment.
const ENVIRONMENT: &str = "\
Environment: ETENDUE_DEVICE is the default of --device. Compiled shaders are kept in \
ETENDUE_CACHE_DIR (default: etendue/kernels in XDG_CACHE_HOME or ~/.cache); ETENDUE_NO_CACHE=1 keeps none. \
LP_NATIVE_VECTOR_WIDTH and GALLIVM_PERF are lavapipe's and set for it (--optimization).";

/// Étendue: a headless path tracer. glTF in, OpenEXR out, on any Vulkan device.
#[derive(Debug, Parser)]
#[command(name = "etendue", version, after_help = format!("{}\n\n{ENVIRONMENT}", exit::HELP), max_term_width = 100)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Render a glTF scene
    Render(Box<args::RenderArgs>),
    /// List the Vulkan devices
    Devices(devices::DevicesArgs),
    /// Say what is in a scene, and what it requires of the shader; needs no device
    Info(info::InfoArgs),
    /// List, export or check the shaders; needs no device
    Shaders(shaders::ShadersArgs),
}

/// Runs the program with the arguments of the process. No panic reaches the user.
pub fn main() -> ExitCode {
    crate::gpu::prefer_widest_vectors();
    stages::begin();
    std::panic::set_hook(Box::new(message::internal_error));
    let run = AssertUnwindSafe(|| run(&Cli::parse()));
    let exit = catch_unwind(run).unwrap_or(Exit::Internal);
    exit.into()
}

fn run(cli: &Cli) -> Exit {
    let result = match &cli.command {
        Command::Render(args) => render::run(args),
        Command::Devices(args) => devices::run(args),
        Command::Info(args) => info::run(args),
        Command::Shaders(args) => shaders::run(args),
    };
    result.unwrap_or_else(|error| {
        message::error(&error);
        Exit::of(&error)
    })
}
