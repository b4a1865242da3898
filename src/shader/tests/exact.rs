//! `NoContraction` is where it should be, and nowhere else.

use std::collections::BTreeSet;

use super::super::spirv::{Instruction, instructions, op};
use super::*;

const TEXT: &str = "@group(0) @binding(0) var<storage, read_write> data: array<vec4f>;\n\
    fn exact_all(a: vec4f, m: mat4x4f, x: f32, n: i32) -> vec4f {\n\
        var r = a + a; r -= a; r *= x; r = r * a; r = r / a; r = -r; r = r % a;\n\
        r = m * r; r = r * m; r = (m * m * x) * r; r.x = r.y * r.z + x - f32(n + n * n);\n\
        return r + fma(r, r, r) + max(r, a);\n}\n\
    fn inexact(a: vec4f) -> vec4f { return a * a + a; }\n\
    fn not_exact_either(a: vec4f) -> vec4f { return a * a + a; }\n\
    @compute @workgroup_size(1) fn main() {\n\
        data[0] = exact_all(data[1], mat4x4f(data[1], data[2], data[3], data[4]), data[5].x, i32(data[6].x))\n\
            + inexact(data[1]) * data[2] + not_exact_either(data[2]);\n}";

fn decorated(kernel: &Compiled) -> BTreeSet<u32> {
    let all = instructions(&kernel.spirv);
    let ours = all.filter(|i| i.opcode == op::DECORATE && i.words[2] == 42);
    ours.map(|i| i.words[1]).collect()
}

/// Opcodes and result ids.
type Operations = Vec<(u16, u32)>;

/// The opcodes of 127..=148 inside and outside functions whose name begins with `exact_`.
fn arithmetic(kernel: &Compiled) -> (Operations, Operations) {
    let names = instructions(&kernel.spirv).filter(|i| i.opcode == op::NAME);
    let exact: BTreeSet<u32> = names
        .filter(|i| i.string(2).starts_with("exact_"))
        .map(|i| i.words[1])
        .collect();
    let mut inside = false;
    let (mut ours, mut others) = (Vec::new(), Vec::new());
    for i in instructions(&kernel.spirv) {
        if i.opcode == op::FUNCTION {
            inside = exact.contains(&i.words[2]);
        }
        if (127..=148).contains(&i.opcode) {
            let list = if inside { &mut ours } else { &mut others };
            list.push((i.opcode, i.words[2]));
        }
    }
    (ours, others)
}

fn is_integer(opcode: u16) -> bool {
    matches!(opcode, 128 | 130 | 132 | 134 | 135 | 137 | 138 | 139)
}

fn kernel(checked: bool) -> Compiled {
    let options = CompileOptions {
        debug_names: true,
        checked,
        ..CompileOptions::default()
    };
    compile_files(&[("main.wgsl", TEXT)], &options).expect("compiles")
}

#[test]
fn exactly_the_float_arithmetic_of_exact_functions() {
    for checked in [false, true] {
        let kernel = kernel(checked);
        let (ours, others) = arithmetic(&kernel);
        let floats: BTreeSet<u32> = ours
            .iter()
            .filter(|(o, _)| !is_integer(*o))
            .map(|(_, id)| *id)
            .collect();
        assert_eq!(decorated(&kernel), floats);
        assert!(others.len() >= 4 && ours.iter().any(|(o, _)| is_integer(*o)));
        let kinds: BTreeSet<u16> = ours.iter().map(|(o, _)| *o).collect();
        for opcode in [127, 129, 131, 133, 136, 142, 143, 144, 145, 146] {
            assert!(
                kinds.contains(&opcode),
                "the test text has no opcode {opcode}"
            );
        }
    }
}

#[test]
fn decorations_stand_in_their_section_once() {
    let kernel = kernel(false);
    let ours = |i: &Instruction<'_>| i.opcode == op::DECORATE && i.words[2] == 42;
    let places: Vec<_> = instructions(&kernel.spirv)
        .filter(ours)
        .map(|i| i.at)
        .collect();
    assert_eq!(places.len(), decorated(&kernel).len());
    let types = instructions(&kernel.spirv)
        .find(|i| (19..=59).contains(&i.opcode))
        .expect("has types");
    assert!(places.iter().all(|at| *at < types.at));
}

#[test]
fn stripped_kernels_keep_the_decorations() {
    let stripped = compile_text(TEXT).expect("compiles");
    assert_eq!(decorated(&stripped), decorated(&kernel(false)));
}

#[test]
fn kernels_without_exact_functions_have_none() {
    let text = TEXT.replace("exact_all", "all_of_it");
    assert!(decorated(&compile_text(&text).expect("compiles")).is_empty());
}

#[test]
fn built_in_functions_that_hide_arithmetic_are_warned_of() {
    let text = "@group(0) @binding(0) var<storage, read_write> d: array<vec3f>;\n\
        fn exact_area(a: vec3f, b: vec3f) -> vec3f {\n    return cross(a, b) * sqrt(dot(a, b));\n}\n\
        @compute @workgroup_size(1) fn main() { d[0] = exact_area(cross(d[1], d[2]), d[3]); }";
    let warnings = compile_text(text).expect("compiles").warnings;
    let places: Vec<_> = warnings
        .iter()
        .filter_map(Diagnostic::location)
        .map(|l| l.to_string())
        .collect();
    assert_eq!(places, ["main.wgsl:3:12", "main.wgsl:3:31"]);
    assert!(
        warnings[0]
            .to_string()
            .starts_with("warning: `cross` in `exact_area`"),
        "{}",
        warnings[0]
    );
}
