//! Which attributes the vertices on the device carry, and where.

use glam::{DMat3, DVec3, Vec4};

use crate::scene::Mesh;

/// Offsets, in words of 4 bytes, of each attribute inside a vertex; `None` if no vertex carries it.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct VertexFormat {
    /// Shading normal, 3 words.
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
    /// Lays out what is needed, without gaps.
    pub fn new(needs: VertexNeeds) -> Self {
        let mut stride = 0;
        let mut place = |needed: bool, words: u32| {
            let offset = stride;
            stride += if needed { words } else { 0 };
            needed.then_some(offset)
        };
        let normals = place(needs.normals, 3);
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
        words.reserve(mesh.positions.len() * self.stride as usize);
        let sign = if linear.determinant() < 0.0 {
            -1.0
        } else {
            1.0
        };
        let cofactor = cofactor(linear) * sign;
        for i in 0..mesh.positions.len() {
            if self.normals.is_some() {
                let n = mesh.normals.get(i).map_or(DVec3::ZERO, |n| {
                    (cofactor * n.as_dvec3()).normalize_or_zero()
                });
                words.extend(n.as_vec3().to_array());
            }
            if self.tangents.is_some() {
                let t = mesh.tangents.get(i).map_or(Vec4::ZERO, |t| {
                    let turned = (*linear * t.truncate().as_dvec3()).normalize_or_zero();
                    turned.as_vec3().extend(t.w * sign as f32)
                });
                words.extend(t.to_array());
            }
            for (set, offset) in [self.uv0, self.uv1].into_iter().enumerate() {
                if offset.is_some() {
                    let uv = mesh.tex_coords[set].get(i).copied().unwrap_or_default();
                    words.extend(uv.to_array());
                }
            }
            if self.colors.is_some() {
                words.extend(mesh.colors.get(i).copied().unwrap_or(Vec4::ONE).to_array());
            }
        }
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
    use glam::Vec3;

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
