//! Tangents for files that give none, as glTF asks: the MikkTSpace algorithm.

use bevy_mikktspace::{Geometry, TangentSpace, generate_tangents};
use glam::{Vec2, Vec3, Vec4};

use super::tangent_faces;
use crate::scene::Mesh;

/// Fill `mesh.tangents` from the texture coordinate set `set`, splitting vertices where the
/// triangles around them disagree. Without normals, the flat ones count.
pub(super) fn generate(mesh: &mut Mesh, set: usize) {
    let mut corners = Corners {
        position_scale: power_of_two_scale(mesh.positions.iter().map(|p| p.abs().max_element())),
        uv_scale: power_of_two_scale(mesh.tex_coords[set].iter().map(|uv| uv.abs().max_element())),
        faces: tangent_faces::choose(mesh, set),
        flat_normals: flat_normals(mesh),
        tangents: Vec::new(),
        set,
        mesh,
    };
    corners.tangents = vec![Vec4::ZERO; 3 * corners.mesh.indices.len()];
    // Its error type has no values; if it ever gets some, every tangent is replaced below.
    let _ = generate_tangents(&mut corners);
    let mut tangents = corners.tangents;
    let flat_normals = corners.flat_normals;
    replace_missing(mesh, set, &mut tangents, &flat_normals);
    split_vertices(mesh, &tangents);
}

/// A mesh as MikkTSpace sees it: corners of the triangles that it can handle.
struct Corners<'a> {
    mesh: &'a Mesh,
    set: usize,
    /// Triangle behind each face.
    faces: Vec<u32>,
    /// One a triangle if the mesh has no normals, else empty.
    flat_normals: Vec<Vec3>,
    /// Tangents do not change when everything is scaled; near 1 nothing overflows or vanishes.
    position_scale: f32,
    uv_scale: f32,
    /// Three a triangle.
    tangents: Vec<Vec4>,
}

impl Corners<'_> {
    fn vertex(&self, face: usize, corner: usize) -> usize {
        self.mesh.indices[self.faces[face] as usize][corner] as usize
    }
}

impl Geometry for Corners<'_> {
    fn num_faces(&self) -> usize {
        self.faces.len()
    }

    fn num_vertices_of_face(&self, _face: usize) -> usize {
        3
    }

    fn position(&self, face: usize, corner: usize) -> [f32; 3] {
        (self.mesh.positions[self.vertex(face, corner)] * self.position_scale).to_array()
    }

    fn normal(&self, face: usize, corner: usize) -> [f32; 3] {
        let normal = match self.flat_normals.get(self.faces[face] as usize) {
            Some(normal) => *normal,
            None => self.mesh.normals[self.vertex(face, corner)],
        };
        normal.to_array()
    }

    /// MikkTSpace expects v to grow upwards, glTF's grows downwards.
    fn tex_coord(&self, face: usize, corner: usize) -> [f32; 2] {
        let uv = self.mesh.tex_coords[self.set][self.vertex(face, corner)] * self.uv_scale;
        [uv.x, -uv.y]
    }

    fn set_tangent(&mut self, space: Option<TangentSpace>, face: usize, corner: usize) {
        if let Some(space) = space {
            let slot = 3 * self.faces[face] as usize + corner;
            self.tangents[slot] = Vec4::from_array(space.tangent_encoded());
        }
    }
}

/// The power of two that brings the largest of `sizes` near 1.
fn power_of_two_scale(sizes: impl Iterator<Item = f32>) -> f32 {
    let largest = sizes.filter(|size| size.is_finite()).fold(0.0, f32::max);
    if largest == 0.0 {
        return 1.0;
    }
    let exponent = f64::from(largest).log2().ceil().clamp(-126.0, 126.0);
    (-exponent).exp2() as f32
}

/// One normal a triangle, if the mesh has none itself.
fn flat_normals(mesh: &Mesh) -> Vec<Vec3> {
    if !mesh.normals.is_empty() {
        return Vec::new();
    }
    let triangles = mesh.indices.iter();
    triangles
        .map(|triangle| flat_normal(triangle.map(|vertex| mesh.positions[vertex as usize])))
        .collect()
}

/// The unit normal of a triangle, +Z if it has no area.
pub(super) fn flat_normal(triangle: [Vec3; 3]) -> Vec3 {
    let [a, b, c] = triangle.map(|vertex| vertex.as_dvec3());
    let normal = (b - a).cross(c - a);
    let unit = (normal / normal.abs().max_element()).try_normalize();
    unit.map_or(Vec3::Z, |normal| normal.as_vec3())
}

