//! Which triangles MikkTSpace can handle, and tangents for those that it cannot.

use std::collections::HashMap;

use glam::{DVec2, DVec3, Vec3, Vec4};

use crate::scene::Mesh;

/// Most triangles around a vertex that MikkTSpace is given: its time grows with their square.
const CROWDED: u32 = 1024;

/// Triangles whose vertices are finite, and none of them shared by more than [`CROWDED`] others.
pub(super) fn choose(mesh: &Mesh, set: usize) -> Vec<u32> {
    let welded = weld(mesh, set);
    let mut triangles_around = vec![0_u32; mesh.positions.len()];
    for &vertex in mesh.indices.iter().flatten() {
        triangles_around[welded[vertex as usize] as usize] += 1;
    }
    let fit = |vertex: u32| {
        let vertex = vertex as usize;
        mesh.positions[vertex].is_finite() && triangles_around[welded[vertex] as usize] <= CROWDED
    };
    let triangles = mesh.indices.iter().enumerate();
    triangles
        .filter(|(_, triangle)| triangle.iter().all(|&vertex| fit(vertex)))
        .map(|(index, _)| index as u32)
        .collect()
}

/// For each vertex, the first one that MikkTSpace may take for the same.
///
/// It compares normals too; leaving them out only overestimates the crowd.
fn weld(mesh: &Mesh, set: usize) -> Vec<u32> {
    let mut first = HashMap::with_capacity(mesh.positions.len());
    let vertices = mesh.positions.iter().zip(&mesh.tex_coords[set]).enumerate();
    vertices
        .map(|(index, (position, uv))| {
            // Adding zero makes −0 and +0 the same bits.
            let key = [position.x, position.y, position.z, uv.x, uv.y].map(|x| (x + 0.0).to_bits());
            *first.entry(key).or_insert(index as u32)
        })
        .collect()
}

/// The direction in which u grows over a triangle, perpendicular to `normal`; none if it has no
/// area in space or in the picture.
pub(super) fn own_tangent(
    mesh: &Mesh,
    set: usize,
    triangle: [u32; 3],
    normal: Vec3,
) -> Option<Vec4> {
    let [a, b, c] = triangle.map(|vertex| mesh.positions[vertex as usize].as_dvec3());
    let [p, q, r] = triangle.map(|vertex| mesh.tex_coords[set][vertex as usize].as_dvec2());
    // glTF's v grows downwards, a tangent frame's upwards.
    let upwards = DVec2::new(1.0, -1.0);
    let (q, r) = ((q - p) * upwards, (r - p) * upwards);
    let area = q.perp_dot(r);
    let along_u = ((b - a) * r.y - (c - a) * q.y) * area.signum();
    let normal = normal.as_dvec3();
    let tangent = along_u - normal * along_u.dot(normal);
    let scaled: DVec3 = tangent / tangent.abs().max_element();
    let unit = scaled.try_normalize().filter(|_| area != 0.0)?;
    Some(unit.as_vec3().extend(area.signum() as f32))
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec2;

    #[test]
    fn crowds_are_left_out_and_get_their_own_tangents() {
        let mesh = Mesh {
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::NAN],
            tex_coords: [
                vec![Vec2::ZERO, Vec2::X, Vec2::NEG_Y, Vec2::ZERO],
                Vec::new(),
            ],
            indices: vec![[0, 1, 2]; 1025],
            ..Mesh::default()
        };
        assert_eq!(choose(&mesh, 0), [0; 0]);
        let own = own_tangent(&mesh, 0, [0, 1, 2], Vec3::Z);
        assert_eq!(own, Some(Vec4::new(1.0, 0.0, 0.0, 1.0)));
        let mirrored = own_tangent(&mesh, 0, [0, 2, 1], Vec3::NEG_Z);
        assert_eq!(mirrored, Some(Vec4::new(1.0, 0.0, 0.0, -1.0)));
        assert_eq!(own_tangent(&mesh, 0, [0, 1, 1], Vec3::Z), None);
        let few = Mesh {
            indices: vec![[0, 1, 2], [0, 1, 3]],
            ..mesh
        };
        assert_eq!(choose(&few, 0), [0]);
    }
}
