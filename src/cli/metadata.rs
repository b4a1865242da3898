//! What a picture's file says about how it was made, so that it can be made again.

use std::ffi::OsString;

use super::args::RenderArgs;
use super::environment::EnvironmentArg;
use super::report::Report;
use crate::image::Metadata;
use crate::render::{Renderer, Settings};

/// Text attributes, all called `etendue.…`, and OpenEXR's own `software`.
pub fn metadata(
    args: &RenderArgs,
    settings: &Settings,
    renderer: &Renderer<'_>,
    report: &Report,
) -> Metadata {
    let mut list = vec![
        ("version", report.version.to_owned()),
        ("scene", report.scene.clone()),
        ("scene_hash", report.scene_hash.clone()),
        ("camera", report.camera.clone()),
        ("size", format!("{}x{}", settings.width, settings.height)),
        ("spp", report.spp.to_string()),
        ("seed", settings.seed.to_string()),
        ("integrator", settings.integrator.clone()),
        ("sampler", settings.sampler.clone()),
        ("max_depth", settings.max_depth.to_string()),
        ("lights", report.lights.selection.unwrap_or("none").into()),
        ("guided", report.guiding.used.to_string()),
        ("overrides", overrides(args)),
        (
            "shader_hash",
            blake3::hash(renderer.wgsl().as_bytes()).to_string(),
        ),
        ("device", report.device.clone()),
        ("driver", report.driver.clone()),
        ("optimization", report.optimization.into()),
        ("interrupted", report.interrupted.to_string()),
        ("command", command_line(std::env::args_os().skip(1))),
    ];
    let number = |(name, value): (_, Option<f64>)| value.map(|v| (name, v.to_string()));
    let lens = [
        ("lens_radius", report.lens_radius),
        ("focus_distance", report.focus_distance),
    ];
    list.extend(lens.into_iter().filter_map(number));
    list.extend(report.animation.clone().map(|text| ("animation", text)));
    list.extend(environment(args));
    let mut metadata = Metadata::default();
    let named = list.into_iter().map(|(k, v)| (format!("etendue.{k}"), v));
    metadata.0.extend(named);
    let software = format!("étendue {}", report.version);
    metadata.0.insert("software".into(), software);
    metadata
}

fn overrides(args: &RenderArgs) -> String {
    let each = args
        .set
        .iter()
        .map(|(name, value)| format!("{name}={value}"));
    each.collect::<Vec<_>>().join(" ")
}

fn environment(args: &RenderArgs) -> Vec<(&'static str, String)> {
    let Some(environment) = &args.environment else {
        return Vec::new();
    };
    let mut list = vec![
        (
            "environment_rotation",
            args.environment_rotation.to_string(),
        ),
        ("environment_scale", args.environment_scale.to_string()),
    ];
    match environment {
        EnvironmentArg::Constant([r, g, b]) => list.push(("environment", format!("{r},{g},{b}"))),
        EnvironmentArg::File(path) => {
            list.push(("environment", path.display().to_string()));
            // It was there when the render began; if it has gone since, there is no hash.
            let hash = std::fs::read(path).map(|bytes| blake3::hash(&bytes));
            list.extend(hash.map(|h| ("environment_hash", h.to_string())));
        }
    }
    list
}

/// The command line, quoted for a POSIX shell.
fn command_line(arguments: impl Iterator<Item = OsString>) -> String {
    let quoted = arguments.map(|a| quote(&a.to_string_lossy()));
    std::iter::once("etendue".to_owned())
        .chain(quoted)
        .collect::<Vec<_>>()
        .join(" ")
}

fn quote(argument: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "_-./:=,@%+".contains(c);
    match !argument.is_empty() && argument.chars().all(plain) {
        true => argument.to_owned(),
        false => format!("'{}'", argument.replace('\'', r"'\''")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_command_line_survives_a_shell() {
        let arguments = ["render", "it's a $scene.gltf", "", "-o", "a.exr"];
        let line = command_line(arguments.iter().map(OsString::from));
        assert_eq!(line, r"etendue render 'it'\''s a $scene.gltf' '' -o a.exr");
    }
}
