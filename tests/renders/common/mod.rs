//! Scenes built in memory, their rendering, and statistics about their pictures.

pub mod builder;
pub mod radiometry;
pub mod statistics;

use std::ops::ControlFlow;
use std::path::PathBuf;
use std::sync::OnceLock;

use etendue::accel::BuildOptions;
use etendue::gpu::{Device, Loads};
use etendue::host::Cache;
use etendue::render::{
    Film, GpuScene, Guidance, Guiding, LightSelection, Prepared, Settings, Stage, train,
};
use etendue::scene::{Scene, gltf};
use etendue::shader::ShaderLibrary;

pub use builder::{SceneBuilder, black, glossy, lambert, lamp, metal};
pub use statistics::{assert_exact, assert_radiance, estimate, estimate_region};

/// The device of all tests; a failure says how to get one.
pub fn device() -> &'static Device {
    static DEVICE: OnceLock<Device> = OnceLock::new();
    DEVICE.get_or_init(|| match Device::open(None) {
        Ok(device) => device,
        Err(error) => panic!("these tests need a Vulkan device: {error}"),
    })
}

/// Renders a scene and insists on what every film has to be: complete and finite.
pub fn render(scene: &Scene, settings: &Settings) -> Film {
    render_with(scene, settings, &BuildOptions::default(), None)
}

/// The same with a structure of another kind, or lights chosen as is wished.
pub fn render_with(
    scene: &Scene,
    settings: &Settings,
    options: &BuildOptions,
    wish: Option<LightSelection>,
) -> Film {
    scene.validate().expect("the test's scene is valid");
    let prepared = Prepared::with_lights(scene, settings.camera, options, wish);
    render_prepared(scene, &prepared.expect("a prepared scene"), settings)
}

/// The same for a scene that has been prepared, and perhaps been changed since.
pub fn render_prepared(scene: &Scene, prepared: &Prepared, settings: &Settings) -> Film {
    on_prepared_stage(scene, prepared, |stage| {
        draw(stage, settings, Guidance::default())
    })
}

/// What `work` gives for a scene on the device.
pub fn on_stage<T>(scene: &Scene, settings: &Settings, work: impl FnOnce(Stage<'_>) -> T) -> T {
    let prepared = Prepared::new(scene, settings.camera, &BuildOptions::default());
    on_prepared_stage(scene, &prepared.expect("a prepared scene"), work)
}

fn on_prepared_stage<T>(
    scene: &Scene,
    prepared: &Prepared,
    work: impl FnOnce(Stage<'_>) -> T,
) -> T {
    let gpu_scene = GpuScene::upload(device(), prepared).expect("room on the device");
    let library = ShaderLibrary::embedded();
    work(Stage {
        device: device(),
        library: &library,
        scene,
        prepared,
        gpu_scene: &gpu_scene,
    })
}

/// Renders a scene by paths that a training pass guides.
pub fn render_guided(scene: &Scene, settings: &Settings) -> Film {
    on_stage(scene, settings, |stage| {
        let training =
            train(stage, &as_used(settings), Guiding::On, &mut |_, _| {}).expect("a training pass");
        let training = training.expect("a training pass");
        assert!(training.guide.is_some());
        draw(stage, settings, training.guidance())
    })
}

/// Renders a scene by paths that may end where they carry less than a threshold.
pub fn render_with_roulette(scene: &Scene, settings: &Settings, threshold: f32) -> Film {
    let guidance = Guidance {
        roulette: Some(threshold),
        ..Guidance::default()
    };
    on_stage(scene, settings, |stage| draw(stage, settings, guidance))
}

/// The settings with what the program would choose for the device.
fn as_used(settings: &Settings) -> Settings {
    static LOADS: OnceLock<Loads> = OnceLock::new();
    let measure = || device().quickest_loads(&Cache::off());
    Settings {
        loads: *LOADS.get_or_init(|| measure().expect("a measurement")),
        ..settings.clone()
    }
}

fn draw(stage: Stage<'_>, settings: &Settings, guidance: Guidance<'_>) -> Film {
    let settings = &as_used(settings);
    let renderer = stage.guided_renderer(settings, guidance);
    let mut renderer = renderer.expect("a compiled shader");
    let flow = renderer
        .render(&mut |_, _| ControlFlow::Continue(()))
        .expect("a render that ends");
    assert!(flow.is_continue());
    let film = renderer.film().expect("a film");
    let spp = settings.spp as u32;
    assert_eq!(film.spp_range(), (spp, spp), "samples are missing");
    assert_eq!(film.non_finite_samples(), 0);
    film
}

/// Settings of a square picture. The independent sampler, since with it the film's variance is an
/// unbiased estimate of the error.
pub fn square(size: u32, spp: u64, max_depth: u32) -> Settings {
    Settings {
        width: size,
        height: size,
        spp,
        max_depth,
        sampler: "independent".into(),
        ..Settings::default()
    }
}

/// The same settings with another integrator.
pub fn with_integrator(settings: &Settings, integrator: &str) -> Settings {
    Settings {
        integrator: integrator.into(),
        ..settings.clone()
    }
}

/// The same settings, paths never ended by roulette.
pub fn without_roulette(settings: &Settings) -> Settings {
    let mut settings = settings.clone();
    let never = f64::from(u16::MAX);
    settings.overrides.push(("ROULETTE_DEPTH".into(), never));
    settings
}

/// Loads `scenes/NAME.gltf`.
pub fn load(name: &str) -> Scene {
    load_path(&root().join("scenes").join(format!("{name}.gltf")))
}

/// Loads a file.
pub fn load_path(path: &std::path::Path) -> Scene {
    match gltf::load(path, &gltf::LoadOptions::default()) {
        Ok(scene) => scene,
        Err(error) => panic!("{error}"),
    }
}

/// The project's folder.
pub fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

/// How many times the usual samples to draw: 16 in a campaign (`ETENDUE_LONG=1`).
pub fn effort() -> u64 {
    match std::env::var("ETENDUE_LONG") {
        Ok(value) if value != "0" => 16,
        _ => 1,
    }
}
