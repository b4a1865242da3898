//! `etendue shaders`: list, export, check.

use std::path::{Path, PathBuf};

use anyhow::Result;
use clap::{Args, Subcommand};

use super::exit::Exit;
use super::message;
use crate::render::layout::layouts;
use crate::render::shader_check;
use crate::shader::{CheckResult, ShaderLibrary, check_all, unique_reports};

/// Arguments of `etendue shaders`.
#[derive(Debug, Args)]
pub struct ShadersArgs {
    #[command(subcommand)]
    action: Action,
}

#[derive(Debug, Subcommand)]
enum Action {
    /// List the files
    List(Folder),
    /// Write the built-in files into a folder, to edit them and render with `--shaders DIR`
    Export {
        /// Where to; made if it is not there. A file that is there with another text is an error
        #[arg(value_name = "DIR")]
        folder: PathBuf,
    },
    /// Compile every integrator with every sampler, for scenes with everything and with nothing;
    /// exit code 1 if one fails. Needs no device
    Check(Folder),
}

#[derive(Debug, Args)]
struct Folder {
    /// The files of this folder instead of the built-in ones
    #[arg(long, value_name = "DIR")]
    shaders: Option<PathBuf>,
}

/// The shaders of a folder, or those built in.
///
/// # Errors
/// The folder cannot be read.
pub fn library(folder: Option<&Path>) -> Result<ShaderLibrary> {
    Ok(match folder {
        Some(folder) => ShaderLibrary::from_dir(folder)?,
        None => ShaderLibrary::embedded(),
    })
}

/// Runs `etendue shaders`.
///
/// # Errors
/// A folder cannot be read or written.
pub fn run(args: &ShadersArgs) -> Result<Exit> {
    match &args.action {
        Action::List(folder) => list(&library(folder.shaders.as_deref())?),
        Action::Export { folder } => export(folder),
        Action::Check(folder) => check(&library(folder.shaders.as_deref())?),
    }
}

fn list(library: &ShaderLibrary) -> Result<Exit> {
    let lines = library.list().into_iter().map(|path| path + "\n");
    message::print(&lines.collect::<String>()).map(|()| Exit::Fine)
}

fn export(folder: &Path) -> Result<Exit> {
    let written = ShaderLibrary::embedded().export(folder)?;
    let lines = written.iter().map(|path| format!("{}\n", path.display()));
    message::print(&lines.collect::<String>()).map(|()| Exit::Fine)
}

fn check(library: &ShaderLibrary) -> Result<Exit> {
    let layouts = layouts();
    let checks = shader_check::checks(library, &layouts)?;
    let results = check_all(library, &checks);
    for (report, names) in unique_reports(&results) {
        message::note(&format!(
            "{}\n  = in {}\n",
            report.trim_end(),
            in_words(&names)
        ));
    }
    let failed = results.iter().filter(|r| r.result.is_err()).count();
    message::print(&conclusion(&results, failed))?;
    Ok(match failed {
        0 => Exit::Fine,
        _ => Exit::Negative,
    })
}

fn conclusion(results: &[CheckResult], failed: usize) -> String {
    match failed {
        0 => format!("{} kernels compile\n", results.len()),
        _ => format!("{failed} of {} kernels do not compile\n", results.len()),
    }
}

/// The first of the names and how many there are.
fn in_words(names: &[String]) -> String {
    match names {
        [] => String::new(),
        [only] => only.clone(),
        [first, others @ ..] => format!("{first}, and {} more", others.len()),
    }
}
