//! A scene made ready for the device: flat, sorted by the BVH, its lights in a table. No device yet.

use std::time::Duration;

use glam::{DVec3, Vec2, Vec3};
use rayon::prelude::*;

use super::albedo::BsdfTables;
use super::attach::attach;
use super::emission::triangle_emission;
use super::environment::EnvironmentTable;
use super::error::RenderError;
use super::flatten::FlatGeometry;
use super::layout::{self, NONE};
use super::light_selection::LightSelection;
use super::lights::{LightList, Lights, position, punctual};
use super::materials::materials;
use super::media::media_around;
use super::sharing::Sharing;
use super::textures::TextureSet;
use super::vertex_format::VertexFormat;
use crate::accel::{BuildOptions, Bvh, Placed, TwoLevel};
use crate::host::Cache;
use crate::host::stages::{stage, timed_stage};
use crate::scene::{EnvironmentImage, Features, LightKind, Material, PunctualLight, Scene};

/// Most triangles that the BVH can count.
const MAX_TRIANGLES: u64 = crate::accel::MAX_TRIANGLES as u64;

/// Everything that the device will hold, in its own order and layout.
#[derive(Debug)]
pub struct Prepared {
    /// What the scene requires of the shader.
    pub features: Features,
    /// The camera's position: the origin of all that follows, metres, world.
    pub origin: DVec3,
    /// The acceleration structure.
    pub bvh: Bvh,
    /// Wall time of its build, the stage `bvh`.
    pub bvh_time: Duration,
    /// Which instances share geometry.
    pub sharing: Sharing,
    /// Vertex indices of each triangle.
    pub indices: Vec<[u32; 3]>,
    /// Vertex attributes.
    pub vertex_words: Vec<f32>,
    /// Where they are in a vertex.
    pub vertex_format: VertexFormat,
    /// Materials.
    pub materials: Vec<layout::Material>,
    /// Albedos of lobes, and wavelengths.
    pub bsdf_tables: BsdfTables,
    /// The solids around the camera: indices of materials + 1, or 0.
    pub media: [u32; 4],
    /// Textures.
    pub textures: TextureSet,
    /// All lights, and how one is chosen.
    pub lights: Lights,
    /// Punctual lights.
    pub punctual: Vec<layout::PunctualLight>,
    /// The environment's picture, if it has one.
    pub environment: EnvironmentTable,
    /// Its index in the light table, or [`NONE`].
    pub environment_light: u32,
    /// Sentences about what was left out.
    pub warnings: Vec<String>,
}

impl Prepared {
    /// Whether it has light from all around.
    pub fn has_environment(&self) -> bool {
        self.environment_light != layout::NONE
    }

    /// Flattens a validated scene around one of its cameras and builds its BVH. Lights are chosen as suits
    /// their number.
    ///
    /// # Errors
    /// [`RenderError::TooMany`].
    pub fn new(scene: &Scene, camera: usize, options: &BuildOptions) -> Result<Self, RenderError> {
        Self::with_lights(scene, camera, options, None)
    }

