//! Samplers: how textures are filtered, and what lies beyond their edges.

use super::error::LoadError;
use super::json::Item;
use crate::scene::{Filter, Sampler, Wrap};

/// What glTF prescribes where a texture names no sampler.
pub(super) const DEFAULT: Sampler = Sampler {
    wrap_u: Wrap::Repeat,
    wrap_v: Wrap::Repeat,
    filter: Filter::Linear,
};

/// Read all samplers of the file.
pub(super) fn read_all(root: &Item) -> Result<Vec<Sampler>, LoadError> {
    let items = root.items("samplers", "sampler")?;
    let read = |item: &Item| {
        Ok(Sampler {
            wrap_u: wrap(item, "wrapS")?,
            wrap_v: wrap(item, "wrapT")?,
            filter: filter(item)?,
        })
    };
    items.iter().map(read).collect()
}

fn wrap(item: &Item, key: &str) -> Result<Wrap, LoadError> {
    match item.count(key)? {
        None | Some(10497) => Ok(Wrap::Repeat),
        Some(33071) => Ok(Wrap::ClampToEdge),
        Some(33648) => Ok(Wrap::MirroredRepeat),
        Some(other) => Err(item.fault(format!(
            "`{key}` is {other}, expected 10497, 33071 or 33648"
        ))),
    }
}

fn filter(item: &Item) -> Result<Filter, LoadError> {
    match item.count("magFilter")? {
        None | Some(9729) => Ok(Filter::Linear),
        Some(9728) => Ok(Filter::Nearest),
        Some(other) => Err(item.fault(format!("`magFilter` is {other}, expected 9728 or 9729"))),
    }
}
