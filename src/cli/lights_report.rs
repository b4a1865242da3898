//! What a report says about the lights.

use serde::Serialize;

use crate::render::{LightSelection, Prepared};

/// The lights of a render, and how one is chosen.
#[derive(Debug, Clone, Default, Serialize)]
pub struct LightsReport {
    /// `uniform`, `power` or `tree`; null without a light.
    pub selection: Option<&'static str>,
    /// Emissive triangles, punctual lights and the environment.
    pub count: usize,
    /// Those of them that are in the tree.
    pub in_tree: usize,
    /// Wall time of building the tree, a part of the phase `accel`.
    pub seconds: f64,
    /// Of the table and the tree, on the device.
    pub bytes: u64,
}

impl LightsReport {
    /// Of a prepared scene.
    pub fn new(prepared: &Prepared) -> Self {
        let lights = &prepared.lights;
        let count = lights.table.len();
        let outside = match lights.tree {
            Some(_) => lights.outside_tree,
            None => count,
        };
        let selection = lights.selection.filter(|_| count > 0);
        Self {
            selection: selection.map(LightSelection::name),
            count,
            in_tree: count - outside,
            seconds: lights.tree_time.as_secs_f64(),
            bytes: (size_of_val(&lights.table[..]) + size_of_val(lights.nodes())) as u64,
        }
    }

    /// Names and values, to be aligned.
    pub fn rows(&self) -> Vec<Vec<String>> {
        let row = |name: &str, value: String| vec![name.to_owned(), value];
        let Some(selection) = self.selection else {
            return Vec::new();
        };
        let mut rows = vec![
            row("by", selection.into()),
            row("lights", self.count.to_string()),
        ];
        if self.in_tree > 0 {
            rows.push(row("in the tree", self.in_tree.to_string()));
            rows.push(row("build", format!("{:.3} s", self.seconds)));
        }
        rows.push(row("bytes", self.bytes.to_string()));
        rows
    }
}
