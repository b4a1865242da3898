//! `etendue render`: pictures, layers and metadata.

use std::path::Path;

use crate::common::{folder, path_in, render, render_scene};
use etendue::image::{Metadata, Picture, exr};
use serde_json::Value;

#[test]
fn pictures_have_the_size_layers_and_metadata_that_were_asked_for() {
    let folder = folder();
    let (exr_path, png_path) = (path_in(&folder, "it's.exr"), path_in(&folder, "a.png"));
    let run = render(&[
        "-o",
        &exr_path,
        "-o",
        &png_path,
        "--aov",
        "albedo,normals,depth,variance",
        "--seed",
        "7",
        "--set",
        "ROULETTE_DEPTH=3",
        "--set",
        "AO_DISTANCE=2",
        "--aov",
        "ao",
        "--env",
        "0.5,0.25,0.125",
        "--env-rotation",
        "-90",
        "--env-scale",
        "2",
    ])
    .ends_with(0);
    assert_eq!((run.stdout.as_str(), run.stderr.as_str()), ("", ""));

    let (picture, metadata) = exr::read(Path::new(&exr_path)).expect("a readable EXR");
    assert_eq!((picture.width, picture.height), (16, 12));
    let layers: Vec<_> = picture.layers.iter().map(|l| l.name.as_str()).collect();
    assert_eq!(layers, ["", "albedo", "ao", "depth", "normals", "variance"]);
    for layer in &picture.layers {
        let [r, _, _] = layer.rgb().expect("colour");
        assert!(r.iter().any(|x| *x != 0.0), "layer {} is black", layer.name);
    }
    let entry = |key: &str| {
        metadata
            .0
            .get(&format!("etendue.{key}"))
            .map_or("", String::as_str)
    };
    assert_eq!(entry("spp"), "4");
    assert_eq!(entry("seed"), "7");
    assert_eq!(entry("size"), "16x12");
    assert_eq!(entry("integrator"), "path");
    assert_eq!(entry("sampler"), "sobol");
    assert_eq!(entry("max_depth"), "8");
    assert_eq!(entry("version"), env!("CARGO_PKG_VERSION"));
    assert_eq!(entry("overrides"), "ROULETTE_DEPTH=3 AO_DISTANCE=2");
    assert_eq!(entry("environment"), "0.5,0.25,0.125");
    assert_eq!(entry("environment_rotation"), "-90");
    assert_eq!(entry("environment_scale"), "2");
    assert_eq!(entry("scene_hash").len(), 64);
    for key in ["device", "driver", "camera", "shader_hash"] {
        assert_ne!(entry(key), "", "{key}");
    }
    assert!(
        entry("command").contains(r"it'\''s.exr"),
        "{}",
        entry("command")
    );

    let png = image::open(&png_path).expect("a readable PNG");
    assert_eq!((png.width(), png.height()), (16, 12));
}

#[test]
fn a_scene_without_light_is_warned_of() {
    let folder = folder();
    let scene = empty_scene(&folder);
    let run = render_scene(&scene, &["--json", "-"]).ends_with(0);
    assert_eq!(run.stderr.lines().count(), 1, "{}", run.stderr);
    assert!(run.stderr.starts_with("warning: the scene has no light"));
    assert!(run.stderr.contains("--env 1"), "{}", run.stderr);
    assert_eq!(run.json()["warnings"].as_array().map(Vec::len), Some(1));
    assert_eq!(run.json()["mean_radiance"][0], 0.0);

    let quiet = render_scene(&scene, &["--json", "-", "--quiet"]).ends_with(0);
    assert_eq!(quiet.stderr, "");
    assert_eq!(quiet.json()["warnings"].as_array().map(Vec::len), Some(1));

    let lit = render_scene(&scene, &["--json", "-", "--env", "1"]).ends_with(0);
    assert_eq!(lit.stderr, "");
    assert_eq!(lit.json()["mean_radiance"][0], 1.0);
}

