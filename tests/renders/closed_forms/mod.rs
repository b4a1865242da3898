//! Scenes whose pictures are known in closed form, rendered on the device.
//!
//! A test fails where the mean of a region is more than 4.5 of its own standard errors (and f32
//! rounding, 1e-5) from the answer, and where the standard error is too large for that to mean
//! anything. The answers are derived here or beside the tests, in f64, without the shaders.

mod camera;
mod coverage;
mod depth;
mod emission;
mod furnace;
mod glass;
mod lens;
mod lights;
mod many_lights;
mod panorama;
mod polygons;
mod scale;
mod sky;
mod specular;

use std::f64::consts::PI;

use etendue::render::{Film, Settings};
use etendue::scene::Scene;
use glam::DVec3;

use crate::common::{SceneBuilder, lambert, render, square};

/// Reflectance of the receivers.
const RHO: f64 = 0.5;

/// A small Lambertian receiver at the origin that faces +Y, seen from 0.05 above over a footprint
/// so small (4e-7 across) that what `add` puts a length of 0.1 or more away is constant on it.
fn receiver(add: impl FnOnce(&mut SceneBuilder)) -> Scene {
    let mut builder = SceneBuilder::new();
    builder.ground(lambert(RHO as f32), 0.01);
    builder.parallel(DVec3::Y * 0.05, DVec3::ZERO, 2e-7);
    add(&mut builder);
    builder.scene
}

/// Radiance that the receiver reflects, paths of two edges; `spp` samples in each of 256 pixels.
fn receive(scene: &Scene, spp: u64) -> Film {
    render(scene, &square(16, spp, 2))
}

/// Radiance of a receiver of irradiance `e`.
fn reflected(e: f64) -> f64 {
    RHO * e / PI
}

/// The integrators that have to agree with every closed form.
fn integrators(settings: &Settings) -> Vec<Settings> {
    ["path", "path_lights", "path_bsdf", "naive"]
        .map(|name| crate::common::with_integrator(settings, name))
        .to_vec()
}
