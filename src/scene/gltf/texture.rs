//! Textures: samplers, and the images that used materials read.

use std::collections::{BTreeMap, HashMap};

use rayon::prelude::*;

use super::error::LoadError;
use super::files::Files;
use super::image::{self, Budget, Decoded, Encoded, Transfer};
use super::json::Item;
use super::lenient::Lenient;
use super::material::{RawMaterial, Slot};
use super::{buffer::Data, texture_sampler};
use crate::scene::{Image, Sampler, Texture};

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

/// Load the textures that the slots of `materials` read. Where the file may be wrong, a texture that
/// is gets a magenta image.
pub(super) fn load<'m>(
    root: &Item,
    data: &Data,
    files: &mut Files,
    materials: impl Iterator<Item = &'m RawMaterial>,
    lenient: Lenient,
    warnings: &mut Vec<String>,
) -> Result<Textures, LoadError> {
    let used = uses(materials);
    let items = root.items("textures", "texture")?;
    let mut finder = Finder {
        samplers: texture_sampler::read_all(root)?,
        images: root.items("images", "image")?,
        known: BTreeMap::new(),
        encoded: Vec::new(),
    };
    let mut result = Textures::default();
    for &texture in used.keys() {
        let found = finder.find(&items[texture], data, files, warnings);
        let found = lenient.or_else(found, warnings, || finder.magenta())?;
        result.index.insert(texture, result.textures.len());
        result.textures.push(found);
    }
    let encoded = finder.encoded;
    let decoded = decode_once(&encoded, data, &mut result.textures, lenient, warnings)?;
    for (use_, texture) in used.values().zip(&result.textures) {
        let (label, transfer) = &decoded.labels[texture.image];
        use_.check(label, *transfer, warnings);
    }
    result.images = decoded.images;
    Ok(result)
}

/// Which kinds of slots read a texture.
#[derive(Debug, Default)]
struct Use {
    as_color: bool,
    as_data: bool,
}

/// The textures that materials read.
fn uses<'m>(materials: impl Iterator<Item = &'m RawMaterial>) -> BTreeMap<usize, Use> {
    let mut uses: BTreeMap<usize, Use> = BTreeMap::new();
    for (place, slot) in materials.flat_map(RawMaterial::filled_slots) {
        let entry = uses.entry(slot.texture).or_default();
        match encoding(place) {
            Some(Transfer::Srgb) => entry.as_color = true,
            Some(Transfer::Linear) => entry.as_data = true,
            None => {}
        }
    }
    uses
}

/// How glTF says that RGB is encoded in the texture of a slot; none if the slot reads alpha alone.
fn encoding(slot: Slot) -> Option<Transfer> {
    match slot {
        Slot::BaseColor
        | Slot::Emissive
        | Slot::SpecularColor
        | Slot::SheenColor
        | Slot::DiffuseTransmissionColor => Some(Transfer::Srgb),
        Slot::Specular | Slot::SheenRoughness | Slot::DiffuseTransmission => None,
        _ => Some(Transfer::Linear),
    }
}

impl Use {
    /// Warn where an image says that it is not encoded as its slots read it: the slots decide.
    fn check(&self, label: &str, transfer: Option<Transfer>, warnings: &mut Vec<String>) {
        let wrong = match transfer {
            Some(Transfer::Linear) if self.as_color => ("linear", "colours, which are sRGB"),
            Some(Transfer::Srgb) if self.as_data => ("sRGB", "numbers, which are linear"),
            _ => return,
        };
        warnings.push(format!(
            "{label}: its transfer function is {}, but a material reads it as {}; the material is followed",
            wrong.0, wrong.1
        ));
    }
}

/// Finds images of textures.
struct Finder<'a, 'j> {
    samplers: Vec<Sampler>,
    images: Vec<Item<'j>>,
    /// Position in `encoded` of the file's images.
    known: BTreeMap<usize, usize>,
    encoded: Vec<Encoded<'a>>,
}

