//! Which instances share geometry on the device, and in what space it is there.
//!
//! A group of meshes that is placed again and again, as the trunk and the leaves of a tree, is one tree of the
//! acceleration structure with a space of its own; its vertices, indices and elements are there once, and
//! each placement adds [`PLACEMENT_BYTES`]. All else is flattened into the world:
//!
//! - meshes that emit, since the table of lights has an entry for each of their triangles;
//! - meshes with a vertex that is not a finite number;
//! - placements by a matrix that is singular, shears strongly or is out of range ([`Placement::new`]);
//! - groups that are placed once, or so small that sharing them saves little;
//! - everything, where sharing saves too little to be worth a structure of two levels, which rays take longer to
//!   traverse ([`is_worth_it`]).

use std::collections::HashMap;
use std::ops::Range;

use glam::{DMat3, DMat4, DVec3};
use rayon::prelude::*;

use super::vertex_format::VertexFormat;
use crate::accel::{Instancing, MAX_TRIANGLES, Placement};
use crate::scene::{Features, Mesh, Scene};

/// What a placement adds: a leaf and a record of 64 bytes each, and its share of the nodes above.
const PLACEMENT_BYTES: u64 = 140;

/// What a triangle takes in pairs and nodes on average; an estimate, before there is a tree.
const ELEMENT_BYTES: u64 = 44;

/// A group that saves less stays flattened: one level less for what is small, 1 MiB.
const LEAST_SAVING: u64 = 1 << 20;

/// Which instances share geometry.
#[derive(Debug, Clone, Default)]
pub struct Sharing {
    /// What is shared.
    pub trees: Vec<SharedTree>,
    /// Where each of them is, around the origin that was asked for.
    pub placements: Vec<Placement>,
    /// For each instance of the scene whether it is one of them, or a part of one.
    pub is_shared: Vec<bool>,
    /// Estimated bytes on the device with every instance flattened, without textures and lights.
    pub flat_bytes: u64,
    /// The same as it is.
    pub bytes: u64,
}

/// Meshes that are placed together.
#[derive(Debug, Clone, PartialEq)]
pub struct SharedTree {
    /// Indices into [`Scene::meshes`].
    pub meshes: Vec<usize>,
    /// The space: the point of the meshes' space that is its origin,
    center: DVec3,
    /// and the length there of its unit, a power of two. The largest coordinate is 1/2 to 1.
    unit: f64,
}

/// Placements of the same meshes.
struct Group {
    meshes: Vec<usize>,
    /// Instances of the scene, one for each mesh.
    runs: Vec<Range<usize>>,
}

impl Sharing {
    /// Decides for a validated scene; a vertex has `stride` words of attributes. Placements are relative to
    /// `origin`, metres.
    pub fn new(scene: &Scene, stride: u32, origin: DVec3, instancing: Instancing) -> Self {
        let bytes = |mesh: &Mesh| mesh_bytes(mesh, stride);
        let bytes: Vec<u64> = scene.meshes.iter().map(bytes).collect();
        let flat_bytes = scene.instances.iter().map(|i| bytes[i.mesh]).sum();
        let nothing = Self {
            is_shared: vec![false; scene.instances.len()],
            flat_bytes,
            bytes: flat_bytes,
            ..Self::default()
        };
        if instancing == Instancing::Never {
            return nothing;
        }
        let mut sharing = nothing.clone();
        for group in groups(scene) {
            sharing.add(scene, &group, &bytes, origin, instancing);
        }
        let keep = match instancing {
            Instancing::Auto => is_worth_it(scene.triangle_count(), flat_bytes, sharing.bytes),
            _ => true,
        };
        if keep { sharing } else { nothing }
    }

    /// The same as a render from the scene's first camera has it.
    pub fn of(scene: &Scene, instancing: Instancing) -> Self {
        let stride = VertexFormat::of(&Features::of(scene)).stride;
        let camera = scene.cameras.first();
        let origin = camera.map_or(DVec3::ZERO, |c| c.to_world.w_axis.truncate());
        Self::new(scene, stride, origin, instancing)
    }

