//! The table of all lights, from which the shader draws one in constant time.

use glam::DVec3;

use super::alias::alias_table;
use super::emission::luminance;
use super::layout::{self, LIGHT_ENVIRONMENT, LIGHT_KIND_SHIFT, LIGHT_PUNCTUAL, LIGHT_TRIANGLE};
use crate::scene::{LightKind, PunctualLight};

/// Every light with its power, before the table is made.
#[derive(Debug, Default)]
pub struct LightList {
    entries: Vec<(u32, u32, f64)>,
}

impl LightList {
    /// Adds an emissive triangle (index in the order of the BVH); returns its index in the table.
    pub fn add_triangle(&mut self, triangle: u32, power: f64) -> u32 {
        self.add(LIGHT_TRIANGLE, triangle, power)
    }

    /// Adds a punctual light.
    pub fn add_punctual(&mut self, index: u32, light: &PunctualLight, scene_radius: f64) -> u32 {
        self.add(LIGHT_PUNCTUAL, index, punctual_power(light, scene_radius))
    }

    /// Adds the environment, with its mean radiance.
    pub fn add_environment(&mut self, mean: DVec3, scene_radius: f64) -> u32 {
        let area = std::f64::consts::PI * scene_radius * scene_radius;
        let power = 4.0 * std::f64::consts::PI * area * luminance(mean);
        self.add(LIGHT_ENVIRONMENT, 0, power)
    }

    fn add(&mut self, kind: u32, index: u32, power: f64) -> u32 {
        self.entries.push((kind, index, power));
        self.entries.len() as u32 - 1
    }

    /// The alias table. Half of the probability goes by power, half evenly to the kinds of lights
    /// that there are (and within a kind by power): a sun outside must not starve the lamp inside.
    pub fn table(&self) -> Vec<layout::Light> {
        let weights = self.weights();
        let entries = alias_table(&weights).unwrap_or_default();
        self.entries
            .iter()
            .zip(entries)
            .map(|(&(kind, index, _), entry)| layout::Light {
                threshold: entry.threshold,
                alias_index: entry.alias,
                probability: entry.probability,
                kind_and_index: kind << LIGHT_KIND_SHIFT | index,
            })
            .collect()
    }

    fn weights(&self) -> Vec<f64> {
        let mut power_of_kind = [0.0; 3];
        for &(kind, _, power) in &self.entries {
            power_of_kind[kind as usize] += power;
        }
        let total: f64 = power_of_kind.iter().sum();
        let kinds = power_of_kind.iter().filter(|p| **p > 0.0).count() as f64;
        self.entries
            .iter()
            .map(|&(kind, _, power)| {
                let share = power_of_kind[kind as usize];
                if share > 0.0 {
                    0.5 * power / total + 0.5 * power / (share * kinds)
                } else {
                    0.0
                }
            })
            .collect()
    }
}

/// Flux in W up to photometric weighting; of a directional light what it sends through the scene's disc.
fn punctual_power(light: &PunctualLight, scene_radius: f64) -> f64 {
    let pi = std::f64::consts::PI;
    let intensity = luminance(light.intensity.as_dvec3());
    match light.kind {
        LightKind::Point => 4.0 * pi * intensity,
        LightKind::Spot { inner, outer } => pi * intensity * (versine(inner) + versine(outer)),
        LightKind::Directional => pi * scene_radius * scene_radius * intensity,
    }
}

/// 1 − cos, without its cancellation for narrow cones.
fn versine(angle: f64) -> f64 {
    2.0 * (0.5 * angle).sin().powi(2)
}

/// The device's form of a punctual light, relative to `origin`.
pub fn punctual(light: &PunctualLight, origin: DVec3) -> layout::PunctualLight {
    let (kind, inner, outer) = match light.kind {
        LightKind::Point => (0, 0.0, 1.0),
        LightKind::Spot { inner, outer } => (1, versine(inner), versine(outer)),
        LightKind::Directional => (2, 0.0, 1.0),
    };
    layout::PunctualLight {
        position: (light.position - origin).as_vec3().to_array(),
        kind,
        direction: light.direction.as_vec3().to_array(),
        inverse_range: if light.range.is_finite() {
            (1.0 / light.range) as f32
        } else {
            0.0
        },
        intensity: light.intensity.to_array(),
        versine_outer: outer as f32,
        spot_scale: (1.0 / (outer - inner)).min(f64::from(f32::MAX)) as f32,
        ..Default::default()
    }
}

/// Whether an entry of the table is a punctual light.
pub fn is_punctual(light: &layout::Light) -> bool {
    light.kind_and_index >> LIGHT_KIND_SHIFT == LIGHT_PUNCTUAL
}
