//! Every integrator with every sampler compiles for every feature set that matters: all features
//! off, all on, and each alone and each missing. No device is needed. Where `spirv-val` is
//! installed, it must accept the result (naga's validator does not catch everything).

use std::io::Write;
use std::process::{Command, Stdio};

use etendue::render::Settings;
use etendue::render::layout::layouts;
use etendue::render::paged_wgsl;
use etendue::render::program::{self, Constant, feature_constants};
use etendue::scene::Features;
use etendue::shader::{CompileOptions, Compiled, ShaderLibrary, VirtualFiles, compile, compose};

/// Constants beside those of the scene's features, as a scene with everything has them.
fn other_constants(on: bool, pages_counted: bool) -> Vec<(&'static str, Constant)> {
    vec![
        ("HAS_LIGHT_TRIANGLES", Constant::Bool(on)),
        ("HAS_PUNCTUAL_LIGHTS", Constant::Bool(on)),
        ("HAS_ENVIRONMENT", Constant::Bool(on)),
        ("HAS_ENVIRONMENT_IMAGE", Constant::Bool(on)),
        ("VERTEX_STRIDE", Constant::U32(if on { 15 } else { 0 })),
        ("NORMAL_OFFSET", Constant::U32(0)),
        ("TANGENT_OFFSET", Constant::U32(3)),
        ("UV0_OFFSET", Constant::U32(7)),
        ("UV1_OFFSET", Constant::U32(9)),
        ("COLOR_OFFSET", Constant::U32(11)),
        ("STACK_SIZE", Constant::U32(if on { 64 } else { 1 })),
        ("COUNT_STEPS", Constant::Bool(pages_counted)),
        ("COUNT_RAYS", Constant::Bool(pages_counted)),
    ]
}

fn buffers(pages: usize) -> String {
    [
        ("nodes", "BvhNode", "load_node"),
        ("triangles", "Triangle", "load_triangle"),
        ("indices", "u32", "load_index"),
        ("vertex_words", "f32", "load_vertex_word"),
        ("texel_words", "u32", "load_texel_word"),
        ("environment_texels", "vec4f", "load_environment_texel"),
        ("environment_alias", "vec2u", "load_environment_alias"),
    ]
    .iter()
    .enumerate()
    .map(|(i, (name, element, accessor))| {
        paged_wgsl(name, element, accessor, pages, 20, 16 + (i * pages) as u32)
    })
    .collect()
}

fn build(
    integrator: &str,
    sampler: &str,
    constants: &[(&'static str, Constant)],
    pages: usize,
    checked: bool,
) -> Compiled {
    let library = ShaderLibrary::embedded();
    let settings = Settings {
        integrator: integrator.into(),
        sampler: sampler.into(),
        checked,
        ..Settings::default()
    };
    let mut files: VirtualFiles = program::choice_files(&library, &settings).expect("known names");
    files.insert("features.wgsl".into(), program::features_wgsl(constants));
    files.insert("buffers.wgsl".into(), buffers(pages));
    let composed =
        compose(&library, &files, "main.wgsl").unwrap_or_else(|e| panic!("{}", e.report()));
    let options = CompileOptions {
        checked,
        layouts: &layouts(),
        ..CompileOptions::default()
    };
    compile(&composed, &options)
        .unwrap_or_else(|e| panic!("{integrator}, {sampler}:\n{}", e.report()))
}

fn with_features(on: bool) -> Vec<(&'static str, Constant)> {
    let mut constants = feature_constants(&Features::default());
    for (_, value) in &mut constants {
        *value = Constant::Bool(on);
    }
    constants.extend(other_constants(on, on));
    constants
}

#[test]
fn all_integrators_and_samplers_compile() {
    let library = ShaderLibrary::embedded();
    for integrator in library.names_in("integrator") {
        for sampler in library.names_in("sampler") {
            for on in [false, true] {
                let plain = build(&integrator, &sampler, &with_features(on), 1, false);
                let checked = build(&integrator, &sampler, &with_features(on), 3, true);
                spirv_val(&plain);
                spirv_val(&checked);
            }
        }
    }
}

#[test]
fn each_feature_alone_and_each_missing_compiles() {
    for on in [false, true] {
        let base = with_features(on);
        for i in 0..base.len() {
            let mut constants = base.clone();
            if let Constant::Bool(value) = &mut constants[i].1 {
                *value = !*value;
                build("path", "sobol", &constants, 1, false);
            }
        }
    }
}

fn spirv_val(compiled: &Compiled) {
    let child = Command::new("spirv-val")
        .args(["--target-env", "vulkan1.1", "-"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn();
    let mut child =
        child.expect("spirv-val is not installed: apt-get install spirv-tools, or run tools/test");
    let bytes: Vec<u8> = compiled
        .spirv
        .iter()
        .flat_map(|w| w.to_le_bytes())
        .collect();
    child
        .stdin
        .take()
        .expect("a pipe")
        .write_all(&bytes)
        .expect("spirv-val reads");
    let output = child.wait_with_output().expect("spirv-val ends");
    assert!(
        output.status.success(),
        "spirv-val: {}{}",
        String::from_utf8_lossy(&output.stdout),
        String::from_utf8_lossy(&output.stderr)
    );
}
