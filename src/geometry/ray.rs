//! Rays.

use glam::Vec3;

/// The points `origin + t · direction` with 0 < t ≤ `t_max`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ray {
    /// Start, metres; finite.
    pub origin: Vec3,
    /// Finite and not zero. It need not be of unit length: `t` counts in its lengths.
    pub direction: Vec3,
    /// Largest t that counts as a hit, at most 3e38 (so that widening it by a few ulp stays finite).
    pub t_max: f32,
}

impl Ray {
    /// The `t_max` of a ray that nothing limits.
    pub const UNLIMITED: f32 = 3e38;

    /// A ray without an upper limit.
    pub fn new(origin: Vec3, direction: Vec3) -> Ray {
        Ray {
            origin,
            direction,
            t_max: Ray::UNLIMITED,
        }
    }
}
