//! What `etendue info` says about a scene.

use serde::Serialize;

use super::{FeatureReason, Features, Filter, LightKind, Material, Projection, Scene, Wrap};

/// A scene in numbers and names.
#[derive(Debug, Clone, Serialize)]
pub struct Summary {
    /// The file.
    pub source: String,
    /// BLAKE3 over all bytes read, hexadecimal.
    pub hash: String,
    /// Names of the scenes in the file.
    pub scenes: Vec<String>,
    /// Which of them this is.
    pub scene_index: usize,
    /// Names of the animations in the file.
    pub animations: Vec<String>,
    /// Which of them poses the nodes, if any.
    pub animation_index: Option<usize>,
    /// Its moment, seconds.
    pub animation_seconds: Option<f64>,
    /// Cameras to choose from.
    pub cameras: Vec<CameraSummary>,
    /// Punctual lights.
    pub lights: Vec<LightSummary>,
    /// Materials; those that no triangle uses are marked.
    pub materials: Vec<MaterialSummary>,
    /// Textures with their images.
    pub textures: Vec<TextureSummary>,
    /// Meshes, one a glTF primitive.
    pub meshes: usize,
    /// Placements of meshes.
    pub instances: usize,
    /// Triangles of all meshes, each mesh once.
    pub unique_triangles: u64,
    /// Triangles of all instances.
    pub triangles: u64,
    /// Vertices of all meshes, each mesh once.
    pub unique_vertices: u64,
    /// Corners of the box around everything, metres; none if there is nothing.
    pub bounds: Option<[[f64; 3]; 2]>,
    /// Names of the variants of its materials.
    pub variants: Vec<String>,
    /// Extensions that the file names.
    pub extensions: Vec<ExtensionSummary>,
    /// What the shader is compiled with, and why.
    pub features: Vec<FeatureReason>,
    /// What was skipped or assumed.
    pub warnings: Vec<String>,
    /// Choices that need no action.
    pub notes: Vec<String>,
}

/// A camera.
#[derive(Debug, Clone, Serialize)]
pub struct CameraSummary {
    /// Its name, possibly empty.
    pub name: String,
    /// "perspective", "orthographic" or "panorama".
    pub kind: &'static str,
    /// Vertical field of view, degrees (perspective).
    pub yfov_degrees: Option<f64>,
    /// Width over height that the file asks for.
    pub aspect: Option<f64>,
    /// Where it is, metres.
    pub position: [f64; 3],
}

/// A punctual light.
#[derive(Debug, Clone, Serialize)]
pub struct LightSummary {
    /// Its name, possibly empty.
    pub name: String,
    /// "point", "spot" or "directional".
    pub kind: &'static str,
    /// W·sr⁻¹, or W·m⁻² for directional lights.
    pub intensity: [f32; 3],
}

/// A material.
#[derive(Debug, Clone, Serialize)]
pub struct MaterialSummary {
    /// Its name, possibly empty.
    pub name: String,
    /// Whether some triangle has it.
    pub used: bool,
    /// The slots that are textured.
    pub textures: Vec<&'static str>,
}

