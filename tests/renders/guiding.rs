//! The training pass: what it depends on, and when it guides paths.

use crate::common::{device, load, on_stage, square, with_integrator};
use etendue::gpu::Buffer;
use etendue::render::{Guiding, Settings, Training, train};
use etendue::scene::{Environment, EnvironmentImage, Scene};

/// What comes of training for a scene, with the words of the guide.
fn train_for(scene: &Scene, settings: &Settings, guiding: Guiding) -> Option<(Training, Vec<u32>)> {
    let training = on_stage(scene, settings, |stage| {
        train(stage, settings, guiding, &mut |_, _| {})
    });
    let training = training.expect("a training pass")?;
    let words = |guide: &Buffer| device().read(guide, 0, guide.bytes() / 4).expect("words");
    let words = training.guide.as_ref().map_or(Vec::new(), words);
    Some((training, words))
}

#[test]
fn parts_of_a_render_have_the_same_guide() {
    let scene = load("cornell_box");
    let whole = square(64, 64, 8);
    let part = Settings {
        spp: 3,
        first_sample: 61,
        seed: 5,
        stats: true,
        piece_tiles: Some(1),
        pass_samples: Some(1),
        ..whole.clone()
    };
    let (training, words) = train_for(&scene, &whole, Guiding::On).expect("a guide");
    let (again, words_again) = train_for(&scene, &part, Guiding::On).expect("a guide");
    assert!(words.len() > 10_000 && words == words_again);
    assert_eq!(training.forecast, again.forecast);
    assert!(
        training.effort.roulette.is_some() && training.effort.roulette == again.effort.roulette
    );
}

#[test]
fn paths_are_guided_where_that_is_forecast_to_pay() {
    let auto = |name: &str, settings: &Settings| {
        let found = train_for(&load(name), settings, Guiding::Auto);
        found.map(|(training, _)| (training.guide.is_some(), training.forecast))
    };
    let settings = square(256, 16, 8);
    let (used, forecast) = auto("cornell_box", &settings).expect("a try");
    assert!(
        used && (0.3..0.8).contains(&forecast.expect("a forecast")),
        "{forecast:?}"
    );
    // The same light from everywhere: there is nothing to learn but noise.
    let (used, forecast) = auto("furnace", &settings).expect("a try");
    assert!(!used && forecast.expect("a forecast") > 1.0, "{forecast:?}");
    // Too small a picture, too few samples, direct light alone, an integrator without paths.
    let small = Settings {
        width: 255,
        ..settings.clone()
    };
    let short = Settings {
        spp: 3,
        ..settings.clone()
    };
    let direct = Settings {
        max_depth: 2,
        ..settings.clone()
    };
    for untried in [
        small,
        short,
        direct,
        with_integrator(&settings, "ao"),
        with_integrator(&settings, "naive"),
    ] {
        assert!(auto("cornell_box", &untried).is_none());
    }
    assert!(train_for(&load("cornell_box"), &settings, Guiding::Off).is_none());
}

#[test]
fn paths_end_by_a_threshold_that_was_learnt() {
    let learnt = |name: &str, settings: &Settings| {
        let found = train_for(&load(name), settings, Guiding::On);
        found.and_then(|(training, _)| training.effort.roulette)
    };
    let settings = square(128, 16, 8);
    let roulette = learnt("cornell_box", &settings).expect("a threshold");
    assert!(
        (0.05..0.5).contains(&roulette.threshold) && roulette.forecast < 0.95,
        "{roulette:?}"
    );
    // A user who says how paths end is right.
    for name in ["ROULETTE_DEPTH", "ROULETTE_MAX_SURVIVAL"] {
        let own = Settings {
            overrides: vec![(name.into(), 1.0)],
            ..settings.clone()
        };
        assert_eq!(learnt("cornell_box", &own), None);
    }
}

/// Spheres under a sky of which one quarter is bright, and mostly behind other spheres.
fn outdoors() -> Scene {
    let mut scene = load("sphere_grid");
    let (width, height) = (16, 8);
    let texel = |i: usize| match (i % width, i / width) {
        (4..8, 1..4) => [3.0; 3],
        _ => [0.2; 3],
    };
    let texels = (0..width * height).map(texel).collect();
    let image = EnvironmentImage {
        width,
        height,
        texels,
    };
    scene.environment = Some(Environment {
        radiance: [1.0; 3],
        rotation: 0.0,
        image: Some(image.into()),
    });
    scene
}

#[test]
fn light_samples_are_as_many_as_pay() {
    let learnt = |scene: &Scene, settings: &Settings| {
        let found = train_for(scene, settings, Guiding::Auto);
        found.expect("a try").0.effort.light_samples
    };
    let settings = square(256, 16, 8);
    let found = learnt(&outdoors(), &settings).expect("more than one");
    assert!(found.count > 1 && found.forecast < 0.9, "{found:?}");
    // Light from further on is most of the noise.
    assert_eq!(learnt(&load("cornell_box"), &settings), None);
    let own = Settings {
        overrides: vec![("FIRST_LIGHT_SAMPLES".into(), 3.0)],
        ..settings.clone()
    };
    assert_eq!(learnt(&outdoors(), &own), None);
}
