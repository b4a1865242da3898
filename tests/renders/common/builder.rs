//! A scene, piece by piece.

use std::f64::consts::{FRAC_PI_2, PI};
use std::sync::Arc;

use etendue::scene::{
    Camera, Environment, EnvironmentImage, Instance, LightKind, Material, Mesh, Projection,
    PunctualLight, Scene,
};
use glam::{DMat4, DVec3, Vec3, Vec4};

/// A scene in the making. Shapes are added in world coordinates; their fronts are where the
/// corners turn left.
#[derive(Debug, Clone, Default)]
pub struct SceneBuilder {
    pub scene: Scene,
}

/// Lambertian, without a specular layer.
pub fn lambert(reflectance: f32) -> Material {
    Material {
        base_color: Vec4::new(reflectance, reflectance, reflectance, 1.0),
        metallic: 0.0,
        specular: 0.0,
        ..Material::default()
    }
}

/// Reflects nothing.
pub fn black() -> Material {
    lambert(0.0)
}

/// Emits `radiance` to its front and reflects nothing.
pub fn lamp(radiance: f32) -> Material {
    Material {
        emissive: Vec3::splat(radiance),
        ..black()
    }
}

/// A metal: a specular layer with F0 = `reflectance` alone.
pub fn metal(reflectance: f32, roughness: f32) -> Material {
    Material {
        base_color: Vec4::new(reflectance, reflectance, reflectance, 1.0),
        metallic: 1.0,
        roughness,
        ..Material::default()
    }
}

/// A dielectric layer over a black base.
pub fn glossy(ior: f32, roughness: f32) -> Material {
    Material {
        roughness,
        specular: 1.0,
        ior,
        ..black()
    }
}

impl SceneBuilder {
    /// A scene that holds nothing.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a mesh of its own for a material.
    pub fn mesh(&mut self, material: Material, positions: &[DVec3], indices: Vec<[u32; 3]>) {
        self.add(material, positions, indices, Vec::new());
    }

    fn add(
        &mut self,
        material: Material,
        positions: &[DVec3],
        indices: Vec<[u32; 3]>,
        colors: Vec<Vec4>,
    ) {
        let scene = &mut self.scene;
        scene.materials.push(material);
        scene.meshes.push(Mesh {
            positions: positions.iter().map(|p| p.as_vec3()).collect(),
            indices,
            colors,
            material: scene.materials.len() - 1,
            ..Mesh::default()
        });
        scene.instances.push(Instance {
            mesh: scene.meshes.len() - 1,
            to_world: DMat4::IDENTITY,
            name: String::new(),
        });
    }

    /// Adds a convex polygon.
    pub fn polygon(&mut self, material: Material, corners: &[DVec3]) {
        let fan = (1..corners.len() as u32 - 1).map(|i| [0, i, i + 1]);
        self.add(material, corners, fan.collect(), Vec::new());
    }

    /// Adds a parallelogram around `center`; it faces `u` × `v`.
    pub fn quad(&mut self, material: Material, center: DVec3, u: DVec3, v: DVec3) {
        self.polygon(material, &quad_corners(center, u, v));
    }

    /// The same with a colour at each corner (−u−v, +u−v, +u+v, −u+v).
    pub fn colored_quad(
        &mut self,
        material: Material,
        center: DVec3,
        u: DVec3,
        v: DVec3,
        colors: [Vec4; 4],
    ) {
        let corners = quad_corners(center, u, v);
        let indices = vec![[0, 1, 2], [0, 2, 3]];
        self.add(material, &corners, indices, colors.to_vec());
    }

    /// Adds a receiver in the plane y = 0 that faces up.
    pub fn ground(&mut self, material: Material, half_side: f64) {
        let (u, v) = (DVec3::Z * half_side, DVec3::X * half_side);
        self.quad(material, DVec3::ZERO, u, v);
    }