impl<'a> Finder<'a, '_> {
    /// The texture `item`, its image an index into `encoded`.
    fn find(
        &mut self,
        item: &Item,
        data: &'a Data,
        files: &mut Files,
        warnings: &mut Vec<String>,
    ) -> Result<Texture, LoadError> {
        let (source, extension) = source(item, self.images.len(), warnings)?;
        let sampler = item.index("sampler", "sampler", self.samplers.len())?;
        let image = match self.known.get(&source) {
            Some(&image) => image,
            None => {
                let found = image::find(&self.images[source], item.label(), data, files)?;
                self.encoded.push(found);
                self.known.insert(source, self.encoded.len() - 1);
                self.encoded.len() - 1
            }
        };
        let encoded = &self.encoded[image];
        if let Some(needed) = encoded.needs_extension().filter(|_| extension.is_none()) {
            warnings.push(format!(
                "{}: glTF allows its format only through {needed}; it is shown all the same",
                encoded.label()
            ));
        }
        Ok(Texture {
            image,
            sampler: sampler.map_or(texture_sampler::DEFAULT, |sampler| self.samplers[sampler]),
        })
    }

    /// What takes the place of a texture that is wrong.
    fn magenta(&mut self) -> Texture {
        self.encoded.push(Encoded::magenta());
        Texture {
            image: self.encoded.len() - 1,
            sampler: texture_sampler::DEFAULT,
        }
    }
}

/// Distinct images, and for each its label and how it says that it is encoded.
#[derive(Debug, Default)]
struct Distinct {
    images: Vec<Image>,
    labels: Vec<(String, Option<Transfer>)>,
}

/// Decode each distinct image once, in parallel, and let the textures share the results.
fn decode_once(
    encoded: &[Encoded],
    data: &Data,
    textures: &mut [Texture],
    lenient: Lenient,
    warnings: &mut Vec<String>,
) -> Result<Distinct, LoadError> {
    let mut first_of = HashMap::new();
    let mut distinct: Vec<&Encoded> = Vec::new();
    let mut index = Vec::with_capacity(encoded.len());
    for image in encoded {
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
    let decoded: Vec<Result<Decoded, LoadError>> = distinct
        .par_iter()
        .map(|image| image.decode(&Budget::new(data)))
        .collect();
    let mut result = Distinct::default();
    for (encoded, decoded) in distinct.into_iter().zip(decoded) {
        let decoded = lenient.or_else(decoded, warnings, image::magenta)?;
        result.images.push(decoded.image);
        result
            .labels
            .push((encoded.label().to_owned(), decoded.transfer));
    }
    Ok(result)
}

/// Extensions that name an image of a texture: those that are read, the preferred one first, and those
/// that are not.
const READ: [&str; 2] = ["KHR_texture_basisu", "EXT_texture_webp"];
const NOT_READ: [&str; 2] = ["MSFT_texture_dds", "EXT_texture_avif"];

/// The image that a texture shows, and the extension that names it.
///
/// An extension's image goes before the texture's own `source`, which is there for programs that do
/// not know the extension.
fn source(
    item: &Item,
    images: usize,
    warnings: &mut Vec<String>,
) -> Result<(usize, Option<&'static str>), LoadError> {
    for name in READ {
        if let Some(extension) = item.extension(name)? {
            let source = extension.index("source", "image", images)?;
            let source = source.ok_or_else(|| extension.fault("`source` is missing"))?;
            return Ok((source, Some(name)));
        }
    }
    let source = item.index("source", "image", images)?;
    let mut unread = None;
    for name in NOT_READ {
        if item.extension(name)?.is_some() {
            unread = unread.or(Some(name));
        }
    }
    match (source, unread) {
        (Some(source), None) => Ok((source, None)),
        (Some(source), Some(extension)) => {
            warnings.push(format!(
                "{}: {extension} is not supported; its other image is used",
                item.label()
            ));
            Ok((source, None))
        }
        (None, Some(extension)) => Err(item.fault(format!(
            "its image needs the extension {extension}, which is not supported; export it as PNG or JPEG"
        ))),
        (None, None) => Err(item.fault("it has no image (`source` is missing)")),
    }
}
