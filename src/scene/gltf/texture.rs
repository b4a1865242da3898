//! Textures: samplers, and the images that used materials read.

use std::collections::{BTreeMap, BTreeSet, HashMap};

use rayon::prelude::*;

use super::buffer::Data;
use super::error::LoadError;
use super::files::Files;
use super::image::{self, Encoded};
use super::json::Item;
use super::material::RawMaterial;
use crate::scene::{Filter, Image, Sampler, Texture, Wrap};

/// The textures that a scene uses.
#[derive(Debug, Default)]
pub(super) struct Textures {
    /// The scene's textures.
    pub textures: Vec<Texture>,
    /// Their images, decoded.
    pub images: Vec<Image>,
    /// The scene's texture for each of the file's that is used.
    pub index: BTreeMap<usize, usize>,
}

/// Load the textures that the slots of `materials` read.
pub(super) fn load<'m>(
    root: &Item,
    data: &Data,
    files: &mut Files,
    materials: impl Iterator<Item = &'m RawMaterial>,
    warnings: &mut Vec<String>,
) -> Result<Textures, LoadError> {
    let slots = materials.flat_map(|material| material.slots.iter().flatten());
    let used: BTreeSet<usize> = slots.map(|slot| slot.texture).collect();
    let items = root.items("textures", "texture")?;
    let samplers = read_samplers(root)?;
    let image_items = root.items("images", "image")?;
    let mut result = Textures::default();
    let mut image_index = BTreeMap::new();
    let mut encoded = Vec::new();
    for texture in used {
        let item = &items[texture];
        let source = source(item, image_items.len(), warnings)?;
        let image = match image_index.get(&source) {
            Some(&image) => image,
            None => {
                encoded.push(image::find(&image_items[source], item, data, files)?);
                image_index.insert(source, encoded.len() - 1);
                encoded.len() - 1
            }
        };
        let sampler = item.index("sampler", "sampler", samplers.len())?;
        result.index.insert(texture, result.textures.len());
        result.textures.push(Texture {
            image,
            sampler: sampler.map_or(DEFAULT_SAMPLER, |sampler| samplers[sampler]),
        });
    }
    result.images = decode_once(encoded, data, &mut result.textures)?;
    Ok(result)
}

/// Decode each distinct image once, in parallel, and let the textures share the results.
fn decode_once(
    encoded: Vec<Encoded>,
    data: &Data,
    textures: &mut [Texture],
) -> Result<Vec<Image>, LoadError> {
    let mut first_of = HashMap::new();
    let mut distinct: Vec<&Encoded> = Vec::new();
    let mut index = Vec::with_capacity(encoded.len());
    for image in &encoded {
        let shared = *first_of.entry(image.identity()).or_insert_with(|| {
            distinct.push(image);
            distinct.len() - 1
        });
        index.push(shared);
    }
    for texture in textures {
        texture.image = index[texture.image];
    }
    // Collect first: the error of the first image wins, whatever thread finds it.
    let images: Vec<Result<Image, LoadError>> = distinct
        .into_par_iter()
        .map(|image| image.decode(data))
        .collect();
    images.into_iter().collect()
}

/// The image that a texture shows.
fn source(item: &Item, images: usize, warnings: &mut Vec<String>) -> Result<usize, LoadError> {
    let source = item.index("source", "image", images)?;
    let mut alternatives = Vec::new();
    for extension in [
        "KHR_texture_basisu",
        "EXT_texture_webp",
        "MSFT_texture_dds",
        "EXT_texture_avif",
    ] {
        if item.extension(extension)?.is_some() {
            alternatives.push(extension);
        }
    }
    match (source, alternatives.as_slice()) {
        (Some(source), []) => Ok(source),
        (Some(source), [extension, ..]) => {
            warnings.push(format!(
                "{}: {extension} is not supported; its other image is used",
                item.label()
            ));
            Ok(source)
        }
        (None, [extension, ..]) => Err(item.fault(format!(
            "its image needs the extension {extension}, which is not supported; export it as PNG or JPEG"
        ))),
        (None, []) => Err(item.fault("it has no image (`source` is missing)")),
    }
}

/// What glTF prescribes where a texture names no sampler.
const DEFAULT_SAMPLER: Sampler = Sampler {
    wrap_u: Wrap::Repeat,
    wrap_v: Wrap::Repeat,
    filter: Filter::Linear,
};

fn read_samplers(root: &Item) -> Result<Vec<Sampler>, LoadError> {
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