    /// Adds a box around `center` whose front faces are inside; the faces share their vertices.
    pub fn room(&mut self, material: Material, center: DVec3, half: DVec3) {
        let corner = |i: u32| {
            let sign = |bit: u32| if i >> bit & 1 == 1 { 1.0 } else { -1.0 };
            center + half * DVec3::new(sign(0), sign(1), sign(2))
        };
        let corners: Vec<DVec3> = (0..8).map(corner).collect();
        let faces = [
            [0, 1, 3, 2],
            [5, 4, 6, 7],
            [4, 0, 2, 6],
            [1, 5, 7, 3],
            [0, 4, 5, 1],
            [2, 3, 7, 6],
        ];
        let triangles = faces
            .iter()
            .flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]])
            .collect();
        self.mesh(material, &corners, triangles);
    }

    /// Adds a regular polygon of `segments` sides inscribed in a disc.
    pub fn disc(&mut self, material: Material, disc: &Disc) {
        self.polygon(material, &disc.corners());
    }

    /// Adds an icosphere inscribed in a sphere, with flat faces; fronts outside, or inside.
    pub fn sphere(&mut self, material: Material, sphere: &Icosphere, inward: bool) {
        let turn = |[a, b, c]: [u32; 3]| if inward { [a, c, b] } else { [a, b, c] };
        let indices = sphere.faces.iter().copied().map(turn).collect();
        self.mesh(material, &sphere.vertices, indices);
    }

    /// Adds a light that shines alike in all directions.
    pub fn point(&mut self, position: DVec3, intensity: f32) {
        self.light(position, DVec3::NEG_Y, intensity, LightKind::Point);
    }

    /// Adds a punctual light.
    pub fn light(&mut self, position: DVec3, direction: DVec3, intensity: f32, kind: LightKind) {
        self.scene.lights.push(PunctualLight {
            name: String::new(),
            position,
            direction: direction.normalize(),
            intensity: Vec3::splat(intensity),
            range: f64::INFINITY,
            kind,
        });
    }

    /// Sets an environment of constant radiance.
    pub fn sky(&mut self, radiance: f32) {
        self.scene.environment = Some(Environment {
            radiance: [radiance; 3],
            rotation: 0.0,
            image: None,
        });
    }

    /// Sets an equirectangular environment.
    pub fn sky_image(&mut self, image: EnvironmentImage, rotation: f64) {
        self.scene.environment = Some(Environment {
            radiance: [1.0; 3],
            rotation,
            image: Some(Arc::new(image)),
        });
    }

    /// Adds a pinhole at `eye` that looks at `target`.
    pub fn pinhole(&mut self, eye: DVec3, target: DVec3, yfov: f64) {
        let projection = Projection::Perspective { yfov, aspect: None };
        self.camera(eye, target, projection);
    }

    /// Adds a camera of parallel rays whose square view has half the side `half`.
    pub fn parallel(&mut self, eye: DVec3, target: DVec3, half: f64) {
        let (xmag, ymag) = (half, half);
        self.camera(eye, target, Projection::Orthographic { xmag, ymag });
    }

    fn camera(&mut self, eye: DVec3, target: DVec3, projection: Projection) {
        let z = (eye - target).normalize();
        let up = if z.y.abs() > 0.999 {
            DVec3::NEG_Z
        } else {
            DVec3::Y
        };
        let x = up.cross(z).normalize();
        let columns = [x, z.cross(x), z].map(|axis| axis.extend(0.0));
        self.scene.cameras.push(Camera {
            name: String::new(),
            to_world: DMat4::from_cols(columns[0], columns[1], columns[2], eye.extend(1.0)),
            projection,
            lens: None,
        });
    }
}

fn quad_corners(center: DVec3, u: DVec3, v: DVec3) -> [DVec3; 4] {
    [
        center - u - v,
        center + u - v,
        center + u + v,
        center - u + v,
    ]
}

/// A disc, as a regular polygon.
#[derive(Debug, Clone, Copy)]
pub struct Disc {
    pub center: DVec3,
    /// Unit vector to its front, along ±Y.
    pub up: bool,
    pub radius: f64,
    pub segments: usize,
}

