//! The order in which the parts of a file are loaded.

use std::collections::BTreeSet;
use std::path::Path;

use serde_json::Value;

use super::buffer::Data;
use super::error::LoadError;
use super::files::Files;
use super::json::Item;
use super::lenient::Lenient;
use super::material::{self, RawMaterial};
use super::meshes::Stand;
use super::node::{Nodes, Placed};
use super::primitive::Source;
use super::texture::{self, Textures};
use super::{
    LoadOptions, accessor, animation, camera, extensions, framing, image_light, light, meshes,
    variants,
};
use crate::host::stages::stage;
use crate::scene::{Scene, TextureSlot};

/// Load the chosen scene of a parsed file.
pub(super) fn load(
    path: &Path,
    bytes: &[u8],
    json: &Value,
    binary: Option<&[u8]>,
    options: &LoadOptions,
) -> Result<Scene, LoadError> {
    let root = Item::root(path, json)?;
    check_version(&root)?;
    let mut scene = Scene {
        source: path.to_owned(),
        ..Scene::default()
    };
    scene.extensions = extensions::check(&root, json, options.lenient, &mut scene.warnings)?;
    let nodes = Nodes::read(&root)?;
    let roots = choose_scene(&root, &nodes, options, &mut scene)?;
    let mut files = Files::new(bytes);
    let lenient = Lenient(options.lenient);
    let data = stage("buffers", || Data::load(&root, &mut files, binary))?;
    let accessors = accessor::read_all(&root, &data)?;
    let mut materials = material::read_all(&root, lenient, &mut scene.warnings)?;
    materials.push(default_material());
    let variant = variants::choose(&root, options, &mut scene)?;
    let source = Source {
        data: &data,
        accessors: &accessors,
        materials: &materials,
        variant,
        variants: scene.variant_names.len(),
    };
    let pose = animation::pose(&root, &nodes, source, options, &mut scene)?;
    let placed = nodes.place(&roots, &pose, &mut scene.warnings)?;
    place_cameras_and_lights(&root, &nodes, &placed, &mut scene)?;
    let stand = Stand {
        nodes: &nodes,
        pose: &pose,
        placed: &placed,
    };
    stage("meshes", || meshes::load(&root, stand, source, &mut scene))?;
    load_textures(&root, &data, materials, &mut files, lenient, &mut scene)?;
    scene.hash = files.hash();
    if scene.cameras.is_empty() {
        scene.cameras.push(framing::camera(&scene));
        scene
            .notes
            .push("the scene has no camera; one that frames it is used".to_owned());
    }
    shorten_warnings(&mut scene.warnings);
    Ok(scene)
}

/// Load the textures that the meshes' materials read, and finish the materials.
fn load_textures(
    root: &Item,
    data: &Data,
    materials: Vec<RawMaterial>,
    files: &mut Files,
    lenient: Lenient,
    scene: &mut Scene,
) -> Result<(), LoadError> {
    let used: BTreeSet<usize> = scene.meshes.iter().map(|mesh| mesh.material).collect();
    let used_materials = used.iter().map(|&index| &materials[index]);
    let textures = stage("images", || {
        let warnings = &mut scene.warnings;
        texture::load(root, data, files, used_materials, lenient, warnings)
    })?;
    stage("images", || {
        image_light::load(root, data, files, lenient, scene)
    })?;
    fill_materials(scene, materials, &used, &textures);
    scene.textures = textures.textures;
    scene.images = textures.images;
    Ok(())
}

/// glTF 2.x, and nothing newer than 2.0 required.
fn check_version(root: &Item) -> Result<(), LoadError> {
    let asset = root.object("asset", "asset")?;
    let asset = asset.ok_or_else(|| root.fault("`asset` is missing; this is not glTF 2.0"))?;
    let version = asset.text("version")?.unwrap_or("none");
    let newest = asset.text("minVersion")?.unwrap_or("2.0");
    if version.split('.').next() != Some("2") {
        return Err(asset.fault(format!(
            "the glTF version is {:?}, expected \"2.0\"; export the scene as glTF 2.0",
            super::json::shorten(version)
        )));
    }
    match newest {
        "2.0" => Ok(()),
        _ => Err(asset.fault(format!(
            "`minVersion` is {:?}, but only glTF 2.0 is supported",
            super::json::shorten(newest)
        ))),
    }
}

/// The root nodes of the scene that the options, or else the file, choose.
fn choose_scene(
    root: &Item,
    nodes: &Nodes,
    options: &LoadOptions,
    scene: &mut Scene,
) -> Result<Vec<usize>, LoadError> {
    let items = root.items("scenes", "scene")?;
    let default = root.index("scene", "scene", items.len())?;
    scene.scene_names = items.iter().map(|item| item.name().to_owned()).collect();
    if let Some(selector) = &options.scene {
        let found = selector.find("scene", &scene.scene_names);
        scene.scene_index = found.map_err(|source| LoadError::Select {
            path: root.file().to_owned(),
            source,
        })?;
    } else {
        scene.scene_index = default.unwrap_or(0);
    }
    match items.get(scene.scene_index) {
        Some(item) => item.indices("nodes", "node", nodes.len()),
        None => Ok(nodes.roots()),
    }
}

fn place_cameras_and_lights(
    root: &Item,
    nodes: &Nodes,
    placed: &[Placed],
    scene: &mut Scene,
) -> Result<(), LoadError> {
    let cameras = camera::read_all(root)?;
    let lights = light::read_all(root, &mut scene.warnings)?;
    for Placed {
        node,
        to_world,
        visible,
    } in placed
    {
        let item = nodes.item(*node);
        if let Some(index) = item.index("camera", "camera", cameras.len())? {
            let camera = camera::place(&cameras[index], item, to_world);
            scene.cameras.push(camera);
        }
        if let Some(index) = light::of_node(item, lights.len())?.filter(|_| *visible) {
            scene
                .lights
                .push(light::place(&lights[index], item, to_world));
        }
    }
    Ok(())
}

/// The material of primitives that name none.
fn default_material() -> RawMaterial {
    RawMaterial {
        label: "the default material".to_owned(),
        tex_coords: [0, 1],
        ..RawMaterial::default()
    }
}

/// Put the scene's texture indices into the materials that are used; the others get no textures.
fn fill_materials(
    scene: &mut Scene,
    raw: Vec<RawMaterial>,
    used: &BTreeSet<usize>,
    textures: &Textures,
) {
    let default = raw.len() - 1;
    for (index, raw) in raw.into_iter().enumerate() {
        let is_used = used.contains(&index);
        if index == default && !is_used {
            break;
        }
        scene.materials.push(raw.filled(|slot| {
            let texture = textures.index.get(&slot.texture).filter(|_| is_used)?;
            Some(TextureSlot {
                texture: *texture,
                tex_coord: slot.tex_coord,
                matrix: slot.matrix,
                offset: slot.offset,
            })
        }));
    }
}

/// Each sentence once, and not more than anyone would read.
fn shorten_warnings(warnings: &mut Vec<String>) {
    const MOST: usize = 200;
    let mut seen = BTreeSet::new();
    warnings.retain(|warning| seen.insert(warning.clone()));
    if warnings.len() > MOST {
        let more = warnings.len() - MOST;
        warnings.truncate(MOST);
        warnings.push(format!("{more} more warnings are not shown"));
    }
}