    /// The same, lights chosen as is wished. A tree of lights that are nowhere cannot be: then they are
    /// chosen by power, and a warning says so.
    ///
    /// # Errors
    /// [`RenderError::TooMany`].
    pub fn with_lights(
        scene: &Scene,
        camera: usize,
        options: &BuildOptions,
        wish: Option<LightSelection>,
    ) -> Result<Self, RenderError> {
        let features = Features::of(scene);
        let vertex_format = VertexFormat::of(&features);
        let origin = scene.cameras[camera].to_world.w_axis.truncate();
        let sharing = Sharing::new(scene, vertex_format.stride, origin, options.instancing);
        check_counts(scene, &sharing)?;
        let flatten = || FlatGeometry::new(scene, &vertex_format, origin, &sharing);
        let mut flat = stage("flatten", flatten);
        let options = options_for(&flat.triangles[..flat.world], options);
        let input = TwoLevel {
            triangles: &flat.triangles,
            world: flat.world,
            trees: &flat.trees,
            placements: &sharing.placements,
            // The camera's position is the origin. An orthographic ray that meets something starts no farther from it
            // than what it meets is: where it starts it is the nearest to the camera. A lens adds its radius.
            reach: scene.cameras[camera]
                .lens
                .map_or(0.0, |lens| lens.radius as f32),
        };
        let build = || Bvh::build_two_level(&input, &options);
        let (built, bvh_time) = timed_stage("bvh", build);
        let mut bvh = built.map_err(|error| RenderError::TooMany {
            what: "nodes and triangles in instances that share geometry, each counted where it is placed",
            count: error.count,
            limit: error.limit,
        })?;
        flat.reorder(&bvh.order);
        let mut textures = TextureSet::default();
        let bsdf_tables = stage("albedos", || {
            BsdfTables::new(scene, &features, &Cache::from_env())
        });
        let materials = materials(scene, &bsdf_tables, &mut textures);
        let environment = environment_table(scene, &features);
        let mut lights = LightList::default();
        let triangle_lights =
            add_triangle_lights(&mut lights, scene, &flat, &vertex_format, &bvh.order);
        attach(&mut bvh, &flat, &triangle_lights);
        let (near, lost) = punctual_lights(scene, origin);
        let boxes = bvh.instances.iter().map(|i| i.bounds);
        // In a scene without extent any radius will do.
        let radius = flat.radius(boxes).max(f64::MIN_POSITIVE);
        let environment_light =
            add_other_lights(&mut lights, scene, &near, origin, radius, &environment);
        let lights = lights.finish(wish);
        let mut warnings = warnings(flat.dropped, lost);
        warnings.extend(unmet_wish(wish, &lights));
        Ok(Self {
            features,
            origin,
            bvh,
            bvh_time,
            warnings,
            sharing,
            indices: flat.indices,
            vertex_words: flat.words,
            vertex_format,
            materials,
            bsdf_tables,
            media: media_around(scene, origin),
            textures,
            lights,
            punctual: near.iter().map(|l| punctual(l, origin)).collect(),
            environment,
            environment_light,
        })
    }
}

/// A list puts hits in order by distances that are found quickly, good to about 2^-22 of a triangle's
/// size over its aspect ratio and the sine of the angle at which it is seen: slivers need the tree.
fn options_for(triangles: &[[Vec3; 3]], options: &BuildOptions) -> BuildOptions {
    let may_be_list = triangles.len() <= 2 * options.list_limit;
    let list_limit = if may_be_list && triangles.iter().any(is_sliver) {
        0
    } else {
        options.list_limit
    };
    BuildOptions {
        list_limit,
        ..*options
    }
}

/// Whether a triangle is more than about a hundred times as long as it is wide.
fn is_sliver(triangle: &[Vec3; 3]) -> bool {
    let [a, b, c] = triangle.map(|v| v.as_dvec3());
    let longest = [b - a, c - b, a - c].map(|e| e.length_squared());
    let longest = longest.into_iter().fold(0.0, f64::max);
    (b - a).cross(c - a).length() <= 0.01 * longest
}

/// Texels along a side: the shaders find them by f32 coordinates, which tell quarters of them apart
/// up to here, and count two sides of a mirrored texture in 24 bits.
const MAX_SIDE: u64 = 1 << 22;

fn check_counts(scene: &Scene, sharing: &Sharing) -> Result<(), RenderError> {
    let check = |what, count: u64, limit: u64| {
        if count > limit {
            return Err(RenderError::TooMany { what, count, limit });
        }
        Ok(())
    };
    let (triangles, vertices) = sharing.counts(scene);
    let placed = sharing.placements.len() as u64;
    let what = match placed {
        0 => "triangles",
        _ => "triangles in memory and instances, of which each counts twice",
    };
    check(what, triangles + 2 * placed, MAX_TRIANGLES)?;
    let materials = scene.materials.len() as u64;
    let limit = u64::from(layout::MATERIAL_INDEX_MASK) + 1;
    check("materials", materials, limit)?;
    // A vertex has at most 16 words, counted in 32 bits.
    check("vertices", vertices, u64::from(u32::MAX) / 16)?;
    let sides = scene.images.iter().flat_map(|i| [i.width, i.height]);
    let side = sides.max().unwrap_or(0).into();
    check("texels along a side of an image", side, MAX_SIDE)?;
    let texels = scene
        .images
        .iter()
        .map(|i| u64::from(i.width) * u64::from(i.height))
        .sum();
    let sky = scene.environment.as_ref().and_then(|e| e.image.as_ref());
    let sky_texels = sky.map_or(0, |image| image.texels.len() as u64);
    check("texels of the environment", sky_texels, 1 << 30)?;
    let side = sky.map_or(0, |image| image.width.max(image.height) as u64);
    check("texels along a side of the environment", side, MAX_SIDE)?;
    // An image is held at most twice, in at most two words a texel.
    check("texels", texels, u64::from(u32::MAX) / 4)
}

