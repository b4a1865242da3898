//! What the arguments change about the camera: its projection and its lens.

use std::str::FromStr;

use anyhow::{Context, Result, bail};
use clap::{Args, ValueEnum};

use super::args::RenderArgs;
use super::parse;
use crate::render::{Prepared, Settings, distance_at};
use crate::scene::camera::DEFAULT_YFOV;
use crate::scene::{Camera, Lens, Projection, Scene};

/// Height of the film that an f-number is of, metres: that of 35 mm film (36 mm × 24 mm).
const FILM_HEIGHT: f64 = 0.024;

/// Arguments about the camera.
#[derive(Debug, Args)]
pub struct CameraArgs {
    /// Replaces the camera's projection. A panorama shows the whole sphere around the camera's position,
    /// however the camera is turned, as pictures for --env do: +X in the middle, +Y at the top, +Z
    /// half way from the middle to the right edge
    #[arg(long, value_name = "NAME")]
    pub projection: Option<ProjectionName>,

    /// Vertical field of view of a perspective camera [default: the camera's own, or 40]
    #[arg(long, value_name = "DEGREES", value_parser = parse::field_of_view, conflicts_with = "view_height")]
    pub fov: Option<f64>,

    /// Height of what an orthographic camera shows [default: the camera's own]
    #[arg(long, value_name = "METRES", value_parser = parse::length)]
    pub view_height: Option<f64>,

    /// A thin lens: its radius in metres, or an f-number, as in f/2.8, of a perspective camera with 24 mm
    /// high film (the focal length follows from the field of view)
    #[arg(long, value_name = "RADIUS|f/N", requires = "focus")]
    pub aperture: Option<Aperture>,

    /// Distance of what is sharp, along the camera's axis; `inf` for what is far away
    #[arg(long, value_name = "METRES", value_parser = parse::focus_distance, group = "focus", requires = "aperture")]
    pub focus_distance: Option<f64>,

    /// A point of the picture at which surfaces are sharp: from 0,0 at the top left to 1,1 at the bottom
    /// right
    #[arg(long, value_name = "X,Y", value_parser = parse::point, group = "focus", requires = "aperture")]
    pub focus_at: Option<[f64; 2]>,
}

/// A projection without its numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum ProjectionName {
    /// A pinhole or a lens.
    Perspective,
    /// Parallel rays.
    Orthographic,
    /// The whole sphere.
    Panorama,
}

/// The size of a lens.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Aperture {
    /// Metres.
    Radius(f64),
    /// Focal length over diameter.
    FNumber(f64),
}

impl FromStr for Aperture {
    type Err = String;

    /// A number of metres of at least 0, or `f/` and a number of more than 0.
    fn from_str(text: &str) -> Result<Self, String> {
        match text.strip_prefix("f/") {
            Some(number) => parse::length(number).map(Self::FNumber),
            None => parse::not_negative(text).map(Self::Radius),
        }
    }
}

/// Changes the chosen camera as the arguments ask. The distance of --focus-at comes later ([`focus`]).
///
/// # Errors
/// The scene has no such camera, or arguments do not go together.
pub fn apply(args: &RenderArgs, scene: &mut Scene) -> Result<()> {
    let found = scene.find_camera(&args.camera);
    let index = found.with_context(|| args.file.display().to_string())?;
    let camera = &mut scene.cameras[index];
    camera.projection = projection(&args.camera_args, camera)?;
    camera.lens = lens(&args.camera_args, &camera.projection)?;
    Ok(())
}

