//! All lights, and how the shader draws one: from an alias table in constant time, or from a tree.

use std::time::Duration;

use glam::{DVec3, Vec3};

use super::alias::alias_table;
use super::emission::{Emission, luminance};
use super::layout::{self, LIGHT_ENVIRONMENT, LIGHT_KIND_SHIFT, LIGHT_PUNCTUAL, LIGHT_TRIANGLE};
use super::light_selection::LightSelection;
use super::light_tree::{LightBounds, LightTree};
use crate::host::stages::timed_stage;
use crate::scene::{LightKind, PunctualLight};

/// Groups of lights among which half of the probability is shared evenly: a sun outside must not starve
/// the lamp inside, nor many lamps the sun.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Group {
    Triangles,
    Points,
    Directional,
    Environment,
    /// Whatever is in the tree.
    Tree,
}

#[derive(Debug)]
struct Entry {
    kind: u32,
    index: u32,
    group: Group,
    power: f64,
    /// Where it is, if it is somewhere.
    bounds: Option<LightBounds>,
}

/// Every light with its power, before the table is made: first those that are somewhere, then the others.
#[derive(Debug, Default)]
pub struct LightList {
    entries: Vec<Entry>,
}

/// All lights as the device holds them.
#[derive(Debug, Default)]
pub struct Lights {
    /// The table; with a tree its lights come first, and the alias table is over the others.
    pub table: Vec<layout::Light>,
    /// The tree, if lights are chosen by it.
    pub tree: Option<LightTree>,
    /// Lights beside the tree; 0 if there is none.
    pub outside_tree: usize,
    /// How one is chosen.
    pub selection: Option<LightSelection>,
    /// Wall time of building the tree.
    pub tree_time: Duration,
}

impl Lights {
    /// The nodes of the tree, if there is one.
    pub fn nodes(&self) -> &[layout::LightNode] {
        self.tree.as_ref().map_or(&[], |tree| &tree.nodes)
    }

    /// Whether any triangle is a light.
    pub fn has_triangles(&self) -> bool {
        self.has(LIGHT_TRIANGLE)
    }

    /// Whether there is a punctual light.
    pub fn has_punctual(&self) -> bool {
        self.has(LIGHT_PUNCTUAL)
    }

    fn has(&self, kind: u32) -> bool {
        let is = |light: &layout::Light| light.kind_and_index >> LIGHT_KIND_SHIFT == kind;
        self.table.iter().any(is)
    }
}

impl LightList {
    /// Adds an emissive triangle (index in the order of the BVH); returns its index in the table.
    pub fn add_triangle(&mut self, triangle: u32, corners: &[Vec3; 3], emission: &Emission) -> u32 {
        let bounds = LightBounds::triangle(corners, emission.double_sided, emission.intensity());
        self.add(Entry {
            kind: LIGHT_TRIANGLE,
            index: triangle,
            group: Group::Triangles,
            power: emission.power(),
            bounds: Some(bounds),
        })
    }

    /// Adds a punctual light at a position relative to the camera.
    pub fn add_punctual(
        &mut self,
        index: u32,
        light: &PunctualLight,
        position: Vec3,
        scene_radius: f64,
    ) -> u32 {
        let intensity = luminance(light.intensity.as_dvec3());
        let bounds = LightBounds::punctual(light, position, intensity);
        self.add(Entry {
            kind: LIGHT_PUNCTUAL,
            index,
            group: match bounds {
                Some(_) => Group::Points,
                None => Group::Directional,
            },
            power: punctual_power(light, scene_radius),
            bounds,
        })
    }

    /// Adds the environment, with its mean radiance.
    pub fn add_environment(&mut self, mean: DVec3, scene_radius: f64) -> u32 {
        let area = std::f64::consts::PI * scene_radius * scene_radius;
        self.add(Entry {
            kind: LIGHT_ENVIRONMENT,
            index: 0,
            group: Group::Environment,
            power: 4.0 * std::f64::consts::PI * area * luminance(mean),
            bounds: None,
        })
    }

    fn add(&mut self, entry: Entry) -> u32 {
        self.entries.push(entry);
        self.entries.len() as u32 - 1
    }

    /// Lights that are somewhere.
    pub fn placed(&self) -> usize {
        self.entries.partition_point(|e| e.bounds.is_some())
    }

