//! KHR_materials_variants: primitives whose material depends on the variant that is shown.

use super::LoadOptions;
use super::error::LoadError;
use super::json::Item;
use crate::scene::Scene;

const NAME: &str = "KHR_materials_variants";

/// The variant that the options choose, if any; the scene gets the names of all.
pub(super) fn choose(
    root: &Item,
    options: &LoadOptions,
    scene: &mut Scene,
) -> Result<Option<usize>, LoadError> {
    let extension = root.extension(NAME)?;
    let variants = match &extension {
        Some(item) => item.items("variants", "variant")?,
        None => Vec::new(),
    };
    let name = |item: &Item| item.text("name").map(|name| name.unwrap_or("").to_owned());
    let names: Result<Vec<String>, LoadError> = variants.iter().map(name).collect();
    scene.variant_names = names?;
    let Some(selector) = &options.variant else {
        return Ok(None);
    };
    let found = selector.find("variant", &scene.variant_names);
    found.map(Some).map_err(|source| LoadError::Select {
        path: root.file().to_owned(),
        source,
    })
}

/// The material that a primitive has in a variant; none if the variant leaves it as it is.
pub(super) fn material(
    primitive: &Item,
    variant: Option<usize>,
    variants: usize,
    materials: usize,
) -> Result<Option<usize>, LoadError> {
    let Some(item) = primitive.extension(NAME)? else {
        return Ok(None);
    };
    let mut chosen = None;
    for mapping in item.items("mappings", "mapping")? {
        let of = mapping.indices("variants", "variant", variants)?;
        let material = mapping.index("material", "material", materials)?;
        let material = material.ok_or_else(|| mapping.fault("`material` is missing"))?;
        if chosen.is_none() && variant.is_some_and(|variant| of.contains(&variant)) {
            chosen = Some(material);
        }
    }
    Ok(chosen)
}