/// A file of a scene in which there is nothing.
fn empty_scene(folder: &tempfile::TempDir) -> String {
    let scene = path_in(folder, "empty.gltf");
    let text = r#"{"asset":{"version":"2.0"},"scene":0,"scenes":[{}]}"#;
    std::fs::write(&scene, text).expect("a file");
    scene
}

#[test]
fn an_environment_may_be_a_picture() {
    let folder = folder();
    let (scene, sky) = (empty_scene(&folder), path_in(&folder, "sky.exr"));
    let texels: Vec<f32> = [1.0, 2.0, f32::NAN].repeat(4 * 2);
    let picture = Picture::new(4, 2).with_rgb("", &texels);
    exr::write(&sky, &picture, &Metadata::default()).expect("a picture");
    let arguments = ["--env", &sky, "--env-scale", "0.5", "--json", "-"];
    let run = render_scene(&scene, &arguments).ends_with(0);
    assert_eq!(
        run.json()["mean_radiance"],
        serde_json::json!([0.5, 1.0, 0.0])
    );
    assert!(run.stderr.contains("8 texels"), "{}", run.stderr);
}

#[test]
fn exposure_and_tone_map_shape_the_png_alone() {
    let folder = folder();
    let (scene, png, exr_path) = (
        empty_scene(&folder),
        path_in(&folder, "a.png"),
        path_in(&folder, "a.exr"),
    );
    let outputs = ["-o", &png, "-o", &exr_path, "--env", "0.25"];
    let first_pixel = |arguments: &[&str]| {
        render_scene(&scene, &[&outputs, arguments].concat()).ends_with(0);
        let (picture, _) = exr::read(&exr_path).expect("a readable EXR");
        assert_eq!(picture.interleaved_rgb("").expect("colour")[0], 0.25);
        image::open(&png).expect("a readable PNG").into_rgb8()[(0, 0)].0
    };
    // The sRGB curve at 0.25 and at 0.5.
    assert_eq!(first_pixel(&["--tonemap", "none"]), [137; 3]);
    assert_eq!(
        first_pixel(&["--tonemap", "none", "--exposure", "1"]),
        [188; 3]
    );
    assert_ne!(first_pixel(&["--tonemap", "agx"]), [137; 3]);
}

#[test]
fn the_default_size_follows_the_camera() {
    let arguments = [
        "render",
        "scenes/many_lights.gltf",
        "--spp",
        "1",
        "--json",
        "-",
    ];
    let wide = [&arguments[..], &["--integrator", "normals"]].concat();
    let report = crate::common::etendue(&wide).ends_with(0).json();
    assert_eq!(
        (&report["width"], &report["height"]),
        (&512.into(), &341.into())
    );
}

#[test]
fn print_wgsl_prints_the_shader_and_renders_nothing() {
    let run = render(&["--print-wgsl"]).ends_with(0);
    assert!(run.stdout.contains("@compute"), "{}", run.stdout);
    assert!(!run.stdout.lines().any(|line| line.starts_with("#include")));
    assert!(run.stdout.contains("const HAS_ENVIRONMENT: bool = false;"));
    assert_eq!(run.stderr, "");
}

#[test]
fn the_spirv_is_written_and_nothing_is_rendered() {
    let folder = folder();
    let path = path_in(&folder, "kernel.spv");
    let run = render(&["--spirv", &path]).ends_with(0);
    assert_eq!((run.stdout.as_str(), run.stderr.as_str()), ("", ""));
    let bytes = std::fs::read(&path).expect("a file");
    assert_eq!(bytes[..4], 0x0723_0203_u32.to_ne_bytes());
    let name = b"trace_on";
    assert!(bytes.windows(name.len()).any(|part| part == name));
}

#[test]
fn the_moment_of_an_animation_is_told_with_the_picture() {
    let folder = folder();
    let scene = crate::common::moving(&folder);
    let path = path_in(&folder, "a.exr");
    let arguments = [
        "--at",
        "0.5",
        "--integrator",
        "albedo",
        "-o",
        &path,
        "--json",
        "-",
    ];
    let report = render_scene(&scene, &arguments).ends_with(0).json();
    assert_eq!(report["animation"], "0 \"slide\" at 0.5 s");
    let (_, metadata) = exr::read(Path::new(&path)).expect("a readable EXR");
    assert_eq!(metadata.0["etendue.animation"], "0 \"slide\" at 0.5 s");
    let report = render_scene(
        &scene,
        &["-q", "--integrator", "albedo", "-o", &path, "--json", "-"],
    );
    assert!(report.ends_with(0).json()["animation"].is_null());
}

