//! No bit of the picture depends on how the work is cut into pieces.

use std::ops::ControlFlow;

use etendue::accel::BuildOptions;
use etendue::gpu::{Device, Loads};
use etendue::render::{Film, GpuScene, Prepared, Renderer, Settings};
use etendue::scene::{Environment, EnvironmentImage, Instance, Mesh, Scene, gltf};
use etendue::shader::ShaderLibrary;
use glam::{DMat4, Vec3};

fn bits(film: &Film) -> &[u8] {
    bytemuck::cast_slice(&film.pixels)
}

/// A scene on the device.
struct Stand {
    device: Device,
    library: ShaderLibrary,
    scene: Scene,
    prepared: Prepared,
    gpu_scene: GpuScene,
}

impl Stand {
    fn new(scene: Scene) -> Self {
        let device = Device::open(None).expect("a Vulkan device");
        let prepared = Prepared::new(&scene, 0, &BuildOptions::default()).expect("a flat scene");
        let gpu_scene = GpuScene::upload(&device, &prepared).expect("memory");
        Self {
            device,
            library: ShaderLibrary::embedded(),
            scene,
            prepared,
            gpu_scene,
        }
    }

    fn of(name: &str) -> Self {
        Self::new(load(name))
    }

    fn renderer(&self, settings: &Settings) -> Renderer<'_> {
        let (device, library, scene) = (&self.device, &self.library, &self.scene);
        Renderer::new(
            device,
            library,
            scene,
            &self.prepared,
            &self.gpu_scene,
            settings,
        )
        .expect("a kernel")
    }
}

fn load(name: &str) -> Scene {
    let path = format!("scenes/{name}.gltf");
    gltf::load(path.as_ref(), &Default::default()).expect("a scene")
}

/// Draws what is left; gives the film.
fn finish(renderer: &mut Renderer<'_>) -> Film {
    let flow = renderer.render(&mut |_, _| ControlFlow::Continue(()));
    assert!(flow.expect("a render").is_continue());
    renderer.film().expect("a film")
}

#[test]
fn the_picture_does_not_depend_on_the_pieces() {
    let stand = Stand::of("foliage");
    let render = |piece_tiles, pass_samples| {
        let settings = Settings {
            // No side is a multiple of a tile.
            width: 45,
            height: 27,
            spp: 11,
            stats: true,
            piece_tiles,
            pass_samples,
            ..Settings::default()
        };
        let mut renderer = stand.renderer(&settings);
        let mut pieces = 0;
        let mut count = |_: &Renderer<'_>, _: &_| {
            pieces += 1;
            ControlFlow::Continue(())
        };
        assert!(renderer.render(&mut count).expect("a render").is_continue());
        (pieces, renderer.film().expect("a film"))
    };
    let (one, whole) = render(Some(u32::MAX), Some(u64::MAX));
    assert_eq!(one, 1, "24 tiles in one piece, 11 samples in one pass");
    for (tiles, samples, pieces) in [(1, 11, 24), (5, 1, 55), (7, 3, 16), (24, 4, 3)] {
        let (count, film) = render(Some(tiles), Some(samples));
        assert_eq!(
            count, pieces,
            "{tiles} tiles a piece, {samples} samples a pass"
        );
        assert_eq!(
            bits(&film),
            bits(&whole),
            "{tiles} tiles, {samples} samples"
        );
        assert_eq!(film.steps, whole.steps, "{tiles} tiles, {samples} samples");
    }
    let (_, measured) = render(None, None);
    assert_eq!(bits(&measured), bits(&whole));
    assert_eq!(measured.steps, whole.steps);
    assert!(whole.steps.nodes > 0 && whole.steps.pairs > 0);
}

