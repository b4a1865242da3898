//! Solids that light enters: which of two that overlap counts, and which are around the camera.

use glam::{DMat4, DVec3};
use rayon::prelude::*;

use crate::scene::{Instance, Mesh, Scene};

/// Solids around a point that the shader can hold.
const MOST: usize = 4;

/// For each material its rank where solids overlap: the one of the larger rank is there. The smaller a solid's
/// bounds, the higher its rank, so that what is immersed in another solid counts, from whichever side it is
/// entered; glTF has no order of its own.
pub fn medium_ranks(scene: &Scene) -> Vec<u32> {
    let mut extents = vec![0.0_f64; scene.materials.len()];
    for instance in solids(scene) {
        let (low, high) = bounds(&scene.meshes[instance.mesh], &instance.to_world);
        let size = high - low;
        let material = scene.meshes[instance.mesh].material;
        extents[material] = extents[material].max(size.x * size.y * size.z);
    }
    let mut order: Vec<usize> = (0..extents.len()).collect();
    order.sort_by(|&a, &b| extents[b].total_cmp(&extents[a]).then(a.cmp(&b)));
    let mut ranks = vec![0; extents.len()];
    for (rank, material) in order.into_iter().enumerate() {
        ranks[material] = rank as u32;
    }
    ranks
}

/// The solids that a point is in, as entries of the shader: indices of materials + 1, or 0. A point is inside where
/// the surface winds around it (Jacobson et al. 2013, Robust Inside-Outside Segmentation using Generalized Winding
/// Numbers), which small gaps of a mesh do not change.
pub fn media_around(scene: &Scene, point: DVec3) -> [u32; MOST] {
    let mut media = [0; MOST];
    let mut filled = 0;
    for instance in solids(scene) {
        let mesh = &scene.meshes[instance.mesh];
        let (low, high) = bounds(mesh, &instance.to_world);
        let may_be_inside = point.cmpge(low).all() && point.cmple(high).all();
        if !may_be_inside || filled == MOST {
            continue;
        }
        if winding_number(mesh, &instance.to_world, point) > 0.5 {
            media[filled] = mesh.material as u32 + 1;
            filled += 1;
        }
    }
    media
}

fn solids(scene: &Scene) -> impl Iterator<Item = &Instance> {
    let is_solid = |instance: &&Instance| {
        let material = &scene.materials[scene.meshes[instance.mesh].material];
        material.bounds_medium() && material.ior >= 1.0
    };
    scene.instances.iter().filter(is_solid)
}

fn bounds(mesh: &Mesh, to_world: &DMat4) -> (DVec3, DVec3) {
    let positions = mesh.positions.iter().filter(|p| p.is_finite());
    let nothing = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    positions.fold(nothing, |(low, high), p| {
        let p = to_world.transform_point3(p.as_dvec3());
        (low.min(p), high.max(p))
    })
}

/// How often a surface whose front faces look outward winds around a point.
fn winding_number(mesh: &Mesh, to_world: &DMat4, point: DVec3) -> f64 {
    let corner = |v: u32| to_world.transform_point3(mesh.positions[v as usize].as_dvec3()) - point;
    let sum: f64 = mesh
        .indices
        .par_iter()
        .map(|t| solid_angle(t.map(corner)))
        .sum();
    let mirrored = if to_world.determinant() < 0.0 {
        -1.0
    } else {
        1.0
    };
    mirrored * sum / (4.0 * std::f64::consts::PI)
}

/// Signed solid angle of a triangle seen from the origin, positive where its back is seen (Van Oosterom and
/// Strackee 1983).
fn solid_angle([a, b, c]: [DVec3; 3]) -> f64 {
    let (x, y, z) = (a.length(), b.length(), c.length());
    let numerator = a.dot(b.cross(c));
    let denominator = x * y * z + a.dot(b) * z + b.dot(c) * x + c.dot(a) * y;
    let angle = 2.0 * numerator.atan2(denominator);
    if angle.is_finite() { angle } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Material;
    use glam::Vec3;

    /// A cube of half a side `r` around the origin.
    fn cube(r: f32, material: usize) -> Mesh {
        let corner = |i: u32| Vec3::from([0, 1, 2].map(|a| if i >> a & 1 == 1 { r } else { -r }));
        let quads = [
            [0, 2, 3, 1],
            [4, 5, 7, 6],
            [0, 1, 5, 4],
            [2, 6, 7, 3],
            [0, 4, 6, 2],
            [1, 3, 7, 5],
        ];
        let halves = |[a, b, c, d]: [u32; 4]| [[a, b, c], [a, c, d]];
        Mesh {
            positions: (0..8).map(corner).collect(),
            indices: quads.into_iter().flat_map(halves).collect(),
            material,
            ..Mesh::default()
        }
    }

    fn glass_cubes(sizes: &[f32]) -> Scene {
        let mut scene = Scene::default();
        for (i, &size) in sizes.iter().enumerate() {
            scene.materials.push(Material {
                transmission: 1.0,
                solid: true,
                ..Material::default()
            });
            scene.meshes.push(cube(size, i));
            scene.instances.push(Instance {
                mesh: i,
                to_world: DMat4::IDENTITY,
                name: String::new(),
            });
        }
        scene
    }

    #[test]
    fn points_inside_of_solids_are_found() {
        let mut scene = glass_cubes(&[2.0, 1.0]);
        assert_eq!(
            media_around(&scene, DVec3::new(0.1, 0.2, 0.3)),
            [1, 2, 0, 0]
        );
        assert_eq!(
            media_around(&scene, DVec3::new(1.5, 0.2, 0.3)),
            [1, 0, 0, 0]
        );
        assert_eq!(media_around(&scene, DVec3::new(0.0, 2.1, 0.0)), [0; 4]);
        scene.instances[0].to_world = DMat4::from_scale(DVec3::new(-1.0, 1.0, 1.0));
        assert_eq!(
            media_around(&scene, DVec3::new(1.5, 0.2, 0.3)),
            [1, 0, 0, 0]
        );
        scene.materials[0].solid = false;
        assert_eq!(media_around(&scene, DVec3::new(1.5, 0.2, 0.3)), [0; 4]);
    }

    #[test]
    fn of_two_solids_the_smaller_ranks_higher() {
        let ranks = medium_ranks(&glass_cubes(&[1.0, 3.0, 2.0]));
        assert!(ranks[0] > ranks[2] && ranks[2] > ranks[1], "{ranks:?}");
    }
}