fn projection(args: &CameraArgs, camera: &Camera) -> Result<Projection> {
    use ProjectionName::{Orthographic, Panorama, Perspective};
    let own = match camera.projection {
        Projection::Perspective { .. } => Perspective,
        Projection::Orthographic { .. } => Orthographic,
        Projection::Panorama => Panorama,
    };
    let name = args.projection.unwrap_or(own);
    if args.fov.is_some() && name != Perspective {
        bail!("--fov is of perspective cameras, and this one is not: --projection perspective");
    }
    if args.view_height.is_some() && name != Orthographic {
        bail!(
            "--view-height is of orthographic cameras, and this one is not: --projection orthographic"
        );
    }
    Ok(match (name, camera.projection) {
        (Perspective, Projection::Perspective { yfov, aspect }) => Projection::Perspective {
            yfov: args.fov.map_or(yfov, f64::to_radians),
            aspect,
        },
        (Perspective, _) => Projection::Perspective {
            yfov: args.fov.map_or(DEFAULT_YFOV, f64::to_radians),
            aspect: None,
        },
        (Orthographic, own) => orthographic(own, args.view_height)?,
        (Panorama, _) => Projection::Panorama,
    })
}

/// An orthographic projection of a height; of the camera's own where there is one.
fn orthographic(own: Projection, height: Option<f64>) -> Result<Projection> {
    Ok(match (own, height) {
        (Projection::Orthographic { .. }, None) => own,
        (Projection::Orthographic { xmag, ymag }, Some(height)) => {
            let scale = 0.5 * height / ymag.abs();
            Projection::Orthographic {
                xmag: scale * xmag,
                ymag: scale * ymag,
            }
        }
        (_, Some(height)) => {
            let aspect = match own {
                Projection::Perspective { aspect, .. } => aspect.unwrap_or(1.0),
                _ => 1.0,
            };
            Projection::Orthographic {
                xmag: 0.5 * height * aspect,
                ymag: 0.5 * height,
            }
        }
        (_, None) => {
            bail!("how much the orthographic camera shows is not known: --view-height METRES")
        }
    })
}

fn lens(args: &CameraArgs, projection: &Projection) -> Result<Option<Lens>> {
    let Some(aperture) = args.aperture else {
        return Ok(None);
    };
    let radius = match (aperture, projection) {
        (_, Projection::Panorama) => bail!("a panorama has no lens: leave out --aperture"),
        (Aperture::Radius(radius), _) => radius,
        (Aperture::FNumber(number), Projection::Perspective { yfov, .. }) => {
            let focal_length = 0.5 * FILM_HEIGHT / (0.5 * yfov).tan();
            0.5 * focal_length / number
        }
        (Aperture::FNumber(_), Projection::Orthographic { .. }) => {
            bail!("an orthographic camera has no f-number: give --aperture as a radius in metres")
        }
    };
    Ok(Some(Lens {
        radius,
        focus_distance: args.focus_distance.unwrap_or(f64::INFINITY),
    }))
}

/// Focuses at the surface that --focus-at points at.
///
/// # Errors
/// No surface is seen there.
pub fn focus(
    args: &RenderArgs,
    scene: &mut Scene,
    prepared: &Prepared,
    settings: &Settings,
) -> Result<()> {
    let Some([x, y]) = args.camera_args.focus_at else {
        return Ok(());
    };
    let found = distance_at(scene, prepared, settings, [x, y]).filter(|distance| *distance > 0.0);
    let distance = found.with_context(|| {
        format!("--focus-at {x},{y}: the camera sees no surface there; give --focus-distance")
    })?;
    if let Some(lens) = &mut scene.cameras[settings.camera].lens {
        lens.focus_distance = distance;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn apertures_are_radii_or_f_numbers() {
        let parse = |text: &str| text.parse::<Aperture>();
        assert_eq!(parse("0.05"), Ok(Aperture::Radius(0.05)));
        assert_eq!(parse("0"), Ok(Aperture::Radius(0.0)));
        assert_eq!(parse("f/2.8"), Ok(Aperture::FNumber(2.8)));
        for bad in ["", "-1", "nan", "inf", "f/0", "f/", "2.8f", "f2.8"] {
            assert!(parse(bad).is_err(), "{bad}");
        }
    }
}
