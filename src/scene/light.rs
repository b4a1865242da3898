//! Lights without a surface (KHR_lights_punctual).

use glam::{DVec3, Vec3};

/// A punctual light placed in the world.
#[derive(Debug, Clone, PartialEq)]
pub struct PunctualLight {
    /// Name of the node or else of the light, possibly empty.
    pub name: String,
    /// Where it is, metres (unused by directional lights).
    pub position: DVec3,
    /// Unit vector along which it shines (unused by point lights).
    pub direction: DVec3,
    /// Colour × intensity: W·sr⁻¹ (point, spot) or W·m⁻² at normal incidence (directional).
    pub intensity: Vec3,
    /// Distance beyond which it gives nothing, metres; infinite if the file gives none.
    pub range: f64,
    /// The kind, with its own parameters.
    pub kind: LightKind,
}

/// The kinds of punctual lights.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LightKind {
    /// Shines alike in all directions.
    Point,
    /// A cone: full inside `inner`, nothing outside `outer` (radians from the axis, 0 ≤ inner < outer ≤ π/2).
    Spot {
        /// Half-angle inside which the intensity is full.
        inner: f64,
        /// Half-angle outside which there is nothing.
        outer: f64,
    },
    /// Infinitely far away.
    Directional,
}
