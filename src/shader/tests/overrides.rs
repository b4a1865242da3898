//! `override` and `--set`.

use super::super::spirv::instructions;
use super::*;

const TEXT: &str = "override SCALE: f32 = 0.1;\noverride COUNT: u32 = 4;\noverride SHIFT: i32 = -1;\n\
    override ON: bool = true;\noverride AREA = SCALE * 2.0;\n@id(7) override NUMBERED: u32 = 3u;\n\
    override FREE: f32;\noverride UNUSED: f32;\n\
    @group(0) @binding(0) var<storage, read_write> data: array<f32>;\n\
    @compute @workgroup_size(COUNT) fn main() {\n\
        data[NUMBERED] = SCALE + f32(SHIFT) + select(0.0, AREA, ON) + FREE;\n}";

fn set(values: &[(&str, f64)]) -> Result<Compiled, ShaderError> {
    let overrides: Vec<_> = values.iter().map(|(n, v)| ((*n).to_owned(), *v)).collect();
    let options = CompileOptions {
        overrides: &overrides,
        ..CompileOptions::default()
    };
    compile_files(&[("main.wgsl", TEXT)], &options)
}

#[test]
fn values_and_defaults() {
    let compiled = set(&[
        ("FREE", 1.0),
        ("COUNT", 8.0),
        ("COUNT", 16.0),
        ("NUMBERED", 1.0),
    ]);
    let compiled = compiled.expect("compiles");
    assert_eq!(compiled.workgroup_size, [16, 1, 1]);
    let defaults: Vec<_> = compiled
        .overrides
        .iter()
        .map(|o| (o.name.as_str(), o.default))
        .collect();
    let expected = [
        ("SCALE", Some(0.1)),
        ("COUNT", Some(4.0)),
        ("SHIFT", Some(-1.0)),
        ("ON", Some(1.0)),
        ("AREA", None),
        ("NUMBERED", Some(3.0)),
        ("FREE", None),
        ("UNUSED", None),
    ];
    assert_eq!(defaults, expected);
}

/// What does not depend on the order in which constants were made: their values, sorted, and the instructions.
fn kernel(words: &[u32]) -> (Vec<&[u32]>, Vec<u16>) {
    const CONSTANT: u16 = 43;
    let all: Vec<_> = instructions(words).collect();
    let constants = all.iter().filter(|i| i.opcode == CONSTANT);
    let mut values: Vec<_> = constants.map(|i| &i.words[3..]).collect();
    values.sort_unstable();
    let others = all.iter().map(|i| i.opcode).filter(|o| *o != CONSTANT);
    (values, others.collect())
}

#[test]
fn a_value_changes_the_kernel() {
    let words = |values: &[(&str, f64)]| set(values).expect("compiles").spirv;
    let scale = |v: f64| words(&[("FREE", 1.0), ("SCALE", v)]);
    assert_ne!(scale(0.25), scale(0.5));
    assert_eq!(kernel(&scale(0.1)), kernel(&words(&[("FREE", 1.0)])));
    assert!(scale(0.375).contains(&0.375_f32.to_bits()));
}

#[test]
fn unknown_names_list_the_known() {
    let error = set(&[("FREE", 1.0), ("SCAEL", 1.0)]).expect_err("unknown");
    assert!(matches!(error, ShaderError::Override(_)));
    let text = error.to_string();
    assert!(
        text.starts_with("error: the shader has no override `SCAEL`"),
        "{text}"
    );
    assert!(
        text.contains("SCALE = 0.1, COUNT = 4, SHIFT = -1, ON = 1, AREA (no plain default)"),
        "{text}"
    );
    let none = [("X".to_owned(), 1.0)];
    let options = CompileOptions {
        overrides: &none,
        ..CompileOptions::default()
    };
    let text = compile_files(
        &[("main.wgsl", "@compute @workgroup_size(1) fn main() {}")],
        &options,
    );
    assert!(
        text.expect_err("unknown")
            .to_string()
            .contains("has no overrides")
    );
}

#[test]
fn values_outside_the_type() {
    for (name, value, place) in [
        ("COUNT", 1.5, "main.wgsl:2:1"),
        ("COUNT", -1.0, "main.wgsl:2:1"),
        ("COUNT", 4294967296.0, "main.wgsl:2:1"),
        ("SHIFT", -2147483649.0, "main.wgsl:3:1"),
        ("SHIFT", f64::NAN, "main.wgsl:3:1"),
        ("SCALE", f64::INFINITY, "main.wgsl:1:1"),
        ("SCALE", 1e39, "main.wgsl:1:1"),
        ("ON", 2.0, "main.wgsl:4:1"),
    ] {
        let result = set(&[("FREE", 1.0), (name, value)]);
        assert!(
            matches!(result, Err(ShaderError::Override(_))),
            "{name} = {value}"
        );
        assert_eq!(place_of(result), place, "{name} = {value}");
    }
    set(&[("FREE", 1.0), ("COUNT", 0.0)]).expect_err("a workgroup has an invocation");
}

#[test]
fn a_missing_value_is_asked_for_only_where_it_is_used() {
    let result = set(&[("UNUSED", 1.0)]);
    let text = result.as_ref().expect_err("FREE has none").to_string();
    assert!(text.contains("--set FREE=VALUE"), "{text}");
    assert_eq!(place_of(result), "main.wgsl:7:1");
}
