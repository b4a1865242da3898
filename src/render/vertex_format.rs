//! Which attributes the vertices on the device carry, and where.

use glam::{DMat3, DVec3, Vec3, Vec4};
use rayon::prelude::*;

use crate::scene::{Features, Mesh};

/// Offsets, in words of 4 bytes, of each attribute inside a vertex; `None` if no vertex carries it. All are even, and so is
/// the stride: the device reads words in pairs.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct VertexFormat {
    /// Shading normal, 3 words and one that is unused.
    pub normals: Option<u32>,
    /// Tangent and sign, 4 words.
    pub tangents: Option<u32>,
    /// TEXCOORD_0, 2 words.
    pub uv0: Option<u32>,
    /// TEXCOORD_1, 2 words.
    pub uv1: Option<u32>,
    /// COLOR_0, 4 words.
    pub colors: Option<u32>,
    /// Words a vertex.
    pub stride: u32,
}

/// Which attributes a scene needs.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct VertexNeeds {
    /// Shading normals.
    pub normals: bool,
    /// Tangents.
    pub tangents: bool,
    /// TEXCOORD_0.
    pub uv0: bool,
    /// TEXCOORD_1.
    pub uv1: bool,
    /// COLOR_0.
    pub colors: bool,
}

impl VertexFormat {
    /// For a scene with some features.
    pub fn of(features: &Features) -> Self {
        Self::new(VertexNeeds {
            normals: features.normals,
            tangents: features.tangents,
            uv0: features.uv0,
            uv1: features.uv1,
            colors: features.colors,
        })
    }

    /// Lays out what is needed.
    pub fn new(needs: VertexNeeds) -> Self {
        let mut stride = 0;
        let mut place = |needed: bool, words: u32| {
            let offset = stride;
            stride += if needed { words } else { 0 };
            needed.then_some(offset)
        };
        let normals = place(needs.normals, 4);
        let tangents = place(needs.tangents, 4);
        let uv0 = place(needs.uv0, 2);
        let uv1 = place(needs.uv1, 2);
        let colors = place(needs.colors, 4);
        Self {
            normals,
            tangents,
            uv0,
            uv1,
            colors,
            stride,
        }
    }

    /// Appends the vertices of a mesh, normals and tangents turned into the world by `linear`.
    /// Attributes that the mesh lacks are filled with what has no effect.
    pub fn append(&self, words: &mut Vec<f32>, mesh: &Mesh, linear: &DMat3) {
        if self.stride == 0 {
            return;
        }
        let sign = if linear.determinant() < 0.0 {
            -1.0
        } else {
            1.0
        };
        let cofactor = cofactor(linear) * sign;
        let normal = |i: usize| {
            let turned = |n: &Vec3| (cofactor * n.as_dvec3()).normalize_or_zero();
            let n = mesh.normals.get(i).map_or(DVec3::ZERO, turned);
            n.as_vec3().to_array()
        };
        let tangent = |i: usize| {
            let turned = |t: &Vec4| {
                let turned = (*linear * t.truncate().as_dvec3()).normalize_or_zero();
                turned.as_vec3().extend(t.w * sign as f32)
            };
            mesh.tangents.get(i).map_or(Vec4::ZERO, turned).to_array()
        };
        let uv = |set: usize, i: usize| {
            let uv = mesh.tex_coords[set].get(i).copied().unwrap_or_default();
            uv.to_array()
        };
        let color = |i: usize| mesh.colors.get(i).copied().unwrap_or(Vec4::ONE).to_array();
        let start = words.len();
        let count = mesh.positions.len() * self.stride as usize;
        words.par_extend(rayon::iter::repeat_n(0.0, count));
        let vertices = words[start..].par_chunks_exact_mut(self.stride as usize);
        vertices.enumerate().for_each(|(i, vertex)| {
            put(vertex, self.normals, || normal(i));
            put(vertex, self.tangents, || tangent(i));
            put(vertex, self.uv0, || uv(0, i));
            put(vertex, self.uv1, || uv(1, i));
            put(vertex, self.colors, || color(i));
        });
    }
}

/// Writes an attribute where vertices carry it.
fn put<const N: usize>(vertex: &mut [f32], offset: Option<u32>, value: impl Fn() -> [f32; N]) {
    if let Some(offset) = offset {
        vertex[offset as usize..][..N].copy_from_slice(&value());
    }
}

/// The matrix of cofactors: det(M)·M⁻ᵀ, which turns normals also where M is singular.
fn cofactor(m: &DMat3) -> DMat3 {
    DMat3::from_cols(
        m.y_axis.cross(m.z_axis),
        m.z_axis.cross(m.x_axis),
        m.x_axis.cross(m.y_axis),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn leaves_out_what_is_not_needed() {
        let format = VertexFormat::new(VertexNeeds {
            uv0: true,
            colors: true,
            ..VertexNeeds::default()
        });
        assert_eq!(format.uv0, Some(0));
        assert_eq!(format.colors, Some(2));
        assert_eq!((format.normals, format.stride), (None, 6));
    }

    #[test]
    fn normals_stay_outward_under_a_mirror_and_a_squeeze() {
        let format = VertexFormat::new(VertexNeeds {
            normals: true,
            ..VertexNeeds::default()
        });
        let mesh = Mesh {
            positions: vec![Vec3::ZERO],
            normals: vec![Vec3::new(1.0, 1.0, 0.0).normalize()],
            ..Mesh::default()
        };
        let mut words = Vec::new();
        format.append(
            &mut words,
            &mesh,
            &DMat3::from_diagonal(DVec3::new(-2.0, 1.0, 1.0)),
        );
        let n = Vec3::from_slice(&words);
        assert!((n - Vec3::new(-0.5, 1.0, 0.0).normalize()).length() < 1e-6);
    }
}