/// Where MikkTSpace gave nothing usable, the triangle's own tangent, or else any.
fn replace_missing(mesh: &Mesh, set: usize, tangents: &mut [Vec4], flat_normals: &[Vec3]) {
    for (corner, tangent) in tangents.iter_mut().enumerate() {
        if let Some(unit) = tangent.truncate().try_normalize() {
            *tangent = unit.extend(tangent.w);
            continue;
        }
        let triangle = mesh.indices[corner / 3];
        let normal = match flat_normals.get(corner / 3) {
            Some(normal) => *normal,
            None => mesh.normals[triangle[corner % 3] as usize],
        };
        let own = tangent_faces::own_tangent(mesh, set, triangle, normal);
        *tangent = own.unwrap_or_else(|| any_tangent(normal));
    }
}

/// A tangent perpendicular to the unit vector `normal`.
pub(super) fn any_tangent(normal: Vec3) -> Vec4 {
    normal.any_orthonormal_vector().extend(1.0)
}

/// Give every vertex the tangents of its corners; a vertex with several becomes several vertices.
fn split_vertices(mesh: &mut Mesh, corner_tangents: &[Vec4]) {
    const NONE: u32 = u32::MAX;
    let mut tangents = vec![any_tangent(Vec3::Z); mesh.positions.len()];
    let mut used = vec![false; mesh.positions.len()];
    // The copies of a vertex form a chain: `next` leads from each to the following one.
    let mut next = vec![NONE; mesh.positions.len()];
    let mut copied_from = Vec::new();
    for (corner, &tangent) in corner_tangents.iter().enumerate() {
        let original = mesh.indices[corner / 3][corner % 3];
        let mut vertex = original;
        loop {
            let at = vertex as usize;
            if !used[at] || tangents[at] == tangent {
                used[at] = true;
                tangents[at] = tangent;
                break;
            }
            if next[at] == NONE {
                next[at] = tangents.len() as u32;
                tangents.push(tangent);
                used.push(true);
                next.push(NONE);
                copied_from.push(original);
            }
            vertex = next[at];
        }
        mesh.indices[corner / 3][corner % 3] = vertex;
    }
    mesh.tangents = tangents;
    copy_vertices(mesh, &copied_from);
}

fn copy_vertices(mesh: &mut Mesh, copied_from: &[u32]) {
    fn extend<T: Copy>(values: &mut Vec<T>, copied_from: &[u32]) {
        if !values.is_empty() {
            values.reserve_exact(copied_from.len());
            for &vertex in copied_from {
                values.push(values[vertex as usize]);
            }
        }
    }
    extend::<Vec3>(&mut mesh.positions, copied_from);
    extend::<Vec3>(&mut mesh.normals, copied_from);
    extend::<Vec4>(&mut mesh.colors, copied_from);
    for set in &mut mesh.tex_coords {
        extend::<Vec2>(set, copied_from);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A square in the plane z = 0, seen from +Z with its picture upright: v grows downwards.
    fn square(scale: f32) -> Mesh {
        let corner = |x: f32, y: f32| Vec3::new(x, y, 0.0) * scale;
        Mesh {
            positions: vec![
                corner(0.0, 0.0),
                corner(1.0, 0.0),
                corner(1.0, 1.0),
                corner(0.0, 1.0),
            ],
            tex_coords: [
                vec![
                    Vec2::new(0.0, 1.0),
                    Vec2::new(1.0, 1.0),
                    Vec2::new(1.0, 0.0),
                    Vec2::ZERO,
                ],
                Vec::new(),
            ],
            indices: vec![[0, 1, 2], [0, 2, 3]],
            ..Mesh::default()
        }
    }

    #[test]
    fn an_upright_picture_has_its_tangent_to_the_right_and_its_bitangent_up() {
        for scale in [1e-30, 1e-6, 1.0, 1e6, 1e30] {
            let mut mesh = square(scale);
            generate(&mut mesh, 0);
            assert_eq!(mesh.positions.len(), 4, "nothing had to be split");
            assert_eq!(mesh.tangents, [Vec4::new(1.0, 0.0, 0.0, 1.0); 4]);
        }
    }

    #[test]
    fn a_mirrored_half_splits_its_shared_vertices() {
        let mut mesh = square(1.0);
        mesh.tex_coords[0][3] = Vec2::new(2.0, 1.5);
        generate(&mut mesh, 0);
        assert_eq!(mesh.positions.len(), 6);
        assert_eq!(mesh.tangents.len(), 6);
        assert_eq!(mesh.tex_coords[0].len(), 6);
        let signs: Vec<f32> = mesh
            .indices
            .iter()
            .map(|t| mesh.tangents[t[0] as usize].w)
            .collect();
        assert_eq!(signs, [1.0, -1.0]);
    }

    #[test]
    fn degenerate_input_gets_some_unit_tangent() {
        let mut mesh = square(1.0);
        mesh.positions[0] = Vec3::NAN;
        mesh.positions[1] = mesh.positions[2];
        mesh.tex_coords[0] = vec![Vec2::ZERO; 4];
        generate(&mut mesh, 0);
        assert!(
            mesh.tangents
                .iter()
                .all(|t| (t.truncate().length() - 1.0).abs() < 1e-5)
        );
    }
}