/// A driver on the CPU gives a lane several pixels of a large piece, one of a small one.
#[test]
fn the_picture_does_not_depend_on_the_pixels_of_a_lane() {
    let stand = Stand::of("cornell_box");
    let render = |piece_tiles, pass_samples, stops| {
        let settings = Settings {
            width: 93,
            height: 75,
            spp: 5,
            piece_tiles: Some(piece_tiles),
            pass_samples: Some(pass_samples),
            ..Settings::default()
        };
        let mut renderer = stand.renderer(&settings);
        if stops {
            let flow = renderer.render(&mut |_, _| ControlFlow::Break(()));
            assert!(flow.expect("a first piece").is_break());
        }
        finish(&mut renderer)
    };
    // 120 tiles: up to eight pixels a lane in one piece, one in pieces of 16.
    let whole = render(120, 3, false);
    assert_eq!(whole.spp_range(), (5, 5));
    for tiles in [16, 119] {
        let film = render(tiles, 3, false);
        assert_eq!(bits(&film), bits(&whole), "{tiles} tiles a piece");
        // Taken up again, the last pass meets pixels that have their samples already.
        let resumed = render(tiles, 5, true);
        assert_eq!(resumed.spp_range(), (5, 5), "{tiles} tiles a piece");
        assert_eq!(bits(&resumed), bits(&whole), "{tiles} tiles a piece");
    }
}

/// Arrays and film are read in double words or as texels where a device is faster so.
#[test]
fn the_picture_does_not_depend_on_what_is_read_at_once() {
    // A tree, many lamps and materials; textures and an environment; a list.
    for name in ["many_lights", "foliage", "cornell_box"] {
        let mut scene = load(name);
        if name == "foliage" {
            scene.environment = Some(sky());
        }
        compare_loads(&Stand::new(scene));
    }
}

/// 2.2 million pairs of triangles: two pages of a storage buffer where one may have 128 MiB, and one of a texel buffer.
#[test]
#[ignore = "slow"]
fn the_picture_does_not_depend_on_pages() {
    const SIDE: u32 = 1500;
    let mut scene = load("cornell_box");
    let corners = (0..=SIDE).flat_map(|y| (0..=SIDE).map(move |x| [x, y].map(f64::from)));
    let place = |[x, y]: [f64; 2]| {
        let [u, v] = [x, y].map(|c| c / f64::from(SIDE) - 0.5);
        Vec3::new(
            u as f32,
            (0.3 + 0.02 * (9e3 * u * v).sin()) as f32,
            v as f32,
        )
    };
    let squares = (0..SIDE).flat_map(|y| (0..SIDE).map(move |x| y * (SIDE + 1) + x));
    let halves = |at: u32| {
        [
            [at, at + SIDE + 1, at + 1],
            [at + 1, at + SIDE + 1, at + SIDE + 2],
        ]
    };
    scene.meshes.push(Mesh {
        positions: corners.map(place).collect(),
        indices: squares.flat_map(halves).collect(),
        ..Mesh::default()
    });
    scene.instances.push(Instance {
        mesh: scene.meshes.len() - 1,
        to_world: DMat4::IDENTITY,
        name: "cloth".into(),
    });
    let stand = Stand::new(scene);
    let pages = |texels| {
        let loads = Loads {
            doublewords: false,
            texels,
        };
        stand.gpu_scene.bindings(loads).len()
    };
    // Texels have a second binding for the elements only where these are one page.
    println!("{} and {} bindings", pages(false), pages(true));
    compare_loads(&stand);
}

fn compare_loads(stand: &Stand) {
    let possible = Loads::possible(stand.device.info());
    let render = |doublewords, texels| {
        let mut renderer = stand.renderer(&Settings {
            width: 45,
            height: 27,
            spp: 3,
            stats: true,
            loads: Loads {
                doublewords,
                texels,
            },
            ..Settings::default()
        });
        let declares = |text| renderer.wgsl().contains(text);
        assert_eq!(declares("film: array<u64>"), doublewords);
        assert_eq!(declares("texture_storage_1d"), texels);
        finish(&mut renderer)
    };
    let words = render(false, false);
    assert!(words.mean_radiance().iter().all(|c| *c > 0.0));
    if possible.doublewords {
        assert_eq!(bits(&render(true, false)), bits(&words));
    }
    if possible.texels {
        assert_eq!(bits(&render(false, true)), bits(&words));
    }
}

fn sky() -> Environment {
    let texels = (0..32).map(|i| [0.1 * i as f32, 1.0, 0.5]).collect();
    let image = EnvironmentImage {
        width: 8,
        height: 4,
        texels,
    };
    Environment {
        radiance: [1.0; 3],
        rotation: 0.0,
        image: Some(image.into()),
    }
}
