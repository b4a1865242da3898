//! Pictures of scenes whose instances share geometry: as if each had a copy of its own, and no ray is lost or caught
//! where it leaves a surface.

use etendue::accel::{BuildOptions, Instancing};
use etendue::render::{Film, Prepared, Settings};
use etendue::scene::{
    AlphaMode, Filter, Image, Instance, Material, Sampler, Scene, Texels, Texture, TextureSlot,
    Wrap,
};
use glam::{DMat3, DMat4, DVec3, Vec2, Vec3, Vec4};

use crate::common::builder::Icosphere;
use crate::common::statistics::{MAX_Z, compare_films};
use crate::common::{
    SceneBuilder, assert_radiance, black, effort, lambert, load, render_with, square,
    with_integrator,
};

/// False alarms of a comparison's tiles together; with 8 comparisons a right program fails on a new device with a
/// chance of less than 0.1 %; on one device nothing varies.
const ALPHA: f64 = 1e-4;
/// Side of a picture and of its tiles, pixels.
const SIZE: u32 = 24;
const TILE: usize = 8;

fn options(instancing: Instancing) -> BuildOptions {
    BuildOptions {
        instancing,
        ..BuildOptions::default()
    }
}

fn shared(scene: &Scene, settings: &Settings) -> Film {
    render_with(scene, settings, &options(Instancing::Always), None)
}

fn flat(scene: &Scene, settings: &Settings) -> Film {
    render_with(scene, settings, &options(Instancing::Never), None)
}

/// How many instances share geometry if asked to.
fn shared_count(scene: &Scene) -> usize {
    let prepared = Prepared::new(scene, 0, &options(Instancing::Always)).expect("a prepared scene");
    prepared.bvh.instances.len()
}

/// A turn, uneven scales along its axes, and a mirror.
fn deformation() -> DMat4 {
    let turn = DMat3::from_axis_angle(DVec3::new(0.3, 1.0, -0.2).normalize(), 0.2);
    DMat4::from_mat3(turn * DMat3::from_diagonal(DVec3::new(-0.8, 1.3, 0.9)))
}

fn deformed(scene: &Scene) -> Scene {
    let mut scene = scene.clone();
    for instance in &mut scene.instances {
        instance.to_world = deformation() * instance.to_world;
    }
    scene
}

fn check(name: &str, scene: &Scene) {
    assert!(shared_count(scene) > 0, "{name} shares nothing");
    let settings = |seed| Settings {
        seed,
        ..square(SIZE, 256 * effort(), 4)
    };
    let (a, b) = (flat(scene, &settings(1)), shared(scene, &settings(2)));
    let verdict = compare_films(&b, &a, TILE, ALPHA);
    let z = verdict.relative_bias / verdict.relative_bias_error;
    let z = if z.is_nan() { 0.0 } else { z };
    let seen = 100.0 * (MAX_Z + 1.28) * verdict.relative_bias_error;
    let line = format!(
        "{name}: z = {z:+.2}, a bias of {seen:.3} % of the whole would have been seen; {verdict}"
    );
    println!("{line}");
    assert!(verdict.pass && z.abs() < MAX_Z, "{line}");
}

#[test]
fn shared_and_flattened_scenes_look_alike() {
    for name in ["cornell_box", "foliage", "sphere_grid", "veach_mis"] {
        check(name, &load(name));
    }
}

#[test]
fn mirrored_and_unevenly_scaled_instances_look_like_flattened_ones() {
    for name in ["cornell_box", "foliage", "sphere_grid"] {
        check(&format!("{name}, deformed"), &deformed(&load(name)));
    }
}

/// Bytes of a scene's geometry on the device, by itself.
fn geometry_bytes(prepared: &Prepared) -> usize {
    let elements = size_of_val(&prepared.bvh.elements[..]);
    elements + size_of_val(&prepared.indices[..]) + size_of_val(&prepared.vertex_words[..])
}

