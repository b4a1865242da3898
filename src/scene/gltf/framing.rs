//! The camera of a file that has none.

use glam::{DMat3, DMat4, DVec3};

use crate::scene::camera::DEFAULT_YFOV;
use crate::scene::{Camera, Scene};

/// A camera from slightly above the front that sees the whole scene, and no more than that where
/// the picture is square.
pub(super) fn camera(scene: &Scene) -> Camera {
    let (center, radius) = bounding_sphere(scene);
    let toward = DVec3::new(0.4, 0.3, 1.0).normalize();
    let right = DVec3::Y.cross(toward).normalize();
    let turn = DMat3::from_cols(right, toward.cross(right), toward);
    let eye = center + toward * (radius / (DEFAULT_YFOV / 2.0).sin());
    Camera {
        name: "framing".to_owned(),
        to_world: DMat4::from_mat3_translation(turn, eye),
        ..Camera::default()
    }
}

/// A sphere around all instances: the box's centre, and the farthest vertex from it.
fn bounding_sphere(scene: &Scene) -> (DVec3, f64) {
    let Some((low, high)) = scene.bounds() else {
        return (DVec3::ZERO, 1.0);
    };
    let center = low + (high - low) / 2.0;
    let radius = scene.farthest(center);
    match radius > 0.0 && radius.is_finite() && center.is_finite() {
        true => (center, radius),
        false if center.is_finite() => (center, 1.0),
        false => (DVec3::ZERO, 1.0),
    }
}
