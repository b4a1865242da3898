//! What is known of a group of lights.

use std::f64::consts::{FRAC_PI_2, PI};

use glam::{DVec3, Vec3};

use super::cone::Cone;
use crate::scene::{LightKind, PunctualLight};

/// Where lights are, where they shine, and how strongly.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LightBounds {
    /// Box of their positions, relative to the camera.
    pub low: Vec3,
    /// Its other end.
    pub high: Vec3,
    /// Normals of the surfaces, axes of the spot lights.
    pub cone: Cone,
    /// How far from these they shine, radians: π/2 for surfaces.
    pub reach: f64,
    /// Sum of what each sends to where it sends most, W·sr⁻¹ up to photometric weighting.
    pub intensity: f64,
}

/// Angles below this are in the slack that every node has (`node.rs`).
const NEGLIGIBLE_ANGLE: f64 = 1e-5;

impl LightBounds {
    /// Of a triangle with a normal. `intensity` is its area times its mean radiance.
    pub fn triangle(corners: &[Vec3; 3], double_sided: bool, intensity: f64) -> Self {
        let [a, b, c] = corners.map(|v| v.as_dvec3());
        let (u, v) = (b - a, c - a);
        let cross = u.cross(v);
        // The shader finds the normal of a sliver in f32: so far it may be off.
        let error = 8.0 * 2f64.powi(-24) * u.length() * v.length() / cross.length();
        let cone = match double_sided {
            true => Cone::ALL,
            false => Cone {
                axis: cross.try_normalize().unwrap_or(DVec3::Y),
                spread: if error > NEGLIGIBLE_ANGLE {
                    error.min(PI)
                } else {
                    0.0
                },
            },
        };
        Self {
            low: corners[0].min(corners[1]).min(corners[2]),
            high: corners[0].max(corners[1]).max(corners[2]),
            cone,
            reach: FRAC_PI_2,
            intensity,
        }
    }

    /// Of a point or spot light at a position relative to the camera; `None` for a directional light,
    /// which is nowhere.
    pub fn punctual(light: &PunctualLight, position: Vec3, intensity: f64) -> Option<Self> {
        let (cone, reach) = match light.kind {
            LightKind::Point => (Cone::ALL, PI),
            LightKind::Spot { outer, .. } => {
                let (axis, spread) = (light.direction, 0.0);
                (Cone { axis, spread }, outer)
            }
            LightKind::Directional => return None,
        };
        Some(Self {
            low: position,
            high: position,
            cone,
            reach,
            intensity,
        })
    }

    /// Of two groups together.
    pub fn union(&self, other: &Self) -> Self {
        Self {
            low: self.low.min(other.low),
            high: self.high.max(other.high),
            cone: self.cone.union(other.cone),
            reach: self.reach.max(other.reach),
            intensity: self.intensity + other.intensity,
        }
    }

    /// Twice the middle of the box.
    pub fn doubled_center(&self) -> DVec3 {
        self.low.as_dvec3() + self.high.as_dvec3()
    }

    /// The cost of a group in the surface area orientation heuristic (Conty Estevez and Kulla 2018,
    /// equation 2), with the square of the box's diagonal in place of its surface, which is 0 for lights
    /// in a row.
    pub fn cost(&self) -> f64 {
        let diagonal = self.high.as_dvec3() - self.low.as_dvec3();
        self.intensity * self.cone.measure(self.reach) * diagonal.length_squared()
    }
}
