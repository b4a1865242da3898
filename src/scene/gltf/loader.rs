//! The order in which the parts of a file are loaded.

use std::collections::BTreeSet;
use std::path::Path;

use rayon::prelude::*;
use serde_json::Value;

use super::buffer::Data;
use super::error::LoadError;
use super::files::Files;
use super::json::Item;
use super::material::{self, RawMaterial};
use super::node::{Nodes, Placed};
use super::primitive::{self, Loaded, Source};
use super::texture::{self, Textures};
use super::{LoadOptions, accessor, camera, extensions, framing, light, pose};
use crate::scene::{Instance, Material, Scene, TextureSlot};

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
    scene.extensions = extensions::check(&root, json, &mut scene.warnings)?;
    let nodes = Nodes::read(&root)?;
    let roots = choose_scene(&root, &nodes, options, &mut scene)?;
    let placed = nodes.place(&roots, &mut scene.warnings)?;
    pose::warn_of_animations(&root, &mut scene.warnings)?;
    place_cameras_and_lights(&root, &nodes, &placed, &mut scene)?;

    let mut files = Files::new(bytes);
    let data = Data::load(&root, &mut files, binary)?;
    let accessors = accessor::read_all(&root, &data)?;
    let mut materials = material::read_all(&root, &mut scene.warnings)?;
    materials.push(default_material());
    let source = Source {
        data: &data,
        accessors: &accessors,
        materials: &materials,
    };
    load_meshes(&root, &nodes, &placed, source, &mut scene)?;
    let used: BTreeSet<usize> = scene.meshes.iter().map(|mesh| mesh.material).collect();
    let used_materials = used.iter().map(|&index| &materials[index]);
    let textures = texture::load(
        &root,
        &data,
        &mut files,
        used_materials,
        &mut scene.warnings,
    )?;
    fill_materials(&mut scene, materials, &used, textures);

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
    for Placed { node, to_world } in placed {
        let item = nodes.item(*node);
        if let Some(index) = item.index("camera", "camera", cameras.len())? {
            let camera = camera::place(&cameras[index], item, to_world);
            scene.cameras.push(camera);
        }
        if let Some(index) = light::of_node(item, lights.len())? {
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

/// Load the meshes that the placed nodes show, and place them.
fn load_meshes(
    root: &Item,
    nodes: &Nodes,
    placed: &[Placed],
    source: Source,
    scene: &mut Scene,
) -> Result<(), LoadError> {
    let items = root.items("meshes", "mesh")?;
    let mut shown = vec![None; placed.len()];
    for (shown, placed) in shown.iter_mut().zip(placed) {
        *shown = nodes.item(placed.node).index("mesh", "mesh", items.len())?;
    }
    let wanted: BTreeSet<usize> = shown.iter().flatten().copied().collect();
    let mut primitives = Vec::new();
    for &mesh in &wanted {
        pose::warn_of_morphs(&items[mesh], &mut scene.warnings)?;
        for primitive in items[mesh].items("primitives", "primitive")? {
            primitives.push((mesh, primitive));
        }
    }
    // Collect first: the error of the first primitive wins, whatever thread finds it.
    let loaded: Vec<Result<Loaded, LoadError>> = primitives
        .par_iter()
        .map(|(mesh, primitive)| primitive::load(primitive, items[*mesh].name(), source))
        .collect();
    let mut meshes_of = vec![Vec::new(); items.len()];
    for ((mesh, _), loaded) in primitives.iter().zip(loaded) {
        let loaded = loaded?;
        scene.warnings.extend(loaded.warnings);
        if let Some(triangles) = loaded.mesh {
            meshes_of[*mesh].push(scene.meshes.len());
            scene.meshes.push(triangles);
        }
    }
    let skins = pose::Skins::read(root, nodes, placed, source)?;
    for (placed, mesh) in placed.iter().zip(shown) {
        let Some(mesh) = mesh else { continue };
        let name = nodes.item(placed.node).name();
        let to_world = skins.rest_pose(nodes.item(placed.node), placed, &mut scene.warnings)?;
        scene
            .instances
            .extend(meshes_of[mesh].iter().map(|&mesh| Instance {
                mesh,
                to_world,
                name: name.to_owned(),
            }));
    }
    Ok(())
}

/// Put the scene's texture indices into the materials that are used; the others get no textures.
fn fill_materials(
    scene: &mut Scene,
    raw: Vec<RawMaterial>,
    used: &BTreeSet<usize>,
    textures: Textures,
) {
    let default = raw.len() - 1;
    for (index, raw) in raw.into_iter().enumerate() {
        if index == default && !used.contains(&index) {
            break;
        }
        let [
            base_color,
            metallic_roughness,
            normal,
            emissive,
            specular,
            specular_color,
        ] = raw.slots.map(|slot| {
            let slot = slot?;
            let &texture = textures.index.get(&slot.texture)?;
            Some(TextureSlot {
                texture,
                tex_coord: slot.tex_coord,
                matrix: slot.matrix,
                offset: slot.offset,
            })
            .filter(|_| used.contains(&index))
        });
        scene.materials.push(Material {
            base_color_texture: base_color,
            metallic_roughness_texture: metallic_roughness,
            normal_texture: normal,
            emissive_texture: emissive,
            specular_texture: specular,
            specular_color_texture: specular_color,
            ..raw.material
        });
    }
    scene.textures = textures.textures;
    scene.images = textures.images;
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
