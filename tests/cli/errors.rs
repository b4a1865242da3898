//! Bad input and bad usage: exit code 2 (3 for devices), one sentence, before any work is done.

use std::fs;

use crate::common::{etendue, folder, path_in, render, render_scene};

#[test]
fn scenes_that_cannot_be_rendered() {
    let folder = folder();
    let scene = path_in(&folder, "bad.gltf");
    let with = |text: &str| {
        fs::write(&scene, text).expect("a file");
        render_scene(&scene, &["--json", "-"])
    };
    render_scene("no/such/scene.gltf", &["--json", "-"]).refused(&["no/such/scene.gltf"]);
    render_scene("scenes", &["--json", "-"]).refused(&["scenes"]);
    with("").refused(&["bad.gltf"]);
    with("{").refused(&["bad.gltf", "JSON"]);
    with("glTF but not really").refused(&["bad.gltf"]);
    with(r#"{"asset":{"version":"2.0"},"extensionsRequired":["X_y"],"extensionsUsed":["X_y"]}"#)
        .refused(&["bad.gltf", "X_y"]);
    with(r#"{"asset":{"version":"2.0"},"scenes":[{"nodes":[3]}]}"#).refused(&["bad.gltf"]);
}

#[test]
fn names_that_do_not_exist() {
    let refused = |arguments: &[&str], parts: &[&str]| {
        render(&[&["--json", "-"], arguments].concat()).refused(parts);
    };
    refused(
        &["--camera", "7"],
        &["cornell_box.gltf", "no camera 7", "0 \"camera\""],
    );
    refused(&["--camera", "top"], &["no camera \"top\""]);
    refused(&["--scene", "5"], &["cornell_box.gltf", "no scene 5"]);
    refused(
        &["--integrator", "magic"],
        &["no integrator is named \"magic\"", "naive"],
    );
    refused(
        &["--sampler", "magic"],
        &["no sampler is named \"magic\"", "sobol"],
    );
    refused(
        &["--set", "NO_SUCH=1"],
        &["no override `NO_SUCH`", "ROULETTE_DEPTH"],
    );
    refused(&["--set", "ROULETTE_DEPTH=0.5"], &["ROULETTE_DEPTH"]);
    refused(&["--shaders", "no/such/folder"], &["no/such/folder"]);
    let unknown = render(&["--json", "-", "--device", "no such device"]).ends_with(3);
    assert!(
        unknown
            .stderr
            .starts_with("error: no Vulkan device matches")
    );
}

#[test]
fn aovs_are_checked_before_the_picture_is_rendered() {
    let folder = folder();
    let output = path_in(&folder, "a.exr");
    // So many samples that the test would time out if they were drawn first.
    let refused = |aov: &str, parts: &[&str]| {
        render(&["-o", &output, "--spp", "100000000", "--aov", aov]).refused(parts);
    };
    refused("magic", &["--aov", "no integrator is named \"magic\""]);
    let png = path_in(&folder, "a.png");
    render(&["-o", &png, "--aov", "albedo"]).refused(&["--aov", ".exr"]);
    assert!(!folder.path().join("a.exr").exists());
}

#[test]
fn values_out_of_range() {
    let refused = |arguments: &[&str]| {
        render(&[&["--json", "-"], arguments].concat()).refused(&[]);
    };
    for size in ["0x4", "4x0", "4", "axb", "-4x4", "70000x4", "99999999999x1"] {
        refused(&["--size", size]);
    }
    for spp in ["0", "-1", "1.5", "4294967296", "x"] {
        refused(&["--spp", spp]);
    }
    refused(&["--max-depth", "0"]);
    refused(&["--seed", "-1"]);
    refused(&["--exposure", "nan"]);
    refused(&["--tonemap", "magic"]);
    refused(&["--set", "ROULETTE_DEPTH"]);
    refused(&["--set", "ROULETTE_DEPTH=x"]);
    refused(&["--no-such-flag"]);
}

#[test]
fn environments_that_cannot_be_read() {
    let folder = folder();
    let refused = |environment: &str, parts: &[&str]| {
        render(&["--json", "-", "--env", environment]).refused(parts);
    };
    for bad in ["-1", "nan", "1,2", "1,2,3,4", "1e40"] {
        refused(bad, &["--env"]);
    }
    refused("no/such/sky.hdr", &["no/such/sky.hdr"]);
    refused("scenes/furnace.gltf", &["scenes/furnace.gltf", "OpenEXR"]);
    let torn = path_in(&folder, "torn.hdr");
    fs::write(
        &torn,
        "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 90000 +X 90000\n",
    )
    .expect("a file");
    refused(&torn, &["torn.hdr"]);
    render(&["--json", "-", "--env-scale", "2"]).refused(&["--env"]);
    render(&["--json", "-", "--env", "1e38", "--env-scale", "1e9"]).refused(&["--env-scale"]);
}

#[test]
fn outputs_that_cannot_be_written() {
    let folder = folder();
    let file = path_in(&folder, "file");
    fs::write(&file, "").expect("a file");
    let refused = |path: &str, parts: &[&str]| {
        render(&["-o", path, "--spp", "100000000"]).refused(parts);
    };
    refused("picture.jpg", &["picture.jpg", ".exr", ".png"]);
    refused("picture", &["picture", ".exr"]);
    refused(
        &path_in(&folder, "no/such/a.exr"),
        &["no/such/a.exr", "folder"],
    );
    refused(&format!("{file}/a.exr"), &["file/a.exr"]);
    fs::create_dir(folder.path().join("folder.exr")).expect("a folder");
    refused(
        &path_in(&folder, "folder.exr"),
        &["folder.exr", "is a folder"],
    );
    if cfg!(target_os = "linux") {
        // Not even root can make files here.
        refused("/proc/a.exr", &["/proc/a.exr"]);
    }
    render(&[
        "--json",
        &path_in(&folder, "no/report.json"),
        "--spp",
        "100000000",
    ])
    .refused(&["no/report.json"]);
    etendue(&["render", "scenes/furnace.gltf"]).refused(&["nothing to do"]);
}

#[test]
fn outputs_that_would_replace_an_input_or_each_other() {
    let folder = folder();
    let scene = path_in(&folder, "scene.gltf");
    fs::copy("scenes/furnace.gltf", &scene).expect("a scene");
    let before = fs::read(&scene).expect("the scene");
    render_scene(&scene, &["--json", &scene]).refused(&["replace the scene"]);
    assert_eq!(fs::read(&scene).expect("the scene"), before);
    let output = path_in(&folder, "a.exr");
    render(&["-o", &output, "-o", &output]).refused(&["replace another output"]);
    fs::write(&output, "").expect("a file");
    render(&["-o", &output, "--env", &output]).refused(&["replace the environment"]);
}

#[test]
fn usage() {
    let run = etendue::<&str>(&[]);
    assert_eq!(run.code, Some(2));
    for arguments in [
        &["--help"][..],
        &["--version"],
        &["render", "--help"],
        &["info", "-h"],
    ] {
        let run = etendue(arguments).ends_with(0);
        assert!(run.stdout.contains("etendue"), "{}", run.stdout);
    }
    etendue(&["magic"]).refused(&["magic"]);
}

#[test]
fn cameras_that_make_no_sense() {
    let refused = |arguments: &[&str], parts: &[&str]| {
        render(&[&["--json", "-", "--spp", "100000000"], arguments].concat()).refused(parts);
    };
    refused(&["--aperture", "0.1"], &["--focus-distance", "--focus-at"]);
    refused(&["--focus-distance", "2"], &["--aperture"]);
    refused(&["--focus-at", "0.5,0.5"], &["--aperture"]);
    let both = [
        "--aperture",
        "0.1",
        "--focus-distance",
        "2",
        "--focus-at",
        "0.5,0.5",
    ];
    refused(&both, &["cannot be used with"]);
    for (aperture, distance) in [
        ("-1", "2"),
        ("f/0", "2"),
        ("wide", "2"),
        ("0.1", "0"),
        ("0.1", "nan"),
    ] {
        refused(&["--aperture", aperture, "--focus-distance", distance], &[]);
    }
    refused(
        &["--aperture", "0.1", "--focus-at", "2,0"],
        &["between 0 and 1"],
    );
    refused(&["--fov", "180"], &["--fov"]);
    refused(
        &["--view-height", "2"],
        &["--view-height", "--projection orthographic"],
    );
    refused(&["--projection", "orthographic"], &["--view-height METRES"]);
    refused(&["--projection", "panorama", "--fov", "90"], &["--fov"]);
    let lens = ["--aperture", "0.1", "--focus-distance", "2"];
    refused(
        &[&lens[..], &["--projection", "panorama"]].concat(),
        &["a panorama has no lens"],
    );
    let f_number = [
        "--projection",
        "orthographic",
        "--view-height",
        "1",
        "--aperture",
        "f/2",
        "--focus-distance",
        "2",
    ];
    refused(&f_number, &["no f-number"]);
    refused(&["--projection", "fisheye"], &["panorama"]);
    // Above the box there is nothing.
    let far = ["--fov", "120", "--aperture", "0.1", "--focus-at", "0,0"];
    refused(&far, &["--focus-at 0,0: the camera sees no surface there"]);
}
