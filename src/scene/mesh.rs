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
    /// Tangents, w = ±1 the sign of the bitangent; empty: no material here needs them.
    pub tangents: Vec<Vec4>,
    /// TEXCOORD_0, TEXCOORD_1.
    pub tex_coords: [Vec<Vec2>; 2],
    /// COLOR_0, linear, multiplies the base colour.
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