/// A texture.
#[derive(Debug, Clone, Serialize)]
pub struct TextureSummary {
    /// Name or URI of its image.
    pub image: String,
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Bits a channel.
    pub bits: u32,
    /// Along u and v: "clamp", "mirror" or "repeat".
    pub wrap: [&'static str; 2],
    /// "nearest" or "linear".
    pub filter: &'static str,
}

/// An extension that the file names.
#[derive(Debug, Clone, Serialize)]
pub struct ExtensionSummary {
    /// Its name.
    pub name: String,
    /// Whether the file requires it.
    pub required: bool,
    /// Whether étendue renders what it says.
    pub supported: bool,
}

impl Summary {
    /// The summary of `scene`, with the features that it requires.
    pub fn of(scene: &Scene) -> Self {
        let meshes = scene.meshes.iter();
        Self {
            source: scene.source.display().to_string(),
            hash: scene
                .hash
                .iter()
                .map(|byte| format!("{byte:02x}"))
                .collect(),
            scenes: scene.scene_names.clone(),
            scene_index: scene.scene_index,
            animations: scene.animation_names.clone(),
            animation_index: scene.animation.map(|animation| animation.index),
            animation_seconds: scene.animation.map(|animation| animation.seconds),
            cameras: scene.cameras.iter().map(camera).collect(),
            lights: scene.lights.iter().map(light).collect(),
            materials: materials(scene),
            textures: textures(scene),
            meshes: scene.meshes.len(),
            instances: scene.instances.len(),
            unique_triangles: meshes.clone().map(|mesh| mesh.indices.len() as u64).sum(),
            triangles: scene.triangle_count(),
            unique_vertices: meshes.map(|mesh| mesh.positions.len() as u64).sum(),
            bounds: scene
                .bounds()
                .map(|(low, high)| [low.to_array(), high.to_array()]),
            variants: scene.variant_names.clone(),
            extensions: scene.extensions.iter().map(extension).collect(),
            features: Features::of(scene).reasons,
            warnings: scene.warnings.clone(),
            notes: scene.notes.clone(),
        }
    }
}

fn camera(camera: &super::Camera) -> CameraSummary {
    let (kind, yfov, aspect) = match camera.projection {
        Projection::Perspective { yfov, aspect } => {
            ("perspective", Some(yfov.to_degrees()), aspect)
        }
        Projection::Orthographic { xmag, ymag } => {
            ("orthographic", None, Some((xmag / ymag).abs()))
        }
        Projection::Panorama => ("panorama", None, Some(2.0)),
    };
    CameraSummary {
        name: camera.name.clone(),
        kind,
        yfov_degrees: yfov,
        aspect,
        position: camera.to_world.w_axis.truncate().to_array(),
    }
}

fn light(light: &super::PunctualLight) -> LightSummary {
    LightSummary {
        name: light.name.clone(),
        kind: match light.kind {
            LightKind::Point => "point",
            LightKind::Spot { .. } => "spot",
            LightKind::Directional => "directional",
        },
        intensity: light.intensity.to_array(),
    }
}

fn materials(scene: &Scene) -> Vec<MaterialSummary> {
    let mut used = vec![false; scene.materials.len()];
    for instance in &scene.instances {
        used[scene.meshes[instance.mesh].material] = true;
    }
    let materials = scene.materials.iter().zip(used);
    materials
        .map(|(material, used)| MaterialSummary {
            name: material.name.clone(),
            used,
            textures: texture_names(material),
        })
        .collect()
}

fn texture_names(material: &Material) -> Vec<&'static str> {
    let slots = material.named_slots();
    let filled = slots.into_iter().filter(|(_, slot)| slot.is_some());
    filled.map(|(name, _)| name).collect()
}

fn textures(scene: &Scene) -> Vec<TextureSummary> {
    let wrap = |wrap: Wrap| match wrap {
        Wrap::ClampToEdge => "clamp",
        Wrap::MirroredRepeat => "mirror",
        Wrap::Repeat => "repeat",
    };
    let summary = |texture: &super::Texture| {
        let image = &scene.images[texture.image];
        TextureSummary {
            image: image.name.clone(),
            width: image.width,
            height: image.height,
            bits: image.texels.bits(),
            wrap: [wrap(texture.sampler.wrap_u), wrap(texture.sampler.wrap_v)],
            filter: match texture.sampler.filter {
                Filter::Nearest => "nearest",
                Filter::Linear => "linear",
            },
        }
    };
    scene.textures.iter().map(summary).collect()
}

fn extension(extension: &super::ExtensionUse) -> ExtensionSummary {
    ExtensionSummary {
        name: extension.name.clone(),
        required: extension.required,
        supported: extension.supported,
    }
}
