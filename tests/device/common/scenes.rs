//! Scenes made by hand, and their buffers.

use etendue::accel::BuildOptions;
use etendue::gpu::{Buffer, Loads};
use etendue::render::layout::Frame;
use etendue::render::program::Constant;
use etendue::render::{GpuScene, LightSelection, Prepared, Settings, program};
use etendue::scene::{Camera, Instance, Material, Mesh, Projection, Scene};
use glam::{DMat4, Vec3, Vec4};

use super::{FRAME, device, upload};

/// A scene on the device with a frame of its own.
pub struct Stage {
    pub prepared: Prepared,
    gpu_scene: GpuScene,
    frame: Buffer,
}

impl Stage {
    pub fn new(scene: &Scene) -> Self {
        Self::with_lights(scene, None)
    }

    pub fn with_lights(scene: &Scene, wish: Option<LightSelection>) -> Self {
        scene.validate().expect("a valid scene");
        let prepared = Prepared::with_lights(scene, 0, &BuildOptions::default(), wish);
        let prepared = prepared.expect("prepared");
        let gpu_scene = GpuScene::upload(device(), &prepared).expect("uploaded");
        let frame = upload("frame", &[frame(scene, &prepared)]);
        Self {
            prepared,
            gpu_scene,
            frame,
        }
    }

    /// The constants that a render of the scene would have.
    pub fn constants(&self) -> Vec<(&'static str, Constant)> {
        let workgroup_bytes = device().info().max_shared_memory;
        program::constants(&self.prepared, &Settings::default(), false, workgroup_bytes)
    }

    /// Every buffer of the scene.
    pub fn buffers(&self) -> Vec<(u32, &Buffer)> {
        let bindings = self.gpu_scene.bindings(Loads::default());
        let mut buffers: Vec<_> = bindings.into_iter().map(|(n, b, _)| (n, b)).collect();
        buffers.push((FRAME, &self.frame));
        buffers
    }
}

/// The part of the frame that light sampling reads.
fn frame(scene: &Scene, prepared: &Prepared) -> Frame {
    let environment = scene.environment.as_ref();
    let image = environment.and_then(|e| e.image.as_ref());
    let rotation = environment.map_or(0.0, |e| e.rotation);
    Frame {
        light_count: prepared.lights.table.len() as u32,
        punctual_count: prepared.punctual.len() as u32,
        environment_light: prepared.environment_light,
        environment_width: image.map_or(0, |i| i.width as u32),
        environment_height: image.map_or(0, |i| i.height as u32),
        environment_radiance: environment.map_or([0.0; 3], |e| e.radiance),
        environment_cos: rotation.cos() as f32,
        environment_sin: rotation.sin() as f32,
        ..Frame::default()
    }
}

/// A scene with a camera at the origin and nothing else.
pub fn empty_scene() -> Scene {
    Scene {
        cameras: vec![Camera {
            name: String::new(),
            to_world: DMat4::IDENTITY,
            projection: Projection::Perspective {
                yfov: 1.0,
                aspect: None,
            },
            lens: None,
        }],
        ..Scene::default()
    }
}

/// Adds triangles of a material of their own.
pub fn add_mesh(scene: &mut Scene, triangles: &[[Vec3; 3]], material: Material) {
    scene.materials.push(material);
    scene.meshes.push(Mesh {
        positions: triangles.iter().flatten().copied().collect(),
        indices: (0..triangles.len() as u32)
            .map(|i| [3 * i, 3 * i + 1, 3 * i + 2])
            .collect(),
        material: scene.materials.len() - 1,
        ..Mesh::default()
    });
    scene.instances.push(Instance {
        mesh: scene.meshes.len() - 1,
        to_world: DMat4::IDENTITY,
        name: String::new(),
    });
}

/// A black material that emits.
pub fn emitter(radiance: f32) -> Material {
    Material {
        base_color: Vec4::new(0.0, 0.0, 0.0, 1.0),
        metallic: 0.0,
        emissive: Vec3::splat(radiance),
        ..Material::default()
    }
}