fn environment_table(scene: &Scene, features: &Features) -> EnvironmentTable {
    let image = scene.environment.as_ref().and_then(|e| e.image.as_ref());
    match image {
        Some(image) => EnvironmentTable::new(image),
        // Something to look up for a kernel that was asked to.
        None if features.is_asked_for("environment_image") => {
            EnvironmentTable::new(&EnvironmentImage {
                width: 1,
                height: 1,
                texels: vec![[1.0; 3]],
            })
        }
        None => EnvironmentTable::default(),
    }
}

/// Enters every emissive triangle; gives each triangle's index in the table, or [`NONE`].
fn add_triangle_lights(
    lights: &mut LightList,
    scene: &Scene,
    flat: &FlatGeometry,
    format: &VertexFormat,
    order: &[Placed],
) -> Vec<u32> {
    let emits = |m: &Material| !m.unlit && m.emissive.max_element() > 0.0;
    let emits: Vec<bool> = scene.materials.iter().map(emits).collect();
    let mut table: Vec<u32> = rayon::iter::repeat_n(NONE, flat.triangles.len()).collect();
    // Found in parallel, since most triangles of most scenes are none; entered in order.
    let all = (0..flat.triangles.len()).into_par_iter();
    let found: Vec<usize> = all.filter(|&i| emits[flat.material(i)]).collect();
    for i in found {
        let material = &scene.materials[flat.material(i)];
        let corners = |set| flat.indices[i].map(|v| tex_coord(flat, format, v, set));
        let emission = triangle_emission(scene, material, &flat.triangles[i], corners);
        if emission.is_light() {
            table[i] = lights.add_triangle(order[i].id, &flat.triangles[i], &emission);
        }
    }
    table
}

fn tex_coord(flat: &FlatGeometry, format: &VertexFormat, vertex: u32, set: u32) -> Vec2 {
    let offset = if set == 1 { format.uv1 } else { format.uv0 };
    offset.map_or(Vec2::ZERO, |offset| {
        let first = (vertex * format.stride + offset) as usize;
        Vec2::new(flat.words[first], flat.words[first + 1])
    })
}

/// The punctual lights that shine, and the number of those too far away for f32.
fn punctual_lights(scene: &Scene, origin: DVec3) -> (Vec<&PunctualLight>, u64) {
    let reachable = |light: &PunctualLight| {
        light.kind == LightKind::Directional || position(light, origin).is_finite()
    };
    let shining = scene
        .lights
        .iter()
        .filter(|light| light.intensity.max_element() > 0.0);
    let (near, far): (Vec<_>, Vec<_>) = shining.partition(|light| reachable(light));
    (near, far.len() as u64)
}

/// Enters punctual lights and the environment; gives the index of the latter, or [`NONE`].
fn add_other_lights(
    lights: &mut LightList,
    scene: &Scene,
    punctual: &[&PunctualLight],
    origin: DVec3,
    radius: f64,
    table: &EnvironmentTable,
) -> u32 {
    // Those that are somewhere come first.
    for directional in [false, true] {
        for (i, light) in punctual.iter().enumerate() {
            if (light.kind == LightKind::Directional) == directional {
                lights.add_punctual(i as u32, light, position(light, origin), radius);
            }
        }
    }
    let Some(environment) = &scene.environment else {
        return NONE;
    };
    let factor = DVec3::from(environment.radiance.map(f64::from));
    let mean = if environment.image.is_some() {
        factor * table.mean
    } else {
        factor
    };
    if mean.max_element() <= 0.0 {
        return NONE;
    }
    lights.add_environment(mean, radius)
}

/// Why lights are chosen otherwise than was wished.
fn unmet_wish(wish: Option<LightSelection>, lights: &Lights) -> Option<String> {
    let unmet = wish == Some(LightSelection::Tree) && lights.tree.is_none();
    unmet.then(|| {
        "the scene has no emissive triangle, point or spot light for a tree of lights: a light is chosen by \
         power"
            .into()
    })
}

fn warnings(dropped: u64, lost_lights: u64) -> Vec<String> {
    let mut list = Vec::new();
    if dropped > 0 {
        list.push(format!(
            "{dropped} triangles have a vertex that is not a finite number and were left out"
        ));
    }
    if lost_lights > 0 {
        list.push(format!(
            "{lost_lights} punctual lights are farther away than numbers reach and were left out"
        ));
    }
    list
}
