//! What a compiled kernel tells about itself.

use super::super::spirv::{instructions, op};
use super::*;

const TEXT: &str = "struct P { a: vec4f }\n\
    @group(0) @binding(3) var<uniform> params: P;\n\
    @group(0) @binding(1) var<storage, read> input: array<vec4f>;\n\
    @group(0) @binding(0) var<storage, read_write> output: array<vec4f>;\n\
    @group(0) @binding(2) var<storage, read> unused: array<vec4f>;\n\
    var<workgroup> shared_rows: array<vec4f, 64>;\n\
    fn never() -> vec4f { return unused[0]; }\n\
    @compute @workgroup_size(8, 4, 2)\n\
    fn main(@builtin(global_invocation_id) id: vec3u, @builtin(local_invocation_index) lane: u32) {\n\
        shared_rows[lane] = input[id.x / id.y];\n\
        for (var i = 0u; i < id.z; i++) { shared_rows[lane] += params.a; }\n\
        output[id.x] = shared_rows[lane];\n}\n\
    @compute @workgroup_size(1) fn other() { output[0] = never(); }";

fn compiled(options: &CompileOptions) -> Compiled {
    compile_files(&[("main.wgsl", TEXT)], options).expect("compiles")
}

#[test]
fn reflection_is_of_the_entry_point_alone() {
    let kernel = compiled(&CompileOptions::default());
    let bindings: Vec<_> = kernel
        .bindings
        .iter()
        .map(|b| (b.binding, b.name.as_str(), b.kind))
        .collect();
    let expected = [
        (0, "output", BindingKind::StorageReadWrite),
        (1, "input", BindingKind::StorageRead),
        (3, "params", BindingKind::Uniform),
    ];
    assert_eq!(bindings, expected);
    assert_eq!(
        (kernel.workgroup_size, kernel.entry_point.as_str()),
        ([8, 4, 2], "main")
    );
    let other = compiled(&CompileOptions {
        entry_point: "other",
        ..CompileOptions::default()
    });
    assert_eq!(
        other.bindings.iter().map(|b| b.binding).collect::<Vec<_>>(),
        [0, 2]
    );
}

#[test]
fn spirv_is_1_3_and_names_are_optional() {
    let count = |kernel: &Compiled| {
        instructions(&kernel.spirv)
            .filter(|i| i.opcode == op::NAME)
            .count()
    };
    let release = compiled(&CompileOptions::default());
    assert_eq!(release.spirv[..2], [0x0723_0203, 0x0001_0300]);
    assert_eq!(count(&release), 0);
    let named = compiled(&CompileOptions {
        debug_names: true,
        ..CompileOptions::default()
    });
    assert!(count(&named) > 0);
}

#[test]
fn checked_kernels_are_checked_and_others_are_not() {
    let array_length = |checked: bool| {
        let kernel = compiled(&CompileOptions {
            checked,
            ..CompileOptions::default()
        });
        instructions(&kernel.spirv)
            .filter(|i| i.opcode == 68)
            .count()
    };
    assert_eq!(array_length(false), 0);
    assert!(array_length(true) > 0);
}

#[test]
fn subgroups_and_packed_halves_compile_but_not_f64() {
    compile_text("@group(0) @binding(0) var<storage, read_write> d: array<u32>;\n\
        @compute @workgroup_size(64) fn main() { d[0] = subgroupAdd(d[1]) + pack2x16float(vec2f(1.0)); }")
        .expect("compiles");
    compile_text("@compute @workgroup_size(1) fn main() { var x: f64 = 1.0lf; }")
        .expect_err("no f64");
    compile_text(
        "@group(0) @binding(0) var t: texture_2d<f32>;\n\
        @compute @workgroup_size(1) fn main() { _ = textureDimensions(t); }",
    )
    .expect_err("no textures");
}

#[test]
fn check_all_merges_equal_reports() {
    let library = library(&[
        (
            "main.wgsl",
            "#include \"lib.wgsl\"\n#include \"v.wgsl\"\n@compute @workgroup_size(1) fn main() { f(); }",
        ),
        ("lib.wgsl", "fn f() { }"),
    ]);
    let check = |name: &str, v: &str| Check {
        name: name.to_owned(),
        virtuals: VirtualFiles::from([("v.wgsl".to_owned(), v.to_owned())]),
        entry: "main.wgsl".to_owned(),
        options: CompileOptions::default(),
    };
    let results = check_all(
        &library,
        &[check("a", ""), check("b", "x"), check("c", "x")],
    );
    assert!(results[0].result.is_ok() && results[1].result.is_err());
    let reports = unique_reports(&results);
    assert_eq!(reports.len(), 1);
    assert_eq!(reports[0].1, ["b", "c"]);
}
