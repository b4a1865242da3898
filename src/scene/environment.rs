//! Light from infinitely far away.

use std::sync::Arc;

/// Radiance that arrives from every direction that leaves the scene.
#[derive(Debug, Clone)]
pub struct Environment {
    /// Multiplies the radiance, linear Rec. 709. Without an image it is the radiance, W·sr⁻¹·m⁻².
    pub radiance: [f32; 3],
    /// Turn about +Y, radians, counter-clockwise seen from above.
    pub rotation: f64,
    /// Equirectangular picture, if any.
    pub image: Option<Arc<EnvironmentImage>>,
}

/// An equirectangular picture: u = 0.5 + atan2(d.z, d.x)/2π, v = acos(d.y)/π from the top row.
#[derive(Debug, Clone)]
pub struct EnvironmentImage {
    /// Columns, at least 1.
    pub width: usize,
    /// Rows, at least 1.
    pub height: usize,
    /// Row-major from the top; finite and not negative.
    pub texels: Vec<[f32; 3]>,
}
