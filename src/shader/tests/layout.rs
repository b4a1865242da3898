//! Host structs against shader structs.

use super::*;

const TEXT: &str = "struct Node {\n    min: vec3f,\n    left: u32,\n    max: vec3f,\n    // right: child\n    right: u32,\n}\n\
    @group(0) @binding(0) var<storage, read> nodes: array<Node>;\n\
    @compute @workgroup_size(1) fn main() { _ = nodes[0].left; }";

fn field(name: &'static str, offset: usize, size: usize) -> FieldLayout {
    FieldLayout { name, offset, size }
}

fn node() -> StructLayout {
    let fields = vec![
        field("min", 0, 12),
        field("left", 12, 4),
        field("max", 16, 12),
        field("right", 28, 4),
    ];
    StructLayout {
        name: "Node",
        size: 32,
        fields,
    }
}

fn check(layout: StructLayout) -> Result<Compiled, ShaderError> {
    let layouts = [layout];
    let options = CompileOptions {
        layouts: &layouts,
        ..CompileOptions::default()
    };
    compile_files(&[("main.wgsl", TEXT)], &options)
}

#[track_caller]
fn expect(layout: StructLayout, place: &str, message: &str) {
    let result = check(layout);
    let text = result.as_ref().expect_err("a mismatch").to_string();
    assert!(text.contains(message), "{text}");
    assert_eq!(place_of(result), place, "{text}");
}

#[test]
fn equal_layouts_pass_and_bindings_name_them() {
    let compiled = check(node()).expect("equal");
    assert_eq!(compiled.bindings[0].element.as_deref(), Some("Node"));
    check(StructLayout {
        name: "Absent",
        ..node()
    })
    .expect("not used");
}

#[test]
fn names() {
    let mut layout = node();
    layout.fields[1].name = "first";
    expect(
        layout,
        "main.wgsl:3:5",
        "field 2 is `left`, the host has `first`",
    );
    let mut layout = node();
    layout.fields.pop();
    expect(
        layout,
        "main.wgsl:6:5",
        "field 4 is `right`, the host has no more fields",
    );
    let mut layout = node();
    layout.fields.push(field("pad", 32, 4));
    expect(
        layout,
        "main.wgsl:1:8",
        "field 5 is missing, the host has `pad`",
    );
}

#[test]
fn offsets_sizes_and_strides() {
    let mut layout = node();
    layout.fields[2].offset = 20;
    expect(
        layout,
        "main.wgsl:4:5",
        "field `max` has offset 16, the host has 20",
    );
    let mut layout = node();
    layout.fields[3].size = 8;
    expect(
        layout,
        "main.wgsl:6:5",
        "field `right` has size 4, the host has 8",
    );
    let layout = StructLayout { size: 48, ..node() };
    expect(
        layout,
        "main.wgsl:1:8",
        "its size (and array stride) is 32 bytes, the host has 48",
    );
}

#[test]
fn all_mismatches_are_shown_at_once() {
    let mut layout = StructLayout { size: 48, ..node() };
    layout.fields[2].offset = 20;
    let text = check(layout).expect_err("two mismatches").to_string();
    assert!(
        text.contains("offset 16") && text.contains("32 bytes"),
        "{text}"
    );
}
