//! From placed meshes to one list of world-space triangles around the camera.
//!
//! Transforms are applied in f64 and positions are taken relative to the camera before they are
//! rounded to f32, so a scene far from the origin keeps its precision where the picture is taken.

use std::borrow::Cow;

use glam::{DMat3, DVec3, Vec3};
use rayon::prelude::*;

use super::layout::{
    MATERIAL_INDEX_MASK, TRIANGLE_ALPHA, TRIANGLE_COLORS, TRIANGLE_FLAT, TRIANGLE_SINGLE_SIDED,
    TRIANGLE_TANGENTS,
};
use super::vertex_format::VertexFormat;
use crate::accel::Placed;
use crate::scene::{AlphaMode, Instance, Material, Mesh, Scene};

/// All triangles of a scene, in the order of instances and their indices.
#[derive(Debug, Clone, Default)]
pub struct FlatGeometry {
    /// Vertices relative to the origin that was asked for; all finite.
    pub triangles: Vec<[Vec3; 3]>,
    /// Indices into the vertices of `words`, three a triangle.
    pub indices: Vec<[u32; 3]>,
    /// Material of each triangle, and its `TRIANGLE_*` bits.
    pub attributes: Vec<u32>,
    /// Vertex attributes, [`VertexFormat::stride`] words a vertex.
    pub words: Vec<f32>,
    /// Triangles left out because a vertex is NaN, infinite or out of f32's range.
    pub dropped: u64,
}

impl FlatGeometry {
    /// Index of a triangle's material.
    pub fn material(&self, triangle: usize) -> usize {
        (self.attributes[triangle] & MATERIAL_INDEX_MASK) as usize
    }

    /// Flattens a validated scene around `origin` (metres, world).
    pub fn new(scene: &Scene, format: &VertexFormat, origin: DVec3) -> Self {
        let mut flat = Self::default();
        let count = scene
            .instances
            .iter()
            .map(|i| scene.meshes[i.mesh].indices.len())
            .sum();
        flat.triangles.reserve_exact(count);
        flat.indices.reserve_exact(count);
        flat.attributes.reserve_exact(count);
        for instance in &scene.instances {
            let mesh = &scene.meshes[instance.mesh];
            flat.add(
                instance,
                mesh,
                &scene.materials[mesh.material],
                format,
                origin,
            );
        }
        flat
    }

    fn add(
        &mut self,
        instance: &Instance,
        mesh: &Mesh,
        material: &Material,
        format: &VertexFormat,
        origin: DVec3,
    ) {
        let first_vertex = self
            .words
            .len()
            .checked_div(format.stride as usize)
            .unwrap_or(0) as u32;
        let positions: Vec<Vec3> = mesh
            .positions
            .par_iter()
            .map(|p| (instance.to_world.transform_point3(p.as_dvec3()) - origin).as_vec3())
            .collect();
        let linear = DMat3::from_mat4(instance.to_world);
        let mirrored = linear.determinant() < 0.0;
        let flags = triangle_flags(mesh, material, format);
        // A mirror turns windings round: the front stays the front.
        let turned = |&[a, b, c]: &[u32; 3]| if mirrored { [a, c, b] } else { [a, b, c] };
        let is_finite = |corners: &[u32; 3]| {
            let mut corners = corners.iter();
            corners.all(|&i| positions[i as usize].is_finite())
        };
        let mut kept = Cow::Borrowed(&mesh.indices);
        if !positions.par_iter().all(|p| p.is_finite()) {
            kept.to_mut().retain(is_finite);
        }
        self.dropped += (mesh.indices.len() - kept.len()) as u64;
        let corners = kept.par_iter().map(turned);
        let triangle = |corners: [u32; 3]| corners.map(|i| positions[i as usize]);
        self.triangles.par_extend(corners.clone().map(triangle));
        self.indices
            .par_extend(corners.map(|corners| corners.map(|i| first_vertex + i)));
        let attributes = mesh.material as u32 | flags;
        self.attributes
            .par_extend(rayon::iter::repeat_n(attributes, kept.len()));
        format.append(&mut self.words, mesh, &linear);
    }

    /// The triangles in the order of a tree, with their vertices turned as they are there.
    pub fn reorder(&mut self, order: &[Placed]) {
        let corners = |i: &Placed| i.turned.corners(self.indices[i.turned.triangle as usize]);
        self.indices = order.par_iter().map(corners).collect();
        let corners = |i: &Placed| i.turned.corners(self.triangles[i.turned.triangle as usize]);
        self.triangles = order.par_iter().map(corners).collect();
        let attributes = |i: &Placed| self.attributes[i.turned.triangle as usize];
        self.attributes = order.par_iter().map(attributes).collect();
    }

    /// Radius of a sphere around the middle of the bounds that holds everything, metres.
    pub fn radius(&self) -> f64 {
        let nothing = || (DVec3::INFINITY, DVec3::NEG_INFINITY);
        let add =
            |(low, high): (DVec3, DVec3), v: &Vec3| (low.min(v.as_dvec3()), high.max(v.as_dvec3()));
        let both = |a: (DVec3, DVec3), b: (DVec3, DVec3)| (a.0.min(b.0), a.1.max(b.1));
        let vertices = self.triangles.as_flattened().par_iter();
        let (low, high) = vertices.fold(nothing, add).reduce(nothing, both);
        if self.triangles.is_empty() {
            return 0.0;
        }
        0.5 * (high - low).length()
    }
}

fn triangle_flags(mesh: &Mesh, material: &Material, format: &VertexFormat) -> u32 {
    let mut flags = 0;
    if material.alpha_mode != AlphaMode::Opaque {
        flags |= TRIANGLE_ALPHA;
    }
    // From inside of a solid its back faces are seen.
    if !material.double_sided && !material.bounds_medium() {
        flags |= TRIANGLE_SINGLE_SIDED;
    }
    if mesh.normals.is_empty() {
        flags |= TRIANGLE_FLAT;
    }
    if format.colors.is_some() && !mesh.colors.is_empty() {
        flags |= TRIANGLE_COLORS;
    }
    if format.tangents.is_some() && !mesh.tangents.is_empty() {
        flags |= TRIANGLE_TANGENTS;
    }
    flags
}
