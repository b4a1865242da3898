//! Where a scene is and how much is in it.

use glam::{DMat4, DVec3, Vec3};
use rayon::prelude::*;

use super::selector::{SelectError, Selector};
use super::{Mesh, Scene};

impl Scene {
    /// The smallest box around all triangles' finite vertices in the world; none without any.
    pub fn bounds(&self) -> Option<(DVec3, DVec3)> {
        let boxes = self.vertices(|positions, to_world| {
            positions.fold(None, |bounds, position| {
                let p = to_world.transform_point3(position.as_dvec3());
                let (low, high) = bounds.unwrap_or((p, p));
                Some((low.min(p), high.max(p)))
            })
        });
        boxes
            .into_iter()
            .flatten()
            .reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))
    }

    /// Distance of the farthest finite vertex from `center`, metres; 0 without any.
    pub fn farthest(&self, center: DVec3) -> f64 {
        let distances = self.vertices(|positions, to_world| {
            positions
                .map(|p| to_world.transform_point3(p.as_dvec3()).distance(center))
                .fold(0.0, f64::max)
        });
        distances.into_iter().fold(0.0, f64::max)
    }

    /// Triangles of all instances together.
    pub fn triangle_count(&self) -> u64 {
        self.instances
            .iter()
            .map(|instance| self.meshes[instance.mesh].indices.len() as u64)
            .sum()
    }

    /// Index of a camera by number or name.
    ///
    /// # Errors
    /// [`SelectError`] that lists the cameras.
    pub fn find_camera(&self, selector: &Selector) -> Result<usize, SelectError> {
        let names: Vec<&str> = self.cameras.iter().map(|c| c.name.as_str()).collect();
        selector.find("camera", &names)
    }

    /// Apply `measure` to the finite vertices of each instance that some triangle uses.
    fn vertices<T: Send>(
        &self,
        measure: impl Fn(&mut dyn Iterator<Item = Vec3>, &DMat4) -> T + Sync,
    ) -> Vec<T> {
        let used: Vec<Vec<u32>> = self.meshes.par_iter().map(used_vertices).collect();
        let instances = self.instances.par_iter();
        instances
            .map(|instance| {
                let positions = &self.meshes[instance.mesh].positions;
                let vertices = used[instance.mesh].iter();
                let positions = vertices.map(|&vertex| positions[vertex as usize]);
                measure(&mut positions.filter(|p| p.is_finite()), &instance.to_world)
            })
            .collect()
    }
}

/// The vertices that triangles use, each once.
fn used_vertices(mesh: &Mesh) -> Vec<u32> {
    let mut used = vec![false; mesh.positions.len()];
    for &vertex in mesh.indices.iter().flatten() {
        used[vertex as usize] = true;
    }
    (0..mesh.positions.len() as u32)
        .filter(|&vertex| used[vertex as usize])
        .collect()
}
