//! From placed meshes to one list of world-space triangles around the camera.
//!
//! Transforms are applied in f64 and positions are taken relative to the camera before they are
//! rounded to f32, so a scene far from the origin keeps its precision where the picture is taken.
//!
//! Geometry that instances share ([`Sharing`]) comes after that, once, each tree in a space of its own.

use std::borrow::Cow;
use std::ops::Range;

use glam::{DMat3, DVec3, Vec3};
use rayon::prelude::*;

use super::layout::{
    MATERIAL_INDEX_MASK, TRIANGLE_ALPHA, TRIANGLE_COLORS, TRIANGLE_FLAT, TRIANGLE_SINGLE_SIDED,
    TRIANGLE_TANGENTS,
};
use super::sharing::Sharing;
use super::vertex_format::VertexFormat;
use crate::accel::Placed;
use crate::geometry::Aabb;
use crate::scene::{AlphaMode, Material, Mesh, Scene};

/// All triangles of a scene, in the order of instances and their indices; then those of shared trees.
#[derive(Debug, Clone, Default)]
pub struct FlatGeometry {
    /// Vertices relative to the origin that was asked for, or in the space of a tree; all finite.
    pub triangles: Vec<[Vec3; 3]>,
    /// How many of them are in the world.
    pub world: usize,
    /// The triangles of each shared tree.
    pub trees: Vec<Range<usize>>,
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

    /// Flattens what is not shared of a validated scene around `origin` (metres, world), and adds what is.
    pub fn new(scene: &Scene, format: &VertexFormat, origin: DVec3, sharing: &Sharing) -> Self {
        let mut flat = Self::default();
        let (count, _) = sharing.counts(scene);
        flat.triangles.reserve_exact(count as usize);
        flat.indices.reserve_exact(count as usize);
        flat.attributes.reserve_exact(count as usize);
        let alone = scene.instances.iter().zip(&sharing.is_shared);
        for (instance, _) in alone.filter(|(_, shared)| !**shared) {
            let to_world = |p: DVec3| instance.to_world.transform_point3(p) - origin;
            let linear = DMat3::from_mat4(instance.to_world);
            flat.add(scene, instance.mesh, format, to_world, &linear);
        }
        flat.world = flat.triangles.len();
        for tree in &sharing.trees {
            let start = flat.triangles.len();
            for &mesh in &tree.meshes {
                flat.add(scene, mesh, format, |p| tree.point(p), &DMat3::IDENTITY);
            }
            flat.trees.push(start..flat.triangles.len());
        }
        flat
    }

    /// Adds a mesh whose points and directions are placed by a function and its linear part.
    fn add(
        &mut self,
        scene: &Scene,
        mesh: usize,
        format: &VertexFormat,
        place: impl Fn(DVec3) -> DVec3 + Sync,
        linear: &DMat3,
    ) {
        let mesh = &scene.meshes[mesh];
        let first_vertex = self
            .words
            .len()
            .checked_div(format.stride as usize)
            .unwrap_or(0) as u32;
        let positions: Vec<Vec3> = mesh
            .positions
            .par_iter()
            .map(|p| place(p.as_dvec3()).as_vec3())
            .collect();
        let mirrored = linear.determinant() < 0.0;
        let flags = triangle_flags(mesh, &scene.materials[mesh.material], format);
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
        format.append(&mut self.words, mesh, linear);
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

    /// Radius of a sphere around the middle of the bounds that holds everything, metres: the triangles of the world and
    /// some boxes.
    pub fn radius(&self, boxes: impl Iterator<Item = Aabb>) -> f64 {
        let nothing = || (DVec3::INFINITY, DVec3::NEG_INFINITY);
        let add =
            |(low, high): (DVec3, DVec3), v: &Vec3| (low.min(v.as_dvec3()), high.max(v.as_dvec3()));
        let both = |a: (DVec3, DVec3), b: (DVec3, DVec3)| (a.0.min(b.0), a.1.max(b.1));
        // In the order of a tree, that of the world is the first.
        let vertices = self.triangles[..self.world].as_flattened().par_iter();
        let world = vertices.fold(nothing, add).reduce(nothing, both);
        let boxes = boxes.map(|b| (b.min.as_dvec3(), b.max.as_dvec3()));
        let (low, high) = boxes.fold(world, both);
        if low.x > high.x {
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