    /// Shares a group, if that is possible and saves enough.
    fn add(
        &mut self,
        scene: &Scene,
        group: &Group,
        bytes: &[u64],
        origin: DVec3,
        mode: Instancing,
    ) {
        let own: u64 = group.meshes.iter().map(|&mesh| bytes[mesh]).sum();
        let saved = |n: usize| {
            let (n, copies) = (n as u64, n.saturating_sub(1) as u64);
            (copies * own).checked_sub(n * PLACEMENT_BYTES)
        };
        let is_enough = |n| mode == Instancing::Always && n > 0 || saved(n) >= Some(LEAST_SAVING);
        if !is_enough(group.runs.len()) {
            return;
        }
        let Some(tree) = SharedTree::new(scene, group.meshes.clone()) else {
            return;
        };
        let index = self.trees.len();
        let place = |run: &Range<usize>| {
            let to_world = &scene.instances[run.start].to_world;
            Some((run.clone(), tree.placement(index, to_world, origin)?))
        };
        let placed: Vec<_> = group.runs.par_iter().filter_map(place).collect();
        if !is_enough(placed.len()) {
            return;
        }
        let count = placed.len() as u64;
        self.bytes -= (count - 1) * own;
        self.bytes += count * PLACEMENT_BYTES;
        self.trees.push(tree);
        for (run, placement) in placed {
            self.is_shared[run].fill(true);
            self.placements.push(placement);
        }
    }

    /// Triangles and vertices that the device will hold.
    pub fn counts(&self, scene: &Scene) -> (u64, u64) {
        let alone = scene.instances.iter().zip(&self.is_shared);
        let alone = alone.filter(|(_, shared)| !**shared).map(|(i, _)| i.mesh);
        let shared = self
            .trees
            .iter()
            .flat_map(|tree| tree.meshes.iter().copied());
        let meshes = alone.chain(shared).map(|mesh| &scene.meshes[mesh]);
        meshes.fold((0, 0), |(triangles, vertices), mesh| {
            let more = (mesh.indices.len() as u64, mesh.positions.len() as u64);
            (triangles + more.0, vertices + more.1)
        })
    }
}

/// Whether a structure of two levels is worth its price: half of the bytes and at least 64 MiB, or a gibibyte; or if
/// there would be more triangles than can be counted.
fn is_worth_it(triangles: u64, flat_bytes: u64, bytes: u64) -> bool {
    let saved = flat_bytes.saturating_sub(bytes);
    let is_half = 2 * bytes <= flat_bytes && saved >= 64 << 20;
    is_half || saved >= 1 << 30 || triangles > MAX_TRIANGLES as u64
}

/// Estimated bytes of a mesh on the device.
fn mesh_bytes(mesh: &Mesh, stride: u32) -> u64 {
    let (triangles, vertices) = (mesh.indices.len() as u64, mesh.positions.len() as u64);
    let attributes = match stride {
        0 => 0,
        _ => 12 * triangles + 4 * u64::from(stride) * vertices,
    };
    ELEMENT_BYTES * triangles + attributes
}

/// Instances that follow each other and are placed alike, by the meshes that they show; in the order in which
/// these are met first.
fn groups(scene: &Scene) -> Vec<Group> {
    let shareable: Vec<bool> = scene
        .meshes
        .par_iter()
        .map(|m| is_shareable(scene, m))
        .collect();
    let key = |i: usize| {
        let instance = &scene.instances[i];
        let matrix = instance.to_world.to_cols_array().map(f64::to_bits);
        (shareable[instance.mesh], matrix)
    };
    let mut groups: Vec<Group> = Vec::new();
    let mut known: HashMap<Vec<usize>, usize> = HashMap::new();
    let mut start = 0;
    while start < scene.instances.len() {
        let own = key(start);
        let others = (start + 1..scene.instances.len()).take_while(|&i| key(i) == own);
        let run = start..start + 1 + others.count();
        start = run.end;
        if own.0 {
            let meshes: Vec<usize> = scene.instances[run.clone()]
                .iter()
                .map(|i| i.mesh)
                .collect();
            let group = *known.entry(meshes).or_insert_with_key(|meshes| {
                let (meshes, runs) = (meshes.clone(), Vec::new());
                groups.push(Group { meshes, runs });
                groups.len() - 1
            });
            groups[group].runs.push(run);
        }
    }
    groups
}

/// Whether a mesh may have a space of its own.
fn is_shareable(scene: &Scene, mesh: &Mesh) -> bool {
    let material = &scene.materials[mesh.material];
    let emits = !material.unlit && material.emissive.max_element() > 0.0;
    let used = mesh.indices.iter().flatten();
    let mut positions = used.map(|&i| mesh.positions[i as usize]);
    !emits && !mesh.indices.is_empty() && positions.all(|p| p.is_finite())
}

impl SharedTree {
    /// None for meshes whose size is out of range.
    fn new(scene: &Scene, meshes: Vec<usize>) -> Option<Self> {
        let used = |&mesh: &usize| {
            let mesh = &scene.meshes[mesh];
            let used = mesh.indices.iter().flatten();
            used.map(|&i| mesh.positions[i as usize].as_dvec3())
        };
        let nothing = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        let positions = meshes.iter().flat_map(used);
        let (low, high) = positions.fold(nothing, |(l, h), p| (l.min(p), h.max(p)));
        let half = 0.5 * (high - low).max_element();
        // Less is flat, or too small to be told from a point.
        if !(1e-20..1e18).contains(&half) {
            return None;
        }
        let unit = half.log2().floor() + 1.0;
        Some(Self {
            meshes,
            center: low + 0.5 * (high - low),
            unit: unit.exp2(),
        })
    }