#[test]
fn the_same_command_gives_the_same_bits() {
    let folder = folder();
    let pixels = |name: &str, seed: &str, checked: bool| {
        let path = path_in(&folder, name);
        let mut arguments = vec!["-o", &path, "--seed", seed];
        arguments.extend(checked.then_some("--checked"));
        render(&arguments).ends_with(0);
        exr::read(Path::new(&path)).expect("a readable EXR").0
    };
    let first = pixels("a.exr", "1", false);
    assert_eq!(first, pixels("b.exr", "1", false));
    assert_eq!(
        first,
        pixels("c.exr", "1", true),
        "bounds checks change no bit"
    );
    assert_ne!(first, pixels("d.exr", "2", false));
}

#[test]
fn the_device_may_come_from_the_environment() {
    let arguments = [
        "render",
        "scenes/furnace.gltf",
        "--size",
        "4x4",
        "--spp",
        "1",
        "--json",
        "-",
    ];
    let run = |device: &str| {
        let mut command = crate::common::command(&arguments);
        let child = command.env("ETENDUE_DEVICE", device).spawn();
        crate::common::finish(child.expect("the program starts"))
    };
    run("0").ends_with(0);
    run("").ends_with(0);
    let unknown = run("no such device").ends_with(3);
    assert!(
        unknown
            .stderr
            .starts_with("error: no Vulkan device matches")
    );
}

#[test]
fn cameras_have_lenses_and_other_projections() {
    let folder = folder();
    let picture = |name: &str, arguments: &[&str]| {
        let path = path_in(&folder, name);
        let run = render(&[arguments, &["-o", &path, "--json", "-"]].concat()).ends_with(0);
        let (picture, metadata) = exr::read(Path::new(&path)).expect("a readable EXR");
        (picture, metadata, run.json())
    };
    let (plain, ..) = picture("plain.exr", &[]);
    let (pinhole, _, report) = picture(
        "pinhole.exr",
        &["--aperture", "0", "--focus-distance", "inf"],
    );
    assert_eq!(plain, pinhole, "a lens of no size is none");
    assert_eq!(
        (&report["lens_radius"], &report["focus_distance"]),
        (&0.0.into(), &Value::Null)
    );

    // The middle of the back wall.
    let (at, metadata, report) =
        picture("at.exr", &["--aperture", "f/0.05", "--focus-at", "0.5,0.5"]);
    let distance = report["focus_distance"].as_f64().expect("a distance");
    let radius = report["lens_radius"].as_f64().expect("a radius");
    assert!(radius > 0.0 && distance > 0.0);
    assert_eq!(metadata.0["etendue.focus_distance"], distance.to_string());
    let (same, ..) = picture(
        "same.exr",
        &[
            "--aperture",
            &radius.to_string(),
            "--focus-distance",
            &distance.to_string(),
        ],
    );
    assert_eq!(at, same);
    assert_ne!(at, plain);

    let (wide, ..) = picture("wide.exr", &["--fov", "90"]);
    assert_ne!(wide, plain);
    let (flat, ..) = picture(
        "flat.exr",
        &["--projection", "orthographic", "--view-height", "2"],
    );
    assert_ne!(flat, plain);
    let path = path_in(&folder, "sphere.exr");
    let sky = [
        "render",
        "scenes/furnace.gltf",
        "--spp",
        "1",
        "--projection",
        "panorama",
        "-o",
        &path,
    ];
    crate::common::etendue(&sky).ends_with(0);
    let (sphere, _) = exr::read(Path::new(&path)).expect("a readable EXR");
    assert_eq!((sphere.width, sphere.height), (512, 256));
}
