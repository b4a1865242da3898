//! What a report says about the acceleration structure.

use serde::Serialize;

use crate::accel::Preset;
use crate::render::{Prepared, Sharing};
use crate::scene::Scene;

/// The acceleration structure of a render.
#[derive(Debug, Clone, Default, Serialize)]
pub struct BvhReport {
    /// As asked for: `fast`, `balanced` or `best`.
    pub preset: &'static str,
    /// Wall time of its build, a part of the phase `accel`.
    pub seconds: f64,
    /// Of nodes, triangles and instances together, on the device.
    pub bytes: u64,
    /// The same, by the number of triangles in it; null if there are none.
    pub bytes_per_triangle: Option<f64>,
    /// Nodes on the longest way down.
    pub depth: u32,
    /// What instances share.
    pub instancing: InstancingReport,
}

/// Geometry that is on the device once and in the scene many times.
#[derive(Debug, Clone, Default, Serialize)]
pub struct InstancingReport {
    /// Trees with a space of their own, each of one mesh or of several that are placed together.
    pub trees: usize,
    /// Placements of these trees.
    pub instances: usize,
    /// Triangles that are in memory, those of a tree once.
    pub triangles: u64,
    /// Estimated bytes of all geometry and its structure,
    pub estimated_bytes: u64,
    /// and what they would be if every instance had a copy of its own.
    pub estimated_bytes_flat: u64,
}

impl BvhReport {
    /// Of a scene that was prepared with a preset.
    pub fn new(preset: Preset, prepared: &Prepared) -> BvhReport {
        let bytes = size_of_val(&prepared.bvh.elements[..]) as u64;
        let triangles = prepared.bvh.order.len();
        BvhReport {
            preset: preset.name(),
            seconds: prepared.bvh_time.as_secs_f64(),
            bytes,
            bytes_per_triangle: (triangles > 0).then(|| bytes as f64 / triangles as f64),
            depth: prepared.bvh.depth,
            instancing: InstancingReport::new(&prepared.sharing, triangles as u64),
        }
    }

    /// Names and values, to be aligned.
    pub fn rows(&self) -> Vec<Vec<String>> {
        let row = |name: &str, value: String| vec![name.to_owned(), value];
        let share = self
            .bytes_per_triangle
            .map_or(String::new(), |share| format!(", {share:.1} a triangle"));
        vec![
            row("preset", self.preset.into()),
            row("build", format!("{:.3} s", self.seconds)),
            row("bytes", format!("{}{share}", self.bytes)),
            row("depth", self.depth.to_string()),
        ]
    }
}

impl InstancingReport {
    /// Of a decision that leaves so many triangles in memory.
    pub fn new(sharing: &Sharing, triangles: u64) -> InstancingReport {
        InstancingReport {
            trees: sharing.trees.len(),
            instances: sharing.placements.len(),
            triangles,
            estimated_bytes: sharing.bytes,
            estimated_bytes_flat: sharing.flat_bytes,
        }
    }

    /// Before a scene is prepared.
    pub fn of(scene: &Scene, sharing: &Sharing) -> InstancingReport {
        InstancingReport::new(sharing, sharing.counts(scene).0)
    }

    /// In words.
    pub fn describe(&self) -> String {
        let bytes = format!("about {} bytes on the device", self.estimated_bytes);
        match self.instances {
            0 => format!("none shared, {bytes}"),
            n => format!(
                "{n} share {} trees: {} triangles, {bytes} instead of {}",
                self.trees, self.triangles, self.estimated_bytes_flat
            ),
        }
    }
}
