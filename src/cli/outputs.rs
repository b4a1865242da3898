//! Where pictures and the report go: checked before any work is done for them.

use std::ffi::OsStr;
use std::fs::{self, OpenOptions};
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, anyhow, bail};

use super::args::RenderArgs;
use super::environment::EnvironmentArg;
use super::message;
use crate::image::{DisplaySettings, Metadata, Picture, exr, png};

/// How a picture is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Format {
    Exr,
    Png,
}

/// The pictures to write and the report.
#[derive(Debug)]
pub struct Outputs {
    pictures: Vec<(PathBuf, Format)>,
    display: DisplaySettings,
    report: Option<PathBuf>,
    /// Whether the shader is asked for, and nothing is to be rendered.
    pub only_shader: bool,
}

/// What came of writing the pictures.
#[derive(Debug, Default)]
pub struct Written {
    /// Files that are there now.
    pub paths: Vec<String>,
    /// Why others are not.
    pub errors: Vec<anyhow::Error>,
}

impl Outputs {
    /// Refuses outputs that could not be written, before any work is done for them.
    ///
    /// # Errors
    /// Nothing to do, an extension other than .exr and .png, a file twice or over an input, a folder
    /// that is missing or in which no file can be made.
    pub fn check(args: &RenderArgs) -> Result<Self> {
        let only_shader = args.print_wgsl || args.spirv.is_some();
        if args.output.is_empty() && args.json.is_none() && !only_shader {
            bail!(
                "nothing to do: ask for a picture (-o picture.exr), a report (--json -) or the shader (--print-wgsl, --spirv kernel.spv)"
            );
        }
        let with_format = |path: &PathBuf| Ok((path.clone(), format_of(path)?));
        let pictures: Vec<_> = args.output.iter().map(with_format).collect::<Result<_>>()?;
        if !args.aov.is_empty() && !pictures.iter().any(|(_, f)| *f == Format::Exr) {
            bail!("--aov adds layers to .exr files: give one, as in -o picture.exr");
        }
        let report = args.json.clone();
        let files = args
            .output
            .iter()
            .chain(report.iter().filter(|p| !is_stdout(p)))
            .chain(&args.spirv);
        check_distinct(args, files.clone())?;
        files.map(PathBuf::as_path).try_for_each(check_writable)?;
        Ok(Self {
            pictures,
            report,
            only_shader,
            display: DisplaySettings {
                exposure_ev: args.exposure,
                tone_map: args.tonemap,
            },
        })
    }

    /// Writes every picture; one that fails does not keep the others from being written.
    pub fn write(&self, picture: &Picture, metadata: &Metadata) -> Written {
        let mut written = Written::default();
        for (path, format) in &self.pictures {
            let result = match format {
                Format::Exr => exr::write(path, picture, metadata),
                Format::Png => png::write_with_metadata(path, picture, &self.display, metadata),
            };
            match result {
                Ok(()) => written.paths.push(path.display().to_string()),
                Err(error) => written.errors.push(error.into()),
            }
        }
        written
    }

    /// Writes the report, if it is asked for.
    ///
    /// # Errors
    /// The file or stdout cannot be written.
    pub fn write_report(&self, json: &impl serde::Serialize) -> Result<()> {
        let Some(path) = &self.report else {
            return Ok(());
        };
        let text = serde_json::to_string_pretty(json)? + "\n";
        if is_stdout(path) {
            return message::print(&text);
        }
        fs::write(path, text).with_context(|| format!("{}: cannot write", path.display()))
    }
}

fn is_stdout(path: &Path) -> bool {
    path == Path::new("-")
}

fn format_of(path: &Path) -> Result<Format> {
    let extension = path.extension().and_then(OsStr::to_str).unwrap_or("");
    match extension.to_ascii_lowercase().as_str() {
        "exr" => Ok(Format::Exr),
        "png" => Ok(Format::Png),
        _ => bail!(
            "{}: pictures are written as .exr or .png, by the file's extension",
            path.display()
        ),
    }
}

/// No output may replace an input or another output.
fn check_distinct<'a>(args: &RenderArgs, outputs: impl Iterator<Item = &'a PathBuf>) -> Result<()> {
    let mut taken = vec![(real_path(&args.file), "the scene")];
    if let Some(EnvironmentArg::File(path)) = &args.environment {
        taken.push((real_path(path), "the environment"));
    }
    for path in outputs {
        let real = real_path(path);
        if let Some((_, what)) = taken.iter().find(|(other, _)| *other == real) {
            bail!("{}: this output would replace {what}", path.display());
        }
        taken.push((real, "another output"));
    }
    Ok(())
}

/// The path behind links; of a file that is not there yet, its folder's and its name.
fn real_path(path: &Path) -> PathBuf {
    fs::canonicalize(path).unwrap_or_else(|_| match fs::canonicalize(folder_of(path)) {
        Ok(folder) => folder.join(path.file_name().unwrap_or_default()),
        Err(_) => path.to_owned(),
    })
}

fn folder_of(path: &Path) -> &Path {
    let parent = path.parent().filter(|p| !p.as_os_str().is_empty());
    parent.unwrap_or(Path::new("."))
}

fn check_writable(path: &Path) -> Result<()> {
    let real = real_path(path);
    let folder = folder_of(&real);
    let shown = path.display();
    if real.is_dir() {
        bail!("{shown}: cannot write: it is a folder");
    }
    match fs::metadata(folder) {
        Err(e) => bail!("{shown}: cannot write into its folder: {e}"),
        Ok(about) if !about.is_dir() => bail!("{shown}: cannot write: its folder is a file"),
        Ok(_) => {}
    }
    try_to_create(folder).map_err(|e| anyhow!("{shown}: cannot write into its folder: {e}"))
}

/// Makes a file in the folder and removes it: permissions alone do not tell (read-only file
/// systems, quotas, ...).
fn try_to_create(folder: &Path) -> std::io::Result<()> {
    let probe = folder.join(format!(".etendue-probe-{}", std::process::id()));
    OpenOptions::new()
        .write(true)
        .create_new(true)
        .open(&probe)?;
    fs::remove_file(&probe)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_extension_decides() {
        assert_eq!(format_of(Path::new("a.EXR")).ok(), Some(Format::Exr));
        assert_eq!(format_of(Path::new("a.b.png")).ok(), Some(Format::Png));
        for bad in ["a", "a.jpg", ".exr", "exr", "a.exr.gz"] {
            assert!(format_of(Path::new(bad)).is_err(), "{bad}");
        }
    }

    #[test]
    fn a_picture_that_cannot_be_written_does_not_keep_others_from_it() {
        let folder = tempfile::tempdir().expect("a folder");
        let inside = |name: &str| folder.path().join(name);
        let outputs = Outputs {
            pictures: vec![
                (inside("no/a.exr"), Format::Exr),
                (inside("b.exr"), Format::Exr),
                (inside("c.png"), Format::Png),
            ],
            display: DisplaySettings::default(),
            report: None,
            only_shader: false,
        };
        let picture = Picture::new(1, 1).with_rgb("", &[0.5; 3]);
        let written = outputs.write(&picture, &Metadata::default());
        assert_eq!(written.errors.len(), 1);
        assert!(written.errors[0].to_string().contains("no/a.exr"));
        assert_eq!(written.paths.len(), 2);
        assert!(inside("b.exr").exists() && inside("c.png").exists());
    }
}
