//! Renders under the Khronos validation layer: it has nothing to say.

use std::ops::ControlFlow;
use std::sync::Arc;

use crate::common::scenes::{add_mesh, emitter, empty_scene};
use etendue::gpu::{Device, Loads, OpenOptions};
use etendue::render::{GpuScene, Prepared, Renderer, Settings};
use etendue::scene::{Environment, EnvironmentImage, Material, Scene};
use etendue::shader::ShaderLibrary;
use glam::Vec3;

/// A floor, a lamp and a picture of a sky.
fn scene() -> Scene {
    let mut scene = empty_scene();
    let floor = [
        [
            Vec3::new(-4.0, -1.0, 0.0),
            Vec3::new(4.0, -1.0, 0.0),
            Vec3::new(4.0, -1.0, -9.0),
        ],
        [
            Vec3::new(-4.0, -1.0, 0.0),
            Vec3::new(4.0, -1.0, -9.0),
            Vec3::new(-4.0, -1.0, -9.0),
        ],
    ];
    let matte = Material {
        metallic: 0.0,
        roughness: 0.4,
        ..Material::default()
    };
    add_mesh(&mut scene, &floor, matte);
    let lamp = [[
        Vec3::new(-1.0, 2.0, -3.0),
        Vec3::new(0.0, 2.0, -5.0),
        Vec3::new(1.0, 2.0, -3.0),
    ]];
    add_mesh(&mut scene, &lamp, emitter(10.0));
    scene.environment = Some(Environment {
        radiance: [0.1; 3],
        rotation: 0.0,
        image: Some(Arc::new(EnvironmentImage {
            width: 4,
            height: 2,
            texels: vec![[1.0, 2.0, 3.0]; 8],
        })),
    });
    scene
}

#[test]
fn a_render_under_the_validation_layer_is_clean() {
    let scene = scene();
    scene.validate().expect("a valid scene");
    let prepared = Prepared::new(&scene, 0, &Default::default()).expect("prepared");
    for (staging, checked, words) in [
        (false, false, false),
        (true, true, false),
        (false, false, true),
    ] {
        let options = OpenOptions {
            validation: true,
            staging,
        };
        let device = Device::open_with(None, options).unwrap_or_else(|error| panic!("{error}"));
        let log = device.validation().expect("the layer is on");
        let gpu_scene = GpuScene::upload(&device, &prepared).expect("uploaded");
        let settings = Settings {
            width: 20,
            height: 12,
            spp: 4,
            checked,
            stats: true,
            loads: if words {
                Loads::default()
            } else {
                Loads::possible(device.info())
            },
            ..Settings::default()
        };
        let library = ShaderLibrary::embedded();
        let mut renderer =
            Renderer::new(&device, &library, &scene, &prepared, &gpu_scene, &settings)
                .unwrap_or_else(|error| panic!("{error}"));
        let finished = renderer.render(&mut |_, _| ControlFlow::Continue(()));
        assert!(finished.expect("rendered").is_continue());
        let film = renderer.film().expect("film");
        assert_eq!(film.samples(), 20 * 12 * 4);
        assert!(film.mean_radiance().iter().all(|c| *c > 0.0));
        drop((renderer, gpu_scene));
        drop(device);
        assert_eq!(log.count(), 0, "{:#?}", log.messages());
    }
}