    /// A point of the meshes' space in that of the tree.
    pub fn point(&self, p: DVec3) -> DVec3 {
        (p - self.center) / self.unit
    }

    fn placement(&self, tree: usize, to_world: &DMat4, origin: DVec3) -> Option<Placement> {
        let linear = DMat3::from_mat4(*to_world) * self.unit;
        Placement::new(
            tree,
            linear,
            to_world.transform_point3(self.center) - origin,
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Instance, Material};
    use glam::Vec3;

    /// Meshes of a triangle each, placed as said.
    fn scene(instances: &[(usize, DMat4)]) -> Scene {
        let triangle = Mesh {
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y],
            indices: vec![[0, 1, 2]],
            ..Mesh::default()
        };
        let lamp = Material {
            emissive: Vec3::ONE,
            ..Material::default()
        };
        let mut scene = Scene {
            meshes: vec![triangle; 3],
            materials: vec![Material::default(), lamp],
            ..Scene::default()
        };
        scene.meshes[2].material = 1;
        for &(mesh, to_world) in instances {
            let name = String::new();
            scene.instances.push(Instance {
                mesh,
                to_world,
                name,
            });
        }
        scene
    }

    fn at(x: f64) -> DMat4 {
        DMat4::from_translation(DVec3::X * x)
    }

    fn share(scene: &Scene, instancing: Instancing) -> Sharing {
        Sharing::new(scene, 0, DVec3::ZERO, instancing)
    }

    #[test]
    fn meshes_that_are_placed_together_are_one_tree() {
        let parts = [
            (0, at(1.0)),
            (1, at(1.0)),
            (0, at(2.0)),
            (1, at(2.0)),
            (0, at(3.0)),
        ];
        let sharing = share(&scene(&parts), Instancing::Always);
        let meshes: Vec<_> = sharing.trees.iter().map(|t| t.meshes.clone()).collect();
        assert_eq!(meshes, [vec![0, 1], vec![0]]);
        let trees: Vec<_> = sharing.placements.iter().map(|p| p.tree).collect();
        assert_eq!(trees, [0, 0, 1]);
        assert_eq!(sharing.is_shared, [true; 5]);
    }

    #[test]
    fn what_emits_or_is_flat_in_the_world_is_not_shared() {
        let flat = DMat4::from_scale(DVec3::new(1.0, 1.0, 0.0));
        let sharing = share(
            &scene(&[(0, flat), (2, at(1.0)), (1, at(1.0))]),
            Instancing::Always,
        );
        assert_eq!(sharing.is_shared, [false, false, true]);
    }

    #[test]
    fn little_is_not_shared_unless_asked() {
        let instances: Vec<_> = (0..100).map(|i| (0, at(f64::from(i)))).collect();
        let scene = scene(&instances);
        assert!(share(&scene, Instancing::Auto).trees.is_empty());
        assert!(share(&scene, Instancing::Never).trees.is_empty());
        assert_eq!(share(&scene, Instancing::Always).trees.len(), 1);
    }

    #[test]
    fn much_is_shared() {
        let instances: Vec<_> = (0..1000).map(|i| (0, at(f64::from(i)))).collect();
        let mut scene = scene(&instances);
        scene.meshes[0].indices = vec![[0, 1, 2]; 10_000];
        let sharing = share(&scene, Instancing::Auto);
        assert_eq!((sharing.trees.len(), sharing.placements.len()), (1, 1000));
        assert_eq!(sharing.counts(&scene), (10_000, 3));
        assert!(sharing.bytes * 100 < sharing.flat_bytes);
    }

    #[test]
    fn coordinates_of_a_tree_are_within_one() {
        let mut scene = scene(&[(0, at(0.0))]);
        for scale in [1e-6, 1.0, 3e7] {
            scene.meshes[0].positions = [0.0, 1.0, 4.0]
                .map(|x| Vec3::new(x, -x, 7.0) * scale)
                .to_vec();
            let tree = SharedTree::new(&scene, vec![0]).expect("a size");
            let largest = scene.meshes[0].positions.iter();
            let largest = largest.map(|p| tree.point(p.as_dvec3()).abs().max_element());
            let largest = largest.fold(0.0, f64::max);
            assert!((0.5..=1.0).contains(&largest), "{largest}");
        }
    }
}
