//! What a report says about the acceleration structure.

use serde::Serialize;

use crate::accel::Preset;
use crate::render::Prepared;

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
    pub triangles: usize,
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
            instancing: InstancingReport {
                trees: prepared.bvh.trees.len(),
                instances: prepared.bvh.instances.len(),
                triangles,
                estimated_bytes: prepared.sharing.bytes,
                estimated_bytes_flat: prepared.sharing.flat_bytes,
            },
        }
    }

    /// Names and values, to be aligned.
    pub fn rows(&self) -> Vec<Vec<String>> {
        let row = |name: &str, value: String| vec![name.to_owned(), value];
        let share = self
            .bytes_per_triangle
            .map_or(String::new(), |share| format!(", {share:.1} a triangle"));
        let mut rows = vec![
            row("preset", self.preset.into()),
            row("build", format!("{:.3} s", self.seconds)),
            row("bytes", format!("{}{share}", self.bytes)),
            row("depth", self.depth.to_string()),
        ];
        let i = &self.instancing;
        if i.instances > 0 {
            let shared = format!(
                "{} of {} trees, with {} triangles in memory",
                i.instances, i.trees, i.triangles
            );
            let bytes = format!(
                "about {}, flattened {}",
                i.estimated_bytes, i.estimated_bytes_flat
            );
            rows.extend([row("instances", shared), row("geometry bytes", bytes)]);
        }
        rows
    }
}
