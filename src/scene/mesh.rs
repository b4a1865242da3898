//! Triangle meshes and their placements.

use glam::{DMat4, Vec2, Vec3, Vec4};

/// Triangles with their attributes, in the mesh's own space.
///
/// Attribute vectors are either empty (absent) or as long as `positions`.
#[derive(Debug, Clone, Default)]
pub struct Mesh {
    /// Name of the glTF mesh, possibly empty.
    pub name: String,
    /// Vertex positions, metres; they may be NaN or infinite in bad files, and triangles that use
    /// such a vertex are dropped with a warning before an [`Instance`] is uploaded.
    pub positions: Vec<Vec3>,
    /// Three vertex indices a triangle, each below `positions.len()`.
    pub indices: Vec<[u32; 3]>,
    /// Unit shading normals; empty: flat normals.
    pub normals: Vec<Vec3>,
    /// Unit tangents, w = ±1 the sign of the bitangent w · (normal × tangent), which points up in the
    /// normal map's picture; empty: the normal map, if the material has one, is not used here.
    pub tangents: Vec<Vec4>,
    /// The two sets of texture coordinates, finite; a set that a slot of the material reads is there,
    /// except that the normal map's may be missing where there are no tangents.
    pub tex_coords: [Vec<Vec2>; 2],
    /// COLOR_0, linear, in [0, 1], multiplies the base colour.
    pub colors: Vec<Vec4>,
    /// Index into [`super::Scene::materials`].
    pub material: usize,
}

/// A mesh placed in the world.
#[derive(Debug, Clone, PartialEq)]
pub struct Instance {
    /// Index into [`super::Scene::meshes`].
    pub mesh: usize,
    /// Mesh space to world space, composed in f64; its determinant may be negative.
    pub to_world: DMat4,
    /// Name of the node, possibly empty.
    pub name: String,
}
