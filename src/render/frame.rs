//! What the shader is told about the camera, the lights and the settings.

use super::layout::{Frame, NONE};
use super::prepared::Prepared;
use super::settings::Settings;
use crate::scene::{Projection, Scene};

/// The frame of a render, but for the fields that each band sets.
pub fn base_frame(scene: &Scene, prepared: &Prepared, settings: &Settings) -> Frame {
    let camera = &scene.cameras[settings.camera];
    let axis = |i: usize| camera.to_world.col(i).truncate().as_vec3().to_array();
    let lens = camera.lens.filter(|lens| lens.radius > 0.0);
    let (projection, half_extent) = half_extent(&camera.projection, settings);
    let environment = scene.environment.as_ref();
    let rotation = environment.map_or(0.0, |e| e.rotation);
    let image = environment.and_then(|e| e.image.as_ref());
    Frame {
        camera_x: axis(0),
        camera_y: axis(1),
        camera_z: axis(2),
        width: settings.width,
        height: settings.height,
        projection,
        half_extent,
        max_depth: settings.max_depth,
        seed: settings.seed,
        light_count: prepared.lights.table.len() as u32,
        // Only a kernel with an environment that the scene has not reads it where there is none.
        environment_light: match prepared.environment_light {
            NONE => 0,
            light => light,
        },
        environment_width: image.map_or(1, |i| i.width as u32),
        environment_height: image.map_or(1, |i| i.height as u32),
        environment_radiance: environment.map_or([0.0; 3], |e| e.radiance),
        environment_cos: rotation.cos() as f32,
        environment_sin: rotation.sin() as f32,
        punctual_count: prepared.punctual.len() as u32,
        media: prepared.media,
        lens_radius: lens.map_or(0.0, |lens| lens.radius as f32),
        inverse_focus_distance: lens.map_or(0.0, |lens| (1.0 / lens.focus_distance) as f32),
        ..Default::default()
    }
}

/// Projection code and half the film's size. The vertical field of view is the camera's; the
/// horizontal one follows from the picture's shape. An orthographic view shows at least what the
/// camera asks for.
fn half_extent(projection: &Projection, settings: &Settings) -> (u32, [f32; 2]) {
    let aspect = f64::from(settings.width) / f64::from(settings.height);
    match *projection {
        Projection::Perspective { yfov, .. } => {
            let y = (0.5 * yfov).tan();
            (0, [(y * aspect) as f32, y as f32])
        }
        Projection::Orthographic { xmag, ymag } => {
            let y = ymag.abs().max(xmag.abs() / aspect);
            let (sx, sy) = (xmag.signum(), ymag.signum());
            (1, [(sx * y * aspect) as f32, (sy * y) as f32])
        }
        Projection::Panorama => (2, [0.0; 2]),
    }
}