/// Ten thousand copies of a mesh of 80,000 triangles, without being asked to share: their own copies would be 35 GB.
#[test]
fn many_instances_take_the_memory_of_one_and_their_placements() {
    let mut builder = SceneBuilder::new();
    builder.sphere(lambert(0.5), &Icosphere::new(DVec3::ZERO, 1.0, 6), false);
    builder.pinhole(DVec3::new(0.0, 5.0, 30.0), DVec3::ZERO, 1.0);
    let mut scene = builder.scene;
    let prepare = |scene: &Scene| {
        Prepared::new(scene, 0, &BuildOptions::default()).expect("a prepared scene")
    };
    let one = prepare(&scene);
    assert!(!one.bvh.has_instances());
    for i in 1..10_000 {
        let place = DVec3::new(f64::from(i % 100), 0.0, f64::from(i / 100)) * 3.0;
        scene.instances.push(Instance {
            to_world: DMat4::from_translation(place),
            ..scene.instances[0].clone()
        });
    }
    let many = prepare(&scene);
    assert_eq!(many.bvh.instances.len(), 10_000);
    let placements = geometry_bytes(&many) - geometry_bytes(&one);
    println!(
        "{} bytes for one, {placements} more for 10,000",
        geometry_bytes(&one)
    );
    assert!(placements < 160 * 10_000, "{placements}");
    let film = render_with(&scene, &square(16, 4, 2), &BuildOptions::default(), None);
    assert_eq!(film.pixels.len(), 256);
}

/// Largest difference of a pixel's channel, but for one pixel in a hundred: at silhouettes rays may decide otherwise.
fn difference(a: &Film, b: &Film) -> f64 {
    let pixel = |i: usize| {
        let (a, b) = (a.mean(i), b.mean(i));
        (0..3).map(|c| (a[c] - b[c]).abs()).fold(0.0, f64::max)
    };
    let mut all: Vec<f64> = (0..a.pixels.len()).map(pixel).collect();
    all.sort_by(f64::total_cmp);
    all[all.len() - 1 - all.len() / 100]
}

/// A slanted surface with a normal map, tangents, normals that are not the surface's, and two copies of it.
fn bumpy() -> Scene {
    let mut builder = SceneBuilder::new();
    let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    let positions = corners.map(|[x, y]: [f64; 2]| DVec3::new(x, y, 0.3 * x));
    let material = Material {
        normal_texture: Some(TextureSlot {
            texture: 0,
            tex_coord: 0,
            matrix: [Vec2::X, Vec2::Y],
            offset: Vec2::ZERO,
        }),
        double_sided: true,
        ..lambert(0.5)
    };
    builder.mesh(material, &positions, vec![[0, 1, 2], [0, 2, 3]]);
    builder.pinhole(DVec3::new(0.3, 0.2, 4.0), DVec3::ZERO, 0.9);
    let mut scene = builder.scene;
    let mesh = &mut scene.meshes[0];
    let normal =
        |[x, y]: [f64; 2]| Vec3::new(0.4 * x as f32 - 0.2, 0.3 * y as f32, 1.0).normalize();
    mesh.normals = corners.map(normal).to_vec();
    mesh.tangents = vec![Vec3::new(1.0, 0.2, 0.3).normalize().extend(-1.0); 4];
    mesh.tex_coords[0] = corners.map(|[x, y]| Vec2::new(x as f32, y as f32)).to_vec();
    scene.images.push(Image {
        name: String::new(),
        width: 2,
        height: 2,
        texels: Texels::Rgba8(vec![
            [128, 128, 255, 255],
            [200, 90, 220, 255],
            [60, 140, 230, 255],
            [128, 220, 200, 255],
        ]),
    });
    scene.textures.push(Texture {
        image: 0,
        sampler: Sampler {
            wrap_u: Wrap::Repeat,
            wrap_v: Wrap::Repeat,
            filter: Filter::Linear,
        },
    });
    for (x, sizes) in [
        (1.5, DVec3::new(1.0, 0.4, 0.7)),
        (-1.5, DVec3::new(-0.5, 1.0, 1.2)),
    ] {
        let to_world = DMat4::from_translation(DVec3::new(x, 0.0, -0.5)) * DMat4::from_scale(sizes);
        scene.instances.push(Instance {
            to_world,
            ..scene.instances[0].clone()
        });
    }
    scene
}

/// What is seen along the same rays, with the same random numbers: the same texels, normals and distances.
#[test]
fn the_same_rays_see_the_same() {
    let scenes = [
        ("cornell_box", load("cornell_box")),
        ("sphere_grid", load("sphere_grid")),
        ("bumpy", bumpy()),
    ];
    for (name, scene) in scenes {
        for (scene, what) in [(deformed(&scene), "deformed"), (scene, "as it is")] {
            for integrator in ["albedo", "normals", "depth"] {
                let settings = with_integrator(&square(64, 1, 1), integrator);
                let d = difference(&shared(&scene, &settings), &flat(&scene, &settings));
                println!("{name} {what}, {integrator}: {d:.2e}");
                assert!(d < 2e-5, "{name} {what}, {integrator}: {d}");
            }
        }
    }
}

