//! What the trees are built over.

use crate::common::Random;
use etendue::accel::Primitive;
use etendue::accel::pair::{Pair, pairs};
use etendue::geometry::Aabb;
use etendue::scene::gltf;
use glam::Vec3;
use std::f32::consts::{PI, TAU};
use std::path::Path;

pub type Triangle = [Vec3; 3];

const MODEL: &str = "FlightHelmet";

/// Bumpy spheres in a box with so many triangles, triangles of all sizes at random places, a model.
const NAMES: [&str; 5] = [
    "spheres 10k",
    "spheres 100k",
    "spheres 1M",
    "soup 200k",
    MODEL,
];

/// Those that are there: the model needs `ETENDUE_SHARED`.
pub fn names() -> Vec<&'static str> {
    let is_there = |name: &&str| *name != MODEL || model(name).is_some();
    NAMES.into_iter().filter(is_there).collect()
}

pub struct Mesh {
    pub name: String,
    pub triangles: Vec<Triangle>,
    pub pairs: Vec<Pair>,
    /// One a pair, in their order.
    pub boxes: Vec<Primitive>,
}

/// None for a model that is not there.
pub fn mesh(name: &str) -> Option<Mesh> {
    let triangles = match name {
        "spheres 10k" => spheres(10_000),
        "spheres 100k" => spheres(100_000),
        "spheres 1M" => spheres(1_000_000),
        "soup 200k" => soup(200_000),
        _ => model(name)?,
    };
    let pairs = pairs(&triangles);
    let primitive = |(i, pair): (usize, &Pair)| Primitive {
        bounds: Aabb::from_points(&pair.vertices(&triangles)),
        index: i as u32,
    };
    let boxes = pairs.iter().enumerate().map(primitive).collect();
    let name = name.into();
    Some(Mesh {
        name,
        triangles,
        pairs,
        boxes,
    })
}

fn soup(n: usize) -> Vec<Triangle> {
    let mut random = Random(2);
    let mut triangle = || {
        let center = random.point();
        let size = 0.05 * random.unit().powi(3) + 0.001;
        [(); 3].map(|()| center + random.point() * size)
    };
    (0..n).map(|_| triangle()).collect()
}

/// Nine of them, with bumps of two sizes.
fn spheres(total: usize) -> Vec<Triangle> {
    const COUNT: usize = 9;
    let n = (total as f32 / (4 * COUNT) as f32).sqrt().round() as usize;
    let mut random = Random(1);
    let mut triangles = walls();
    for _ in 0..COUNT {
        let (center, phase) = (random.point() * 0.7, random.unit() * TAU);
        let radius = 0.1 + 0.2 * random.unit();
        let vertex = |i: usize, j: usize| {
            let theta = PI * i as f32 / n as f32;
            let phi = TAU * (j % (2 * n)) as f32 / (2 * n) as f32;
            let (sin, cos) = theta.sin_cos();
            let d = Vec3::new(sin * phi.cos(), cos, sin * phi.sin());
            let large = (9.0 * d.x + phase).sin() * (11.0 * d.y).sin() * (7.0 * d.z).cos();
            let small = (60.0 * d.x).sin() * (70.0 * d.y + phase).sin() * (50.0 * d.z).sin();
            center + d * radius * (1.0 + 0.1 * large + 0.02 * small)
        };
        for (i, j) in (0..n).flat_map(|i| (0..2 * n).map(move |j| (i, j))) {
            let [a, b] = [vertex(i, j), vertex(i + 1, j)];
            let [c, d] = [vertex(i + 1, j + 1), vertex(i, j + 1)];
            triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    triangles
}

/// The cube [-1, 1]³.
fn walls() -> Vec<Triangle> {
    let wall = |axis: usize, side: f32| {
        let corner = |u: f32, v: f32| {
            let mut p = [side; 3];
            (p[(axis + 1) % 3], p[(axis + 2) % 3]) = (u, v);
            Vec3::from_array(p)
        };
        let [a, b] = [corner(-1.0, -1.0), corner(1.0, -1.0)];
        let [c, d] = [corner(1.0, 1.0), corner(-1.0, 1.0)];
        [[a, b, c], [a, c, d]]
    };
    (0..3)
        .flat_map(|axis| [wall(axis, -1.0), wall(axis, 1.0)].concat())
        .collect()
}

fn model(name: &str) -> Option<Vec<Triangle>> {
    let folder = std::env::var_os("ETENDUE_SHARED")?;
    let path = Path::new(&folder).join(format!("assets/models/{name}/{name}.gltf"));
    let options = gltf::LoadOptions::default();
    let scene = match gltf::load(&path, &options) {
        Ok(scene) => scene,
        Err(error) => {
            eprintln!("{error}");
            return None;
        }
    };
    let mut triangles = Vec::new();
    for instance in &scene.instances {
        let mesh = &scene.meshes[instance.mesh];
        let place = |i: u32| {
            let position = mesh.positions[i as usize].as_dvec3();
            instance.to_world.transform_point3(position).as_vec3()
        };
        triangles.extend(mesh.indices.iter().map(|t| t.map(place)));
    }
    Some(triangles)
}
