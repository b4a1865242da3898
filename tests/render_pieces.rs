//! No bit of the picture depends on how the work is cut into pieces.

use std::ops::ControlFlow;

use etendue::accel::BuildOptions;
use etendue::gpu::{Device, Loads};
use etendue::render::{Film, GpuScene, Prepared, Renderer, Settings};
use etendue::scene::{Environment, EnvironmentImage, gltf};
use etendue::shader::ShaderLibrary;

fn bits(film: &Film) -> &[u8] {
    bytemuck::cast_slice(&film.pixels)
}

#[test]
fn the_picture_does_not_depend_on_the_pieces() {
    let scene = gltf::load("scenes/foliage.gltf".as_ref(), &Default::default()).expect("a scene");
    let prepared = Prepared::new(&scene, 0, &BuildOptions::default()).expect("a flat scene");
    let device = Device::open(None).expect("a Vulkan device");
    let gpu_scene = GpuScene::upload(&device, &prepared).expect("memory");
    let library = ShaderLibrary::embedded();
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
        let renderer = Renderer::new(&device, &library, &scene, &prepared, &gpu_scene, &settings);
        let mut renderer = renderer.expect("a kernel");
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
    let scene = gltf::load("scenes/cornell_box.gltf".as_ref(), &Default::default());
    let scene = scene.expect("a scene");
    let prepared = Prepared::new(&scene, 0, &BuildOptions::default()).expect("a flat scene");
    let device = Device::open(None).expect("a Vulkan device");
    let gpu_scene = GpuScene::upload(&device, &prepared).expect("memory");
    let library = ShaderLibrary::embedded();
    let render = |piece_tiles, pass_samples, stops| {
        let settings = Settings {
            width: 93,
            height: 75,
            spp: 5,
            piece_tiles: Some(piece_tiles),
            pass_samples: Some(pass_samples),
            ..Settings::default()
        };
        let renderer = Renderer::new(&device, &library, &scene, &prepared, &gpu_scene, &settings);
        let mut renderer = renderer.expect("a kernel");
        if stops {
            let flow = renderer.render(&mut |_, _| ControlFlow::Break(()));
            assert!(flow.expect("a first piece").is_break());
        }
        let flow = renderer.render(&mut |_, _| ControlFlow::Continue(()));
        assert!(flow.expect("a render").is_continue());
        renderer.film().expect("a film")
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
    let device = Device::open(None).expect("a Vulkan device");
    let possible = Loads::possible(device.info());
    let library = ShaderLibrary::embedded();
    // A tree, textures and many lamps; a list; many materials; and an environment.
    for name in ["many_lights", "foliage", "cornell_box", "sphere_grid"] {
        let path = format!("scenes/{name}.gltf");
        let mut scene = gltf::load(path.as_ref(), &Default::default()).expect("a scene");
        if name == "foliage" {
            scene.environment = Some(sky());
        }
        let prepared = Prepared::new(&scene, 0, &BuildOptions::default()).expect("a flat scene");
        let gpu_scene = GpuScene::upload(&device, &prepared).expect("memory");
        let render = |doublewords, texels| {
            let settings = Settings {
                width: 45,
                height: 27,
                spp: 3,
                stats: true,
                loads: Loads {
                    doublewords,
                    texels,
                },
                ..Settings::default()
            };
            let renderer =
                Renderer::new(&device, &library, &scene, &prepared, &gpu_scene, &settings);
            let mut renderer = renderer.expect("a kernel");
            let flow = renderer.render(&mut |_, _| ControlFlow::Continue(()));
            assert!(flow.expect("a render").is_continue());
            let declares = |text| renderer.wgsl().contains(text);
            assert_eq!(declares("film: array<u64>"), doublewords, "{name}");
            assert_eq!(declares("texture_storage_1d"), texels, "{name}");
            bits(&renderer.film().expect("a film")).to_vec()
        };
        let words = render(false, false);
        if possible.doublewords {
            assert_eq!(render(true, false), words, "{name}");
        }
        if possible.texels {
            assert_eq!(render(false, true), words, "{name}");
        }
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
