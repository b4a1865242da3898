//! Where a scene is and how much is in it.

use glam::{BVec3, DMat4, DVec3, Vec3};
use rayon::prelude::*;

use super::selector::{SelectError, Selector};
use super::{Instance, Mesh, Scene};

impl Scene {
    /// The smallest box around all triangles' finite vertices in the world; none without any. With more than 2²⁶
    /// placed vertices, around those of the boxes of each mesh: somewhat larger.
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

    /// Distance of the farthest finite vertex from `center`, metres; 0 without any. Of very many as [`Scene::bounds`].
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

    /// Apply `measure` to the finite vertices of each instance that some triangle uses; where they are very many, to the
    /// corners of the box around each mesh.
    fn vertices<T: Send>(
        &self,
        measure: impl Fn(&mut dyn Iterator<Item = Vec3>, &DMat4) -> T + Sync,
    ) -> Vec<T> {
        let used: Vec<Vec<u32>> = self.meshes.par_iter().map(used_vertices).collect();
        let placed = self.instances.iter().map(|i| used[i.mesh].len() as u64);
        if placed.sum::<u64>() > MOST_VERTICES {
            return self.boxes(&used, measure);
        }
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

    /// The same for the corners of the boxes.
    fn boxes<T: Send>(
        &self,
        used: &[Vec<u32>],
        measure: impl Fn(&mut dyn Iterator<Item = Vec3>, &DMat4) -> T + Sync,
    ) -> Vec<T> {
        let of_mesh = |(mesh, used): (&Mesh, &Vec<u32>)| {
            corners(used.iter().map(|&vertex| mesh.positions[vertex as usize]))
        };
        let corners: Vec<Vec<Vec3>> = self.meshes.par_iter().zip(used).map(of_mesh).collect();
        let of_instance = |i: &Instance| measure(&mut corners[i.mesh].iter().copied(), &i.to_world);
        self.instances.par_iter().map(of_instance).collect()
    }
}

/// Placed vertices up to which bounds are those of each of them.
const MOST_VERTICES: u64 = 1 << 26;

/// The corners of the box around the finite ones of some points; none without any.
fn corners(points: impl Iterator<Item = Vec3>) -> Vec<Vec3> {
    let finite = points.filter(|p| p.is_finite());
    let both = finite.fold(None, |b: Option<(Vec3, Vec3)>, p| {
        let (low, high) = b.unwrap_or((p, p));
        Some((low.min(p), high.max(p)))
    });
    let corner = |(low, high): (Vec3, Vec3), i: u32| {
        let is_high = BVec3::new(i & 1 != 0, i & 2 != 0, i & 4 != 0);
        Vec3::select(is_high, high, low)
    };
    both.map_or(vec![], |b| (0..8).map(|i| corner(b, i)).collect())
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
