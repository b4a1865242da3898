//! Path guiding: what paths of a training pass found decides where the diffuse lobe's samples go
//! (`shaders/guide.wgsl`).

mod density;
mod effort;
mod forecast;
mod lesson;
mod table;
mod training;

pub use effort::{Effort, LightSamples, Roulette};
pub use lesson::Lesson;
pub use table::Table as GuideTable;
pub use training::{Training, train};

use crate::gpu::Buffer;
use crate::host::names;
use crate::render::layout::PathRecord;
use crate::render::program::Constant;

/// Whether paths are guided.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Guiding {
    /// Where a training pass says that it pays.
    #[default]
    Auto,
    /// Always, where it can be done.
    On,
    /// Never.
    Off,
}

impl Guiding {
    /// Its name: `auto`, `on` or `off`.
    pub fn name(self) -> &'static str {
        match self {
            Guiding::Auto => "auto",
            Guiding::On => "on",
            Guiding::Off => "off",
        }
    }
}

impl std::fmt::Display for Guiding {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        f.write_str(self.name())
    }
}

impl std::str::FromStr for Guiding {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        let all = [Guiding::Auto, Guiding::On, Guiding::Off];
        names::find(&all, Guiding::name, name)
    }
}

/// What a kernel has to do with training; nothing by default.
#[derive(Clone, Copy)]
pub struct Guidance<'a> {
    /// It is guided by this buffer.
    pub guide: Option<&'a Buffer>,
    /// It leaves records of its paths in this one.
    pub records: Option<&'a Buffer>,
    /// Throughput below which its paths may end ([`Effort::roulette`]).
    pub roulette: Option<f32>,
    /// Light samples at the first vertices of its paths, unless the shader's override says how many.
    pub light_samples: u32,
}

impl Default for Guidance<'_> {
    fn default() -> Self {
        Self {
            guide: None,
            records: None,
            roulette: None,
            light_samples: 1,
        }
    }
}

impl<'a> Guidance<'a> {
    /// The buffers with their bindings.
    pub fn bindings(self) -> impl Iterator<Item = (u32, &'a Buffer)> {
        // The table, and its header by itself.
        let guide = self.guide.map(|buffer| [(11, buffer), (16, buffer)]);
        guide
            .into_iter()
            .flatten()
            .chain(self.records.map(|buffer| (12, buffer)))
    }

    /// The generated constants that say so.
    pub fn constants(self) -> [(&'static str, Constant); 4] {
        [
            ("HAS_GUIDE", Constant::Bool(self.guide.is_some())),
            ("RECORDS_PATHS", Constant::Bool(self.records.is_some())),
            (
                "HAS_ROULETTE_THRESHOLD",
                Constant::Bool(self.roulette.is_some()),
            ),
            ("LEARNT_LIGHT_SAMPLES", Constant::U32(self.light_samples)),
        ]
    }
}
