//! Keeping only the vertices that a primitive's triangles use.
//!
//! Exporters let many primitives share one long list of vertices; each must not drag all of it along.

use std::sync::atomic::{AtomicBool, Ordering};

use rayon::prelude::*;

use super::elements::PARALLEL;
use super::primitive::Window;
use crate::scene::Mesh;

/// The range of vertices that `triangles` use; afterwards they count from its start.
///
/// `triangles` is not empty.
pub(super) fn window(triangles: &mut [[u32; 3]]) -> Window {
    let wider = |(low, high): (u32, u32), &[a, b, c]: &[u32; 3]| {
        (low.min(a).min(b).min(c), high.max(a).max(b).max(c))
    };
    let both = |a: (u32, u32), b: (u32, u32)| (a.0.min(b.0), a.1.max(b.1));
    let parts = triangles.par_iter().with_min_len(PARALLEL);
    let (first, last) = parts
        .fold(|| (u32::MAX, 0), wider)
        .reduce(|| (u32::MAX, 0), both);
    if first > 0 {
        let parts = triangles.par_iter_mut().with_min_len(PARALLEL);
        parts.for_each(|corners| *corners = corners.map(|corner| corner - first));
    }
    first as usize..last as usize + 1
}

/// Leave out unused vertices where they are more than half of all.
pub(super) fn drop_unused(mesh: &mut Mesh) {
    let is_used = used(mesh);
    let count = is_used.iter().filter(|used| **used).count();
    if count * 2 > is_used.len() {
        return;
    }
    let mut new_index = vec![0; is_used.len()];
    let mut kept = Vec::with_capacity(count);
    for (old, _) in is_used.iter().enumerate().filter(|(_, used)| **used) {
        new_index[old] = kept.len() as u32;
        kept.push(old);
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

/// Which vertices the triangles use.
fn used(mesh: &Mesh) -> Vec<bool> {
    let mut used = Vec::new();
    used.resize_with(mesh.positions.len(), AtomicBool::default);
    let parts = mesh.indices.as_flattened().par_iter();
    let parts = parts.with_min_len(PARALLEL);
    parts.for_each(|&vertex| used[vertex as usize].store(true, Ordering::Relaxed));
    used.into_iter().map(AtomicBool::into_inner).collect()
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
