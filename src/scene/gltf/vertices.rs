//! Keeping only the vertices that a primitive's triangles use.
//!
//! Exporters let many primitives share one long list of vertices; each must not drag all of it along.

use super::primitive::Window;
use crate::scene::Mesh;

/// The range of vertices that `triangles` use; afterwards they count from its start.
///
/// `triangles` is not empty.
pub(super) fn window(triangles: &mut [[u32; 3]]) -> Window {
    let corners = || triangles.iter().flatten().copied();
    let first = corners().min().unwrap_or(0);
    let last = corners().max().unwrap_or(0);
    if first > 0 {
        for corner in triangles.iter_mut().flatten() {
            *corner -= first;
        }
    }
    first as usize..last as usize + 1
}

/// Leave out unused vertices where they are more than half of all.
pub(super) fn drop_unused(mesh: &mut Mesh) {
    const UNUSED: u32 = u32::MAX;
    let mut new_index = vec![UNUSED; mesh.positions.len()];
    for &corner in mesh.indices.iter().flatten() {
        new_index[corner as usize] = 0;
    }
    let used = new_index.iter().filter(|&&index| index != UNUSED).count();
    if used * 2 > new_index.len() {
        return;
    }
    let mut kept = Vec::with_capacity(used);
    for (old, new) in new_index.iter_mut().enumerate() {
        if *new != UNUSED {
            *new = kept.len() as u32;
            kept.push(old);
        }
    }
    for corner in mesh.indices.iter_mut().flatten() {
        *corner = new_index[*corner as usize];
    }
    keep(&mut mesh.positions, &kept);
    keep(&mut mesh.normals, &kept);
    keep(&mut mesh.tangents, &kept);
    keep(&mut mesh.colors, &kept);
    for set in &mut mesh.tex_coords {
        keep(set, &kept);
    }
}

fn keep<T: Copy>(values: &mut Vec<T>, kept: &[usize]) {
    if !values.is_empty() {
        *values = kept.iter().map(|&index| values[index]).collect();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    #[test]
    fn windows_start_at_the_first_vertex_used() {
        let mut triangles = [[5, 9, 7], [5, 7, 6]];
        assert_eq!(window(&mut triangles), 5..10);
        assert_eq!(triangles, [[0, 4, 2], [0, 2, 1]]);
    }

    #[test]
    fn sparse_use_is_compacted() {
        let mut mesh = Mesh {
            positions: (0..10).map(|x| Vec3::splat(x as f32)).collect(),
            indices: vec![[9, 0, 4]],
            ..Mesh::default()
        };
        drop_unused(&mut mesh);
        assert_eq!(mesh.indices, [[2, 0, 1]]);
        assert_eq!(mesh.positions, [0.0, 4.0, 9.0].map(Vec3::splat));
    }
}
