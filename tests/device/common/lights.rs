//! Light sampling in a scene by itself.

use std::sync::Arc;

use etendue::render::LightSelection;
use etendue::scene::{Environment, EnvironmentImage, Scene};
use glam::Vec3;

use super::scenes::{Stage, empty_scene};
use super::{SAMPLES, Setup};

/// Light sampling in a scene, from a point with a normal.
pub struct Bench {
    pub stage: Stage,
    pub setup: Setup,
    point: [f32; 4],
    normal: [f32; 4],
}

/// Direction and pdf, weight and whether at infinity, position and whether delta.
pub type Drawn = [[f32; 4]; 3];

impl Bench {
    pub fn new(scene: &Scene, point: Vec3, normal: Vec3) -> Self {
        Self::with_lights(scene, point, normal, None)
    }

    pub fn with_lights(
        scene: &Scene,
        point: Vec3,
        normal: Vec3,
        wish: Option<LightSelection>,
    ) -> Self {
        let stage = Stage::with_lights(scene, wish);
        Self {
            setup: Setup::new()
                .with(stage.constants())
                .structure(&stage.prepared.bvh),
            stage,
            point: point.extend(0.0).to_array(),
            normal: normal.normalize().extend(0.0).to_array(),
        }
    }

    /// Light from both sides counts.
    pub fn both_sides(mut self) -> Self {
        self.point[3] = 1.0;
        self
    }

    pub fn draw(&self, entry: &str, seed: u32) -> Vec<Drawn> {
        let kernel = self.setup.kernel("lights", entry);
        let inputs = [self.point, self.normal];
        let n = SAMPLES as usize;
        kernel.run(SAMPLES, [seed, 0, 0], &inputs, n, &self.stage.buffers())
    }

    pub fn evaluate(&self, entry: &str, directions: &[[f32; 4]]) -> Vec<[f32; 4]> {
        let kernel = self.setup.kernel("lights", entry);
        let mut inputs = vec![self.point, self.normal];
        inputs.extend(directions);
        let n = directions.len();
        kernel.run(n as u32, [0; 3], &inputs, n, &self.stage.buffers())
    }

    /// One estimate for each pixel, of `samples` samples.
    pub fn estimate(&self, entry: &str, pixels: usize, samples: u32) -> Vec<[f32; 4]> {
        let kernel = self.setup.kernel("lights", entry);
        let inputs = [self.point, self.normal];
        let params = [1, samples, 0];
        kernel.run(
            pixels as u32,
            params,
            &inputs,
            pixels,
            &self.stage.buffers(),
        )
    }
}

pub fn xyz(v: &[f32; 4]) -> [f32; 3] {
    [v[0], v[1], v[2]]
}

/// A scene of nothing but an environment.
pub fn environment(image: Option<EnvironmentImage>) -> Scene {
    Scene {
        environment: Some(Environment {
            radiance: [1.0, 2.0, 0.5],
            rotation: 0.9,
            image: image.map(Arc::new),
        }),
        ..empty_scene()
    }
}
