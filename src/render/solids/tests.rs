use glam::{DMat3, Vec3};

use super::*;
use crate::accel::{BuildOptions, Bvh};

type Triangles = Vec<[Vec3; 3]>;

fn pairs(triangles: &[[Vec3; 3]]) -> Vec<Element> {
    let options = BuildOptions {
        list_limit: usize::MAX,
        ..BuildOptions::default()
    };
    Bvh::build(triangles, &options).elements
}

fn quad(corner: Vec3, u: Vec3, v: Vec3) -> Triangles {
    let [a, b, c, d] = [corner, corner + u, corner + u + v, corner + v];
    vec![[a, b, c], [a, c, d]]
}

/// The faces of a box between two corners, the low and the high one of each axis.
fn box_faces(low: Vec3, high: Vec3) -> Vec<Triangles> {
    let size = high - low;
    let face = |axis: usize, side: f32| {
        let [u, v] = [(axis + 1) % 3, (axis + 2) % 3].map(|k| Vec3::AXES[k] * size[k]);
        quad(low + Vec3::AXES[axis] * size[axis] * side, u, v)
    };
    (0..3)
        .flat_map(|axis| [face(axis, 0.0), face(axis, 1.0)])
        .collect()
}

fn cube() -> Triangles {
    box_faces(Vec3::splat(-1.0), Vec3::ONE).concat()
}

/// Numbers of slabs, faces with pairs, and loose pairs.
fn counts(triangles: &[[Vec3; 3]]) -> Option<(Vec<usize>, usize, usize)> {
    let solids = Solids::new(&pairs(triangles))?;
    let slabs = || solids.solids.iter().flat_map(|solid| &solid.slabs);
    let faces = slabs().flat_map(|slab| slab.faces.iter().flatten());
    let covered = faces.filter(|face| !face.pairs.is_empty()).count();
    let slabs = solids
        .solids
        .iter()
        .map(|solid| solid.slabs.len())
        .collect();
    Some((slabs, covered, solids.loose.len()))
}

#[test]
fn a_cube_is_three_slabs_however_it_is_turned() {
    let turn = DMat3::from_rotation_y(0.3) * DMat3::from_rotation_x(0.7);
    let turned: Triangles = cube()
        .iter()
        .map(|t| t.map(|v| (turn * v.as_dvec3()).as_vec3()))
        .collect();
    for (mesh, directions) in [(cube(), 3), (turned, 6)] {
        assert_eq!(counts(&mesh), Some((vec![3], 6, 0)));
        let solids = Solids::new(&pairs(&mesh)).expect("a solid");
        assert_eq!(solids.directions.len(), directions);
        assert!(solids.solids[0].is_hull);
        for slab in &solids.solids[0].slabs {
            let offsets = slab
                .faces
                .each_ref()
                .map(|f| f.as_ref().expect("two faces").offset);
            assert!((offsets[0] + 1.0).abs() < 1e-6 && (offsets[1] - 1.0).abs() < 1e-6);
        }
    }
}

/// One side is missing: its plane still ends the solid.
#[test]
fn an_open_box_is_closed_by_a_face_without_pairs() {
    let faces = box_faces(Vec3::ZERO, Vec3::ONE);
    assert_eq!(counts(&faces[1..].concat()), Some((vec![3], 5, 0)));
}

/// A lid with a lamp in it, as in a Cornell box, is one face of five pairs; without the lamp a ray could go through.
#[test]
fn tiles_make_a_face_if_they_cover_it() {
    let mut faces = box_faces(Vec3::ZERO, Vec3::ONE);
    faces.pop();
    let tile = |x0: f32, x1: f32, y0: f32, y1: f32| {
        let corner = Vec3::new(x0, y0, 1.0);
        quad(corner, Vec3::X * (x1 - x0), Vec3::Y * (y1 - y0))
    };
    let ring = [
        tile(0.0, 1.0, 0.0, 0.25),
        tile(0.0, 1.0, 0.75, 1.0),
        tile(0.0, 0.25, 0.25, 0.75),
        tile(0.75, 1.0, 0.25, 0.75),
    ];
    let open = [faces.concat(), ring.concat()].concat();
    assert_eq!(counts(&open), None);
    let closed = [open.clone(), tile(0.25, 0.75, 0.25, 0.75)].concat();
    assert_eq!(counts(&closed), Some((vec![3], 6, 0)));
    // Twice the same is not a tiling.
    let twice = [closed, tile(0.25, 0.75, 0.25, 0.75)].concat();
    assert_eq!(counts(&twice), None);
}

