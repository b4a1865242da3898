//! Which distance a camera must focus at to show a point of the picture sharply.

use glam::Vec3;

use super::frame::base_frame;
use super::layout::{FIRST_ATTRIBUTES, TRIANGLE_SINGLE_SIDED};
use super::prepared::Prepared;
use super::settings::Settings;
use crate::geometry::Ray;
use crate::scene::{Projection, Scene};

/// Back faces that a ray of the camera may pass, one behind the other.
const MOST_BACK_FACES: usize = 256;

/// Distance along the camera's axis, metres, of the surface that is seen at a point of the picture:
/// from (0, 0) at the top left to (1, 1) at the bottom right. None where no surface is seen, and for a
/// panorama, which has no axis.
///
/// Traced on the host. A surface counts however transparent it is; back faces that the camera does not
/// see do not.
pub fn distance_at(
    scene: &Scene,
    prepared: &Prepared,
    settings: &Settings,
    at: [f64; 2],
) -> Option<f64> {
    let frame = base_frame(scene, prepared, settings);
    let [x, y, z] = [frame.camera_x, frame.camera_y, frame.camera_z].map(Vec3::from_array);
    let p = [0, 1].map(|i| (2.0 * at[i] - 1.0) as f32 * frame.half_extent[i]);
    let on_film = p[0] * x - p[1] * y;
    let (origin, direction) = match scene.cameras[settings.camera].projection {
        Projection::Perspective { .. } => (Vec3::ZERO, (on_film - z).normalize()),
        Projection::Orthographic { .. } => (on_film, -z),
        Projection::Panorama => return None,
    };
    let t = distance_to_seen(prepared, origin, direction)?;
    Some(f64::from(t) * f64::from(direction.dot(-z)))
}

/// Distance of the first surface that the camera sees along a ray.
fn distance_to_seen(prepared: &Prepared, origin: Vec3, direction: Vec3) -> Option<f32> {
    let mut passed = 0.0;
    for _ in 0..MOST_BACK_FACES {
        let ray = Ray::new(origin + passed * direction, direction);
        let hit = prepared.bvh.intersect(&ray)?;
        passed += hit.t;
        let element = &prepared.bvh.elements[hit.triangle as usize / 2];
        let flags = element.words[FIRST_ATTRIBUTES + hit.triangle as usize % 2];
        if !hit.back_face || flags & TRIANGLE_SINGLE_SIDED == 0 {
            return Some(passed);
        }
        // Beyond that triangle: a distance to focus at need not be better than this.
        passed *= 1.0 + 1e-5;
    }
    None
}
