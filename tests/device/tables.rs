//! Tables of a few entries, all of which are read, against the same tables read by their index.

use crate::common::Setup;
use crate::common::scenes::{Stage, add_mesh, emitter, empty_scene};
use etendue::scene::{Material, Scene};
use glam::Vec3;

const ROWS: usize = 8;

/// So many emitters of their own colours, each of two triangles that share an edge.
fn scene(lights: usize) -> Scene {
    let mut scene = empty_scene();
    for i in 0..lights {
        let at = Vec3::new(3.0 * i as f32, 0.0, 0.0);
        let [a, b, c, d] = [Vec3::ZERO, Vec3::X, Vec3::ONE, Vec3::Y].map(|v| v + at);
        let material = Material {
            roughness: 0.1 * i as f32,
            ..emitter(1.0 + i as f32)
        };
        add_mesh(&mut scene, &[[a, b, c], [a, c, d]], material);
    }
    scene
}

/// Rows that differ between tables as the scene has them and as any scene has them, and all rows.
fn compare(
    scene: &Scene,
    patch: Option<(&'static str, &'static str, &'static str)>,
) -> (usize, usize) {
    let stage = Stage::new(scene);
    let p = &stage.prepared;
    let counts = [
        p.lights.table.len(),
        p.materials.len(),
        p.textures.textures.len(),
    ];
    let count = counts.into_iter().max().expect("three tables");
    let setup = Setup::new().structure(&p.bvh).with(stage.constants());
    let mut of_scene = setup.clone().tables(p);
    if let Some((file, from, to)) = patch {
        of_scene = of_scene.patched(file, from, to);
    }
    let read = |setup: &Setup| -> Vec<[u32; 4]> {
        let kernel = setup.kernel("tables", "main");
        let counts = counts.map(|n| n as u32);
        kernel.run(
            count as u32,
            counts,
            &[[0.0_f32; 4]],
            ROWS * count,
            &stage.buffers(),
        )
    };
    let (short, long) = (read(&of_scene), read(&setup));
    let unlike = short.iter().zip(&long).filter(|(s, l)| s != l).count();
    assert!(long.iter().any(|row| row.iter().any(|&word| word != 0)));
    (unlike, long.len())
}

#[test]
fn short_tables_hold_what_long_ones_do() {
    // One pair, four, and more than are read at once; eight lights, more.
    for lights in [1, 2, 4, 5, 9] {
        assert_eq!(compare(&scene(lights), None).0, 0, "{lights}");
    }
}

/// Negative controls: an entry that is never found, in each file.
#[test]
fn a_wrong_entry_is_noticed() {
    for file in ["light_table.wgsl", "material_table.wgsl"] {
        let patch = (file, "i == 1u", "i == 100u");
        assert!(compare(&scene(3), Some(patch)).0 > 0, "{file}");
    }
    let patch = ("light_table.wgsl", "id >> 1u == pair1", "id == pair1");
    assert!(compare(&scene(3), Some(patch)).0 > 0);
}
