//! Path guiding: what paths of a training pass found decides where the diffuse lobe's samples go
//! (`shaders/guide.wgsl`).

mod density;
mod forecast;
mod lesson;
mod table;
mod training;

pub use lesson::Lesson;
pub use table::Table as GuideTable;
pub use training::{Training, train};

use crate::gpu::Buffer;
use crate::render::layout::PathRecord;

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
        let found = all.into_iter().find(|g| g.name() == name);
        found.ok_or_else(|| format!("expected auto, on or off, not \"{name}\""))
    }
}

/// What a kernel has to do with guiding.
#[derive(Clone, Copy)]
pub enum Guidance<'a> {
    /// Nothing.
    None,
    /// It leaves records of its paths in this buffer.
    Records(&'a Buffer),
    /// It is guided by this one.
    By(&'a Buffer),
}

impl<'a> Guidance<'a> {
    /// The buffer with its binding.
    pub fn binding(self) -> Option<(u32, &'a Buffer)> {
        match self {
            Guidance::None => None,
            Guidance::By(buffer) => Some((11, buffer)),
            Guidance::Records(buffer) => Some((12, buffer)),
        }
    }

    /// The generated constants `HAS_GUIDE` and `RECORDS_PATHS`.
    pub fn constants(self) -> [(&'static str, bool); 2] {
        [
            ("HAS_GUIDE", matches!(self, Guidance::By(_))),
            ("RECORDS_PATHS", matches!(self, Guidance::Records(_))),
        ]
    }
}