/// Where many coverings are met by chance, instances of the same mesh must not all decide alike: a stack of sheets that
/// cover half each lets through what their number says, whichever way it is held in memory.
#[test]
fn instances_of_a_sheet_are_met_independently() {
    let mut builder = SceneBuilder::new();
    let sheet = Material {
        alpha_mode: AlphaMode::Blend,
        base_color: Vec4::new(0.0, 0.0, 0.0, 0.5),
        double_sided: true,
        ..black()
    };
    builder.quad(sheet, DVec3::ZERO, DVec3::X * 10.0, DVec3::Y * 10.0);
    builder.pinhole(DVec3::new(0.0, 0.0, 5.0), DVec3::ZERO, 0.5);
    builder.sky(1.0);
    let mut scene = builder.scene;
    for i in 1..4 {
        scene.instances.push(Instance {
            to_world: DMat4::from_translation(DVec3::Z * -0.1 * f64::from(i)),
            ..scene.instances[0].clone()
        });
    }
    assert_eq!(shared_count(&scene), 4);
    let film = shared(&scene, &square(16, 1024, 1));
    assert_radiance("light through four sheets", &film, 0.0625, 0.01);
}

/// Placements of a convex mesh: of extreme scales, squeezed, mirrored, far from the origin of its space.
fn placements() -> Vec<DMat4> {
    let turn = DMat3::from_axis_angle(DVec3::new(1.0, 2.0, 3.0).normalize(), 0.7);
    let mut list = Vec::new();
    for scale in [1e-6, 1.0, 1e6] {
        for sizes in [
            DVec3::ONE,
            DVec3::new(1.0, -0.5, 2.0),
            DVec3::new(1.0, 30.0, 0.2),
        ] {
            list.push(DMat4::from_mat3(turn * DMat3::from_diagonal(sizes * scale)));
        }
    }
    list
}

/// A sphere placed by a matrix, its fronts outside or inside, with a camera in its space.
fn sphere_scene(to_world: DMat4, center: DVec3, eye: DVec3, inward: bool) -> Scene {
    let mut builder = SceneBuilder::new();
    builder.sphere(lambert(0.5), &Icosphere::new(center, 1.0, 3), inward);
    builder.scene.instances[0].to_world = to_world;
    let eye = to_world.transform_point3(eye + center);
    builder.pinhole(eye, to_world.transform_point3(center), 1.2);
    builder.scene
}

/// On a convex surface nothing is in the way of any ray that leaves it, and within it all rays are caught: pictures of
/// ambient occlusion are white and black without exception.
#[test]
fn rays_that_leave_an_instance_are_neither_caught_nor_lost() {
    let settings = with_integrator(&square(32, 64, 1), "ao");
    for to_world in placements() {
        for center in [DVec3::ZERO, DVec3::new(40.0, -3.0, 7.0)] {
            for (eye, expected) in [
                (DVec3::new(0.1, 0.2, 2.5), 1.0),
                (DVec3::new(3.0, 0.5, 300.0), 1.0),
                (DVec3::new(0.2, -0.1, 0.3), 0.0),
            ] {
                let scene = sphere_scene(to_world, center, eye, expected == 0.0);
                let film = shared(&scene, &settings);
                let wrong = (0..film.pixels.len()).filter(|&i| film.mean(i) != [expected; 3]);
                assert_eq!(wrong.count(), 0, "{to_world} {center} {eye}");
            }
        }
    }
}

/// The triangle on which a ray starts is met in other instances: between two copies of one huge triangle all is dark.
#[test]
fn the_same_triangle_of_another_instance_is_met() {
    let mut builder = SceneBuilder::new();
    let corners = [
        DVec3::new(-1.0, 0.0, -1.0),
        DVec3::new(0.0, 0.0, 2.0),
        DVec3::new(1.0, 0.0, -1.0),
    ];
    builder.mesh(lambert(0.5), &corners.map(|c| c * 1e4), vec![[0, 1, 2]]);
    builder.pinhole(DVec3::new(0.0, 0.5, 0.0), DVec3::new(0.3, 0.0, 0.1), 1.0);
    let mut scene = builder.scene;
    let above = Instance {
        to_world: DMat4::from_translation(DVec3::Y),
        ..scene.instances[0].clone()
    };
    scene.instances.push(above);
    assert_eq!(shared_count(&scene), 2);
    let film = shared(&scene, &with_integrator(&square(32, 64, 1), "ao"));
    let lit: f64 = (0..film.pixels.len()).map(|i| film.mean(i)[0]).sum();
    // One ray in 10⁷ passes between their far edges.
    assert!(lit * 64.0 <= 1.0, "{lit}");
}
