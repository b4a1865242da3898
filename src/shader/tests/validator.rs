//! Khronos' own validator agrees, where it is installed.

use std::fs;
use std::path::Path;
use std::process::Command;

use super::*;

/// Runs a SPIRV-Tools program; none where it is not installed.
fn tool(program: &str, arguments: &[&str], file: &Path) -> Option<(bool, String)> {
    let output = Command::new(program)
        .args(arguments)
        .arg(file)
        .output()
        .ok()?;
    let text = [output.stdout, output.stderr].concat();
    Some((
        output.status.success(),
        String::from_utf8_lossy(&text).into_owned(),
    ))
}

/// Validates for Vulkan 1.1, and returns the disassembly.
pub(super) fn validate(name: &str, words: &[u32]) -> Option<String> {
    let dir = tempfile::tempdir().expect("a folder");
    let path = dir.path().join("kernel.spv");
    let bytes: Vec<u8> = words.iter().flat_map(|w| w.to_le_bytes()).collect();
    fs::write(&path, bytes).expect("writes");
    let (valid, text) = tool("spirv-val", &["--target-env", "vulkan1.1"], &path)?;
    assert!(valid, "{name}: {text}");
    tool("spirv-dis", &["--raw-id"], &path).map(|(_, text)| text)
}

const TEXT: &str = "struct Node { min: vec3f, left: u32, max: vec3f, right: u32 }\n\
    override SCALE: f32 = 2.0;\n\
    @group(0) @binding(0) var<storage, read> nodes: array<Node>;\n\
    @group(0) @binding(1) var<storage, read_write> data: array<f32>;\n\
    @group(0) @binding(2) var<storage, read_write> counter: atomic<u32>;\n\
    var<workgroup> stack: array<u32, 2048>;\n\
    fn exact_two_product(a: f32, b: f32) -> vec2f { let p = a * b; return vec2f(p, fma(a, b, -p)); }\n\
    fn exact_matrix(m: mat3x3f, v: vec3f) -> vec3f { return (m * v) * dot(v, v) - v % m[0]; }\n\
    @compute @workgroup_size(64)\n\
    fn main(@builtin(global_invocation_id) id: vec3u, @builtin(local_invocation_index) lane: u32) {\n\
        var local: array<f32, 8>;\n\
        stack[lane] = nodes[id.x].left;\n\
        loop { if (stack[lane] == 0u) { break; } stack[lane] = nodes[stack[lane]].right / id.y; }\n\
        local[lane % id.y] = SCALE * exact_two_product(data[id.x], 3.0).y;\n\
        let m = mat3x3f(nodes[0].min, nodes[1].min, nodes[2].min);\n\
        data[id.x] = local[lane] + exact_matrix(m, nodes[id.x].max).x + subgroupAdd(1.0);\n\
        atomicAdd(&counter, u32(i32(data[0])));\n}";

#[test]
fn kernels_are_valid_spirv() {
    for checked in [false, true] {
        for debug_names in [false, true] {
            let options = CompileOptions {
                checked,
                debug_names,
                ..CompileOptions::default()
            };
            let kernel = compile_files(&[("main.wgsl", TEXT)], &options).expect("compiles");
            let name = format!("checked {checked}, names {debug_names}");
            let Some(text) = validate(&name, &kernel.spirv) else {
                eprintln!("spirv-val or spirv-dis is not installed");
                return;
            };
            assert_eq!(text.matches("NoContraction").count(), 7, "{name}\n{text}");
        }
    }
}
