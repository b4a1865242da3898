//! How a light is chosen among many.

use std::fmt;
use std::str::FromStr;

use crate::host::names;

/// What the probability of a light follows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LightSelection {
    /// Nothing: all lights are alike.
    Uniform,
    /// Its power, wherever the light is wanted: half of the probability follows power, half goes evenly to
    /// the kinds of lights that there are.
    Power,
    /// What it may contribute where it is wanted, by a tree over all lights that are somewhere. The tree as
    /// a whole, directional lights and the environment are chosen as by [`LightSelection::Power`].
    Tree,
}

/// Lights that are somewhere (emissive triangles, point and spot lights) from which on a tree of them pays. Of fewer, many
/// are halves of lamps or walls of a room, whose share at a point their bounds tell badly.
const FEWEST_FOR_TREE: usize = 17;

impl LightSelection {
    /// All of them.
    pub const ALL: [LightSelection; 3] = [
        LightSelection::Uniform,
        LightSelection::Power,
        LightSelection::Tree,
    ];

    /// What suits a scene with so many lights that are somewhere.
    pub fn suited_to(lights: usize) -> Self {
        match lights >= FEWEST_FOR_TREE {
            true => Self::Tree,
            false => Self::Power,
        }
    }

    /// Its name: `uniform`, `power` or `tree`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Uniform => "uniform",
            Self::Power => "power",
            Self::Tree => "tree",
        }
    }
}

impl fmt::Display for LightSelection {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for LightSelection {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        names::find(&Self::ALL, Self::name, name)
    }
}
