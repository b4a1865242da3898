//! `--env`: light from infinitely far away.

use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::sync::Arc;

use anyhow::{Context, Result, bail};

use super::args::RenderArgs;
use super::message::Warnings;
use crate::image::read_rgb;
use crate::scene::{Environment, EnvironmentImage};

/// What `--env` names.
#[derive(Debug, Clone, PartialEq)]
pub enum EnvironmentArg {
    /// The same radiance from everywhere, W·sr⁻¹·m⁻².
    Constant([f32; 3]),
    /// An equirectangular picture.
    File(PathBuf),
}

impl FromStr for EnvironmentArg {
    type Err = String;

    /// One number, three with commas between them, or else a file.
    fn from_str(text: &str) -> Result<Self, String> {
        let numbers: Result<Vec<f32>, _> = text.split(',').map(|t| t.trim().parse()).collect();
        let radiance = match numbers.as_deref() {
            Ok([grey]) => [*grey; 3],
            Ok([r, g, b]) => [*r, *g, *b],
            Ok(_) => return Err("expected one number, or three: R,G,B".into()),
            Err(_) => return Ok(Self::File(text.into())),
        };
        match radiance.iter().all(|c| c.is_finite() && *c >= 0.0) {
            true => Ok(Self::Constant(radiance)),
            false => Err("a radiance is a finite number of at least 0".into()),
        }
    }
}

/// The environment that the arguments ask for, if they do.
///
/// # Errors
/// A picture that cannot be read, or a radiance that leaves the range of f32.
pub fn load(args: &RenderArgs, warnings: &mut Warnings) -> Result<Option<Environment>> {
    let Some(environment) = &args.environment else {
        return Ok(None);
    };
    let (radiance, image) = match environment {
        EnvironmentArg::Constant(radiance) => (*radiance, None),
        EnvironmentArg::File(path) => ([1.0; 3], Some(read(path, warnings)?)),
    };
    let radiance = radiance.map(|c| (f64::from(c) * args.environment_scale) as f32);
    if radiance.iter().any(|c| !c.is_finite()) {
        bail!("the environment's radiance times --env-scale is too large");
    }
    Ok(Some(Environment {
        radiance,
        rotation: args.environment_rotation.to_radians(),
        image,
    }))
}

fn read(path: &Path, warnings: &mut Warnings) -> Result<Arc<EnvironmentImage>> {
    let picture = read_rgb(path).context("environment")?;
    if picture.clamped > 0 {
        warnings.add(format!(
            "{}: {} texels with negative, infinite or undefined radiance were clamped",
            path.display(),
            picture.clamped
        ));
    }
    Ok(Arc::new(EnvironmentImage {
        width: picture.width,
        height: picture.height,
        texels: picture.texels,
    }))
}

#[cfg(test)]
mod tests {
    use super::EnvironmentArg::{self, Constant, File};

    #[test]
    fn numbers_are_radiances_and_the_rest_files() {
        let parse = |text: &str| text.parse::<EnvironmentArg>();
        assert_eq!(parse("2"), Ok(Constant([2.0; 3])));
        assert_eq!(parse("1, 0.5,0"), Ok(Constant([1.0, 0.5, 0.0])));
        assert_eq!(parse("sky.hdr"), Ok(File("sky.hdr".into())));
        for bad in ["-1", "nan", "inf", "1e40", "1,2", "1,2,3,4", "1,-1,1"] {
            assert!(parse(bad).is_err(), "{bad}");
        }
    }
}
