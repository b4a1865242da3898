//! Every integrator with every sampler compiles for every feature set that matters: all features
//! off, all on, and each alone and each missing. No device is needed. Where `spirv-val` is
//! installed, it must accept the result (naga's validator does not catch everything).

use std::io::Write;
use std::process::{Command, Stdio};

use etendue::render::Settings;
use etendue::render::layout::layouts;
use etendue::render::program::{self, Constant};
use etendue::render::shader_check;
use etendue::shader::{Compiled, ShaderLibrary, check_all};

#[test]
fn all_integrators_and_samplers_compile() {
    let library = ShaderLibrary::embedded();
    let layouts = layouts();
    let checks = shader_check::checks(&library, &layouts).expect("integrators and samplers");
    for checked in check_all(&library, &checks) {
        let compiled = checked.result;
        let compiled = compiled.unwrap_or_else(|e| panic!("{}:\n{}", checked.name, e.report()));
        spirv_val(&compiled);
    }
}

#[test]
fn each_feature_alone_and_each_missing_compiles() {
    let library = ShaderLibrary::embedded();
    let settings = Settings::default();
    for base in shader_check::variants() {
        for i in 0..base.constants.len() {
            let mut variant = base.clone();
            let (name, constant) = &mut variant.constants[i];
            if let Constant::Bool(value) = constant {
                *value = !*value;
                let change = format!("{}, but {name} = {value}", base.name);
                let files = shader_check::virtual_files(&library, &settings, &variant)
                    .expect("known names");
                let built = program::build(&library, &files, &settings);
                built.unwrap_or_else(|e| panic!("{change}:\n{e}"));
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