    /// Makes the table and, if lights are to be chosen by it and any is somewhere, the tree. Without a wish
    /// the number of lights decides.
    pub fn finish(&self, wish: Option<LightSelection>) -> Lights {
        let placed = self.placed();
        let suited = wish.unwrap_or_else(|| LightSelection::suited_to(placed));
        match suited {
            LightSelection::Uniform => self.alone(LightSelection::Uniform, &|_| 1.0),
            LightSelection::Tree if placed > 0 => self.with_tree(placed),
            LightSelection::Power | LightSelection::Tree => {
                let weights = weights(self.entries.iter().map(|e| (e.group, e.power)));
                self.alone(LightSelection::Power, &|i| weights[i])
            }
        }
    }

    /// One alias table over all.
    fn alone(&self, selection: LightSelection, weight: &dyn Fn(usize) -> f64) -> Lights {
        let weights: Vec<f64> = (0..self.entries.len()).map(weight).collect();
        Lights {
            table: table(&self.entries, &weights, 0, 1.0),
            selection: Some(selection),
            ..Lights::default()
        }
    }

    fn with_tree(&self, placed: usize) -> Lights {
        let (inside, outside) = self.entries.split_at(placed);
        let bounds: Vec<LightBounds> = inside.iter().filter_map(|e| e.bounds).collect();
        let (mut tree, tree_time) = timed_stage("light tree", || LightTree::build(&bounds));
        let power = inside.iter().map(|e| e.power).sum();
        let others = outside.iter().map(|e| (e.group, e.power));
        let weights = weights(std::iter::once((Group::Tree, power)).chain(others));
        let threshold = threshold(weights[0]);
        tree.head(placed as u32, outside.len() as u32, threshold);
        let leaf = |(entry, trail): (&Entry, &u32)| layout::Light {
            alias_index: *trail,
            kind_and_index: entry.kind << LIGHT_KIND_SHIFT | entry.index,
            ..layout::Light::default()
        };
        let mut all: Vec<_> = inside.iter().zip(&tree.trails).map(leaf).collect();
        let share = 1.0 - f64::from(threshold) / 4_294_967_296.0;
        all.extend(table(outside, &weights[1..], placed, share));
        Lights {
            table: all,
            tree: Some(tree),
            outside_tree: outside.len(),
            selection: Some(LightSelection::Tree),
            tree_time,
        }
    }
}

/// The probability of the tree in 2⁻³², neither 0 nor 1, as a number that an f32 holds.
fn threshold(share: f64) -> u32 {
    let steps = (share * 16_777_216.0).round().clamp(1.0, 16_777_215.0);
    (steps as u32) << 8
}

/// The alias table over lights, whose indices begin with `first`; all of them together have the
/// probability `share`.
fn table(entries: &[Entry], weights: &[f64], first: usize, share: f64) -> Vec<layout::Light> {
    let columns = alias_table(weights).unwrap_or_default();
    let light = |(light, entry): (&Entry, super::AliasEntry)| layout::Light {
        threshold: entry.threshold,
        alias_index: first as u32 + entry.alias,
        probability: (share * f64::from(entry.probability)) as f32,
        kind_and_index: light.kind << LIGHT_KIND_SHIFT | light.index,
    };
    entries.iter().zip(columns).map(light).collect()
}

/// Half of the probability goes by power, half evenly to the groups that there are (and within a group by
/// power).
fn weights(lights: impl Iterator<Item = (Group, f64)> + Clone) -> Vec<f64> {
    let mut power_of = [0.0; 5];
    for (group, power) in lights.clone() {
        power_of[group as usize] += power;
    }
    let total: f64 = power_of.iter().sum();
    let groups = power_of.iter().filter(|p| **p > 0.0).count() as f64;
    let weight = |(group, power)| {
        let share = power_of[group as usize];
        if share > 0.0 {
            0.5 * power / total + 0.5 * power / (share * groups)
        } else {
            0.0
        }
    };
    lights.map(weight).collect()
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

/// A light's position as the device knows it, relative to `origin`.
pub fn position(light: &PunctualLight, origin: DVec3) -> Vec3 {
    (light.position - origin).as_vec3()
}

/// The device's form of a punctual light, relative to `origin`.
pub fn punctual(light: &PunctualLight, origin: DVec3) -> layout::PunctualLight {
    let (kind, inner, outer) = match light.kind {
        LightKind::Point => (0, 0.0, 1.0),
        LightKind::Spot { inner, outer } => (1, versine(inner), versine(outer)),
        LightKind::Directional => (2, 0.0, 1.0),
    };
    layout::PunctualLight {
        position: position(light, origin).to_array(),
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
