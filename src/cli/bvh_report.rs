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
    /// Of nodes and triangles together, on the device.
    pub bytes: u64,
    /// The same, by the number of triangles in it; null if there are none.
    pub bytes_per_triangle: Option<f64>,
    /// Nodes on the longest way down.
    pub depth: u32,
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