#[test]
fn what_is_not_convex_or_too_little_stays_as_it_is() {
    let dented = {
        let mut faces = box_faces(Vec3::ZERO, Vec3::ONE);
        faces.pop();
        let [a, b, c, d] = [
            Vec3::Z,
            Vec3::new(1.0, 0.0, 1.0),
            Vec3::ONE,
            Vec3::new(0.0, 1.0, 1.0),
        ];
        let dent = Vec3::new(0.5, 0.5, 0.6);
        [
            faces.concat(),
            vec![[a, b, dent], [b, c, dent], [c, d, dent], [d, a, dent]],
        ]
        .concat()
    };
    assert_eq!(counts(&dented), None);
    assert_eq!(counts(&quad(Vec3::ZERO, Vec3::X, Vec3::Y)), None);
    assert_eq!(counts(&[]), None);
    // Beside a cube it is what is tested pair by pair.
    let beside: Triangles = dented
        .iter()
        .map(|t| t.map(|v| v + 3.0 * Vec3::X))
        .collect();
    let (slabs, faces, loose) = counts(&[cube(), beside].concat()).expect("a cube");
    assert_eq!((slabs, faces), (vec![3], 6));
    assert!(loose >= 7);
}

/// Alpha is asked of every surface along a ray, not of the first alone.
#[test]
fn surfaces_with_alpha_are_in_no_solid() {
    let mut elements = pairs(&cube());
    assert!(Solids::new(&elements).is_some());
    elements[2].words[FIRST_ATTRIBUTES + 1] |= TRIANGLE_ALPHA;
    assert_eq!(Solids::new(&elements), None);
}

/// From far away the vertices are too coarse.
#[test]
fn extremes_are_left_to_the_exact_test() {
    let moved = |by: Vec3, size: f32| -> Triangles {
        cube().iter().map(|t| t.map(|v| v * size + by)).collect()
    };
    assert!(counts(&moved(Vec3::splat(10.0), 1.0)).is_some());
    assert!(counts(&moved(Vec3::splat(1000.0), 1.0)).is_none());
    assert!(counts(&moved(Vec3::ZERO, 1e-9)).is_none());
    assert!(counts(&moved(Vec3::ZERO, 1e12)).is_none());
}

/// Of each vertex of a solid: it is in all slabs, up to what the error bound allows.
#[test]
fn vertices_are_within_their_slabs() {
    let turn = DMat3::from_rotation_z(0.4);
    let block: Triangles = box_faces(Vec3::new(3.0, -1.0, 0.5), Vec3::new(4.0, 2.0, 0.9))[..5]
        .concat()
        .iter()
        .map(|t| t.map(|v| (turn * v.as_dvec3()).as_vec3()))
        .collect();
    let elements = pairs(&block);
    let solids = Solids::new(&elements).expect("a solid");
    assert!(solids.least_height > 0.3 && solids.reach > 3.0);
    for slab in &solids.solids[0].slabs {
        let normal = solids.directions[slab.direction].normal;
        let offset = |side: usize| slab.faces[side].as_ref().expect("a face").offset;
        for point in elements.iter().flat_map(corners_of) {
            let along = normal.dot(point);
            assert!(along >= offset(0) - solids.error / 4.0, "{point}");
            assert!(along <= offset(1) + solids.error / 4.0, "{point}");
        }
    }
}

/// Faces of one pair have the numbers below that of the first tiled face.
#[test]
fn too_many_pairs_have_no_solids() {
    let cubes = |n: usize| -> Triangles {
        let at = |i: usize| 3.0 * Vec3::new((i % 4) as f32, (i / 4) as f32, 0.0);
        let cube_at = |i| cube().into_iter().map(move |t| t.map(|v| v + at(i)));
        (0..n).flat_map(cube_at).collect()
    };
    assert!(counts(&cubes(10)).is_some());
    assert!(counts(&cubes(11)).is_none());
}