impl Disc {
    /// Its corners, rounded to f32 as the mesh holds them.
    pub fn corners(&self) -> Vec<DVec3> {
        let corner = |i| {
            let turn = if self.up { -1.0 } else { 1.0 };
            let (sin, cos) = (turn * 2.0 * PI * i as f64 / self.segments as f64).sin_cos();
            self.center + self.radius * DVec3::new(cos, 0.0, sin)
        };
        let round = |p: DVec3| p.as_vec3().as_dvec3();
        (0..self.segments).map(|i| round(corner(i))).collect()
    }

    /// Area of the polygon over that of the disc.
    pub fn area_ratio(&self) -> f64 {
        let angle = 2.0 * PI / self.segments as f64;
        angle.sin() / angle
    }
}

/// An icosahedron whose faces are divided in four again and again, its vertices on the sphere.
#[derive(Debug, Clone)]
pub struct Icosphere {
    pub vertices: Vec<DVec3>,
    pub faces: Vec<[u32; 3]>,
}

impl Icosphere {
    /// 20 · 4^`divisions` faces.
    pub fn new(center: DVec3, radius: f64, divisions: u32) -> Self {
        let golden = 0.5 * (1.0 + 5.0_f64.sqrt());
        let mut vertices = Vec::new();
        for (a, b) in [
            (1.0, golden),
            (-1.0, golden),
            (1.0, -golden),
            (-1.0, -golden),
        ] {
            vertices.push(DVec3::new(0.0, a, b).normalize());
            vertices.push(DVec3::new(a, b, 0.0).normalize());
            vertices.push(DVec3::new(b, 0.0, a).normalize());
        }
        let mut faces = hull_faces(&vertices);
        for _ in 0..divisions {
            faces = divide(&mut vertices, &faces);
        }
        let place = |v: &DVec3| (center + radius * *v).as_vec3().as_dvec3();
        Self {
            vertices: vertices.iter().map(place).collect(),
            faces,
        }
    }

    /// Corners of every face, counter-clockwise from outside.
    pub fn triangles(&self) -> impl Iterator<Item = [DVec3; 3]> {
        let corners = |face: &[u32; 3]| face.map(|i| self.vertices[i as usize]);
        self.faces.iter().map(corners)
    }

    /// Smallest distance of a face's plane from `center`.
    pub fn inradius(&self, center: DVec3) -> f64 {
        let distance = |[a, b, c]: [DVec3; 3]| {
            let normal = (b - a).cross(c - a).normalize();
            normal.dot(a - center).abs()
        };
        self.triangles().map(distance).fold(f64::INFINITY, f64::min)
    }
}

/// Every triple of mutual neighbours among an icosahedron's vertices, turned outward.
fn hull_faces(v: &[DVec3]) -> Vec<[u32; 3]> {
    let near = |i: usize, j: usize| v[i].angle_between(v[j]) < 0.8 * FRAC_PI_2;
    let mut faces = Vec::new();
    for i in 0..v.len() {
        for j in i + 1..v.len() {
            for k in j + 1..v.len() {
                if near(i, j) && near(j, k) && near(i, k) {
                    let outward = (v[j] - v[i]).cross(v[k] - v[i]).dot(v[i]) > 0.0;
                    let [a, b, c] = [i as u32, j as u32, k as u32];
                    faces.push(if outward { [a, b, c] } else { [a, c, b] });
                }
            }
        }
    }
    faces
}

fn divide(vertices: &mut Vec<DVec3>, faces: &[[u32; 3]]) -> Vec<[u32; 3]> {
    let mut middles = std::collections::HashMap::new();
    let mut middle = |a: u32, b: u32| {
        *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
            let sum = vertices[a as usize] + vertices[b as usize];
            vertices.push(sum.normalize());
            vertices.len() as u32 - 1
        })
    };
    let mut divided = Vec::with_capacity(4 * faces.len());
    for &[a, b, c] in faces {
        let [ab, bc, ca] = [middle(a, b), middle(b, c), middle(c, a)];
        divided.extend([[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]);
    }
    divided
}
