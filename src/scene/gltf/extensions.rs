//! Which extensions a file names, and what is done about each.

use std::collections::{BTreeMap, BTreeSet};

use serde_json::Value;

use super::error::LoadError;
use super::json::{Item, shorten};
use crate::scene::ExtensionUse;

/// The extensions that étendue renders.
pub const SUPPORTED: &[&str] = &[
    "EXT_lights_image_based",
    "EXT_texture_webp",
    "EXT_mesh_gpu_instancing",
    "EXT_meshopt_compression",
    "KHR_draco_mesh_compression",
    "KHR_lights_punctual",
    "KHR_materials_anisotropy",
    "KHR_materials_clearcoat",
    "KHR_materials_diffuse_transmission",
    "KHR_materials_dispersion",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_iridescence",
    "KHR_materials_pbrSpecularGlossiness",
    "KHR_materials_sheen",
    "KHR_materials_specular",
    "KHR_materials_transmission",
    "KHR_materials_unlit",
    "KHR_materials_variants",
    "KHR_materials_volume",
    "KHR_mesh_quantization",
    "KHR_meshopt_compression",
    "KHR_node_visibility",
    "KHR_texture_basisu",
    "KHR_texture_transform",
];

/// What is missing from the picture without an extension.
fn effect(name: &str) -> &'static str {
    match name {
        "KHR_materials_transmission" => "surfaces that light passes through",
        "KHR_materials_volume" => "absorption inside of surfaces",
        "KHR_materials_volume_scatter" => "scattering inside of surfaces",
        "KHR_materials_clearcoat" => "clear coats",
        "KHR_materials_sheen" => "sheen of cloth",
        "KHR_materials_anisotropy" => "anisotropic highlights",
        "KHR_materials_iridescence" => "iridescence of thin films",
        "KHR_materials_dispersion" => "dispersion of light",
        "KHR_materials_diffuse_transmission" => "translucence",
        "KHR_materials_variants" => "variants of materials; the default one is shown",
        "KHR_materials_pbrSpecularGlossiness" => "specular-glossiness materials",
        "EXT_texture_avif" => "AVIF textures",
        "MSFT_texture_dds" => "DDS textures",
        "KHR_animation_pointer" => "animations of properties",
        "KHR_xmp_json_ld" | "KHR_xmp" => "metadata",
        _ => "what it describes",
    }
}

/// List the extensions of the file, refuse required ones that are not supported, and warn of the rest.
/// One that only names textures' images is no reason to refuse the file if wrong textures are none.
pub(super) fn check(
    root: &Item,
    json: &Value,
    lenient: bool,
    warnings: &mut Vec<String>,
) -> Result<Vec<ExtensionUse>, LoadError> {
    let required = names(root, "extensionsRequired")?;
    let used = names(root, "extensionsUsed")?;
    let will_do = |name: &str| is_supported(name) || lenient && is_image_format(name);
    if let Some(name) = required.iter().find(|name| !will_do(name)) {
        return Err(LoadError::Extension {
            path: root.file().to_owned(),
            name: shorten(name),
            what: effect(name).to_owned(),
        });
    }
    let found = found_in(json);
    let all: BTreeSet<&str> = required
        .iter()
        .chain(&used)
        .chain(found.keys())
        .copied()
        .collect();
    for &name in &all {
        let listed = used.contains(name) || required.contains(name);
        warnings.extend(warning(name, listed));
    }
    let uses = all.into_iter().map(|name| ExtensionUse {
        name: name.to_owned(),
        required: required.contains(name),
        supported: is_supported(name),
    });
    Ok(uses.collect())
}

fn warning(name: &str, listed: bool) -> Option<String> {
    if !is_supported(name) {
        return Some(format!(
            "the extension {} is not supported: the picture does not show {}",
            shorten(name),
            effect(name)
        ));
    }
    (!listed).then(|| format!("{name} is used but not listed in `extensionsUsed`; it is honoured"))
}

fn is_image_format(name: &str) -> bool {
    ["EXT_texture_avif", "MSFT_texture_dds"].contains(&name)
}

fn is_supported(name: &str) -> bool {
    SUPPORTED.contains(&name)
}

fn names<'a>(root: &Item<'a>, key: &str) -> Result<BTreeSet<&'a str>, LoadError> {
    let name = |value: &'a Value| {
        value
            .as_str()
            .ok_or_else(|| root.fault(format!("`{key}` must be an array of names")))
    };
    root.array(key)?.iter().map(name).collect()
}

/// Every extension that some object of the file holds, and how often.
fn found_in(json: &Value) -> BTreeMap<&str, usize> {
    let mut found = BTreeMap::new();
    let mut open = vec![json];
    while let Some(value) = open.pop() {
        match value {
            Value::Array(values) => {
                open.extend(values.iter().filter(|v| v.is_array() || v.is_object()))
            }
            Value::Object(map) => {
                if let Some(Value::Object(extensions)) = map.get("extensions") {
                    for name in extensions.keys() {
                        *found.entry(name.as_str()).or_insert(0) += 1;
                    }
                }
                // Extras are the author's own affair.
                open.extend(
                    map.iter()
                        .filter(|(key, _)| *key != "extras")
                        .map(|(_, value)| value),
                );
            }
            _ => {}
        }
    }
    found
}
