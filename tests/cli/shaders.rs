//! Shaders that people edit: `etendue shaders` and `--shaders`.

use std::fs;

use crate::common::{etendue, exported, path_in, render, text};

#[test]
fn the_built_in_shaders_are_listed_and_compile() {
    let list = etendue(&["shaders", "list"]).ends_with(0);
    assert!(list.stdout.lines().any(|l| l == "integrator/path.wgsl"));
    let check = etendue(&["shaders", "check"]).ends_with(0);
    assert!(
        check.stdout.ends_with("kernels compile\n"),
        "{}",
        check.stdout
    );
    assert_eq!(check.stderr, "");
}

#[test]
fn exported_shaders_render_the_same_picture() {
    let (folder, shaders) = exported();
    let pixels = |name: &str, arguments: &[&str]| {
        let path = path_in(&folder, name);
        render(&[&["-o", path.as_str()], arguments].concat()).ends_with(0);
        etendue::image::exr::read(path).expect("a readable EXR").0
    };
    let own = pixels("a.exr", &["--shaders", &text(&shaders)]);
    assert_eq!(own, pixels("b.exr", &[]));
}

#[test]
fn export_replaces_no_edited_file() {
    let (_folder, shaders) = exported();
    let edited = shaders.join("integrator/ao.wgsl");
    fs::write(&edited, "// mine\n").expect("a file");
    etendue(&["shaders", "export", &text(&shaders)]).refused(&["ao.wgsl"]);
    assert_eq!(fs::read_to_string(edited).expect("the file"), "// mine\n");
}

#[test]
fn a_mistake_is_shown_with_file_line_column_and_caret() {
    let (folder, shaders) = exported();
    let edited = shaders.join("integrator/albedo.wgsl");
    let source = fs::read_to_string(&edited).expect("a shader");
    let broken = source.replace("return vec3f(0.0);", "return vec3f(0.0) + nonsense;");
    assert_ne!(source, broken);
    fs::write(&edited, &broken).expect("a file");
    let line = broken
        .lines()
        .position(|l| l.contains("nonsense"))
        .expect("it")
        + 1;
    let column = broken
        .lines()
        .nth(line - 1)
        .and_then(|l| l.find("nonsense"))
        .expect("it")
        + 1;
    let place = format!("albedo.wgsl:{line}:{column}");
    let parts = [place.as_str(), "return vec3f(0.0) + nonsense;", "^"];

    let shaders = text(&shaders);
    let own = [
        "--shaders",
        shaders.as_str(),
        "--integrator",
        "albedo",
        "--json",
        "-",
    ];
    render(&own).refused(&parts);

    // As an AOV it is found before a picture of many samples is rendered.
    let output = path_in(&folder, "a.exr");
    let aov = [
        "--shaders",
        &shaders,
        "--aov",
        "albedo",
        "-o",
        &output,
        "--spp",
        "100000000",
    ];
    render(&aov).refused(&parts);

    // The verdict of a check is no, and each mistake is said once.
    let check = etendue(&["shaders", "check", "--shaders", &shaders]).ends_with(1);
    assert_eq!(
        check.stderr.matches("error: ").count(),
        1,
        "{}",
        check.stderr
    );
    assert!(check.stderr.contains(&place), "{}", check.stderr);
    assert!(check.stdout.contains("do not compile"), "{}", check.stdout);
}

#[test]
fn a_struct_that_differs_from_the_host_s_is_refused() {
    let (_folder, shaders) = exported();
    let edited = shaders.join("types.wgsl");
    let source = fs::read_to_string(&edited).expect("a shader");
    let broken = source.replacen(
        "struct FilmPixel {",
        "struct FilmPixel {\n    mine: vec4f,",
        1,
    );
    assert_ne!(source, broken);
    fs::write(&edited, broken).expect("a file");
    render(&["--shaders", &text(&shaders), "--json", "-"]).refused(&["FilmPixel", "types.wgsl"]);
}

#[test]
fn what_the_host_could_not_run_is_refused() {
    let (_folder, shaders) = exported();
    let refuses = |file: &str, change: [&str; 2], parts: &[&str]| {
        let edited = shaders.join(file);
        let source = fs::read_to_string(&edited).expect("a shader");
        let broken = source.replacen(change[0], change[1], 1);
        assert_ne!(source, broken);
        fs::write(&edited, broken).expect("a file");
        render(&["--shaders", &text(&shaders), "--json", "-"]).refused(parts);
        fs::write(&edited, source).expect("a file");
    };
    let size = ["@workgroup_size(64", "@workgroup_size(32"];
    refuses("main.wgsl", size, &["workgroup_size(32", "64"]);
    let group = ["@group(0) @binding(0)", "@group(1) @binding(0)"];
    refuses("bindings.wgsl", group, &["group 1", "frame"]);
}

#[test]
fn a_new_integrator_is_a_file() {
    let (_folder, shaders) = exported();
    let source = "#include \"surface.wgsl\"\n#include \"sampler.wgsl\"\n\n\
                  override BRIGHTNESS: f32 = 0.25;\n\n\
                  fn Li(camera_ray: Ray, sampler: ptr<function, Sampler>) -> vec3f {\n    \
                  return vec3f(BRIGHTNESS);\n}\n";
    fs::write(shaders.join("integrator/flat.wgsl"), source).expect("a file");
    let shaders = text(&shaders);
    let mean = |arguments: &[&str]| {
        let own = ["--shaders", &shaders, "--integrator", "flat", "--json", "-"];
        let run = render(&[&own, arguments].concat()).ends_with(0);
        run.json()["mean_radiance"][1].as_f64()
    };
    assert_eq!(mean(&[]), Some(0.25));
    assert_eq!(mean(&["--set", "BRIGHTNESS=2"]), Some(2.0));
}

#[test]
fn samples_that_are_not_finite_are_counted_and_said() {
    let (_folder, shaders) = exported();
    let source = "#include \"surface.wgsl\"\n#include \"sampler.wgsl\"\n\n\
                  fn Li(camera_ray: Ray, sampler: ptr<function, Sampler>) -> vec3f {\n    \
                  return vec3f(1.0) / max(camera_ray.direction.x - 2.0, 0.0);\n}\n";
    fs::write(shaders.join("integrator/infinite.wgsl"), source).expect("a file");
    let shaders = text(&shaders);
    let own = [
        "--shaders",
        &shaders,
        "--integrator",
        "infinite",
        "--json",
        "-",
    ];
    let run = render(&own).ends_with(0);
    assert_eq!(run.json()["non_finite_samples"], 16 * 12 * 4);
    assert!(
        run.stderr.starts_with("warning: 768 of 768 samples"),
        "{}",
        run.stderr
    );
}

#[test]
fn a_folder_without_shaders_is_refused() {
    let empty = crate::common::folder();
    let folder = text(empty.path());
    etendue(&["shaders", "check", "--shaders", &folder]).refused(&["integrator"]);
    render(&["--shaders", &folder, "--json", "-"]).refused(&["integrator"]);
}
