//! Inputs that no person writes: deep, long, empty.

use super::*;

const HEAD: &str = "@group(0) @binding(0) var<storage, read_write> d: array<f32>;\n\
    @compute @workgroup_size(1) fn main() {\n";

/// Compiles or fails with a place, but does not end the process.
#[track_caller]
fn survives(name: &str, text: &str) {
    if let Err(error) = compile_text(text) {
        let place = error.diagnostic().and_then(Diagnostic::location);
        assert!(place.is_some(), "{name}");
    }
}

#[test]
fn deep_nesting() {
    let n = 20_000;
    let body = |text: String| format!("{HEAD}{text}\n}}");
    survives(
        "parentheses",
        &body(format!("d[0] = {}1.0{};", "(".repeat(n), ")".repeat(n))),
    );
    survives("negations", &body(format!("d[0] = {}1.0;", "- ".repeat(n))));
    survives(
        "blocks",
        &body(format!("{}{}", "{".repeat(n), "}".repeat(n))),
    );
    survives(
        "loops",
        &body(format!("{}break;{}", "loop {".repeat(n), "}".repeat(n))),
    );
    survives(
        "arrays",
        &format!("alias A = {}f32{};", "array<".repeat(n), ">".repeat(n)),
    );
    survives("attributes", &"@".repeat(n));
    survives(
        "indices",
        &body(format!("d[0] = {}0{};", "d[u32(".repeat(n), ")]".repeat(n))),
    );
    survives("pointers", &body(format!("{}d[0] = 1.0;", "*&".repeat(n))));
}

#[test]
fn long_chains() {
    let n = 20_000;
    let body = |text: String| format!("{HEAD}{text}\n}}");
    survives(
        "sums",
        &body(format!("d[0] = d[1]{};", " + d[1]".repeat(n))),
    );
    survives(
        "else ifs",
        &body(format!(
            "if (d[0] > 1.0) {{ d[1] = 1.0; }}{}",
            " else if (d[0] > 2.0) { d[1] = 2.0; }".repeat(n)
        )),
    );
    survives("members", &body(format!("d[0] = d[0]{};", ".x".repeat(n))));
    let calls: String = (0..2000)
        .map(|i| format!("fn f{}() {{ f{i}(); }}\n", i + 1))
        .collect();
    survives("calls", &format!("fn f0() {{}}\n{calls}{HEAD} f2000(); }}"));
    let constants: String = (0..5000)
        .map(|i| format!("const c{} = c{i} + 1;\n", i + 1))
        .collect();
    survives(
        "constants",
        &format!("{constants}const c0 = 1;\n{HEAD} d[0] = f32(c5000); }}"),
    );
}

#[test]
fn many_files_and_long_lines() {
    let chain: Vec<(String, String)> = (0..3000)
        .map(|i| {
            (
                format!("f{i}.wgsl"),
                format!("#include \"f{}.wgsl\"\nconst k{i} = {i};", i + 1),
            )
        })
        .chain([("f3000.wgsl".to_owned(), String::new())])
        .collect();
    let library = ShaderLibrary::from_files(chain);
    let composed = compose(&library, &VirtualFiles::new(), "f0.wgsl").expect("composes");
    assert_eq!(composed.source_map.files().len(), 3001);
    survives(
        "a long line",
        &format!("{HEAD}{} ? }}", "d[0] = 1.0; ".repeat(10_000)),
    );
    let huge = "x".repeat(5 << 20);
    assert_eq!(
        place_of(compose_files(&[("main.wgsl", &huge)])),
        "main.wgsl:1:1"
    );
}

#[test]
fn odd_texts() {
    for text in [
        "\0", "\u{feff}", "\r", "\u{2028}", "//", "/**/", "\"", "'", "é", "🙂", "_", "1", "fn",
        "@", ";;;",
    ] {
        survives(text, text);
        survives(text, &format!("{HEAD}{text}"));
        survives(text, &format!("{HEAD}}}\n{text}"));
    }
}

/// Far longer than any shader, for a person in doubt: `ETENDUE_CHAIN=N cargo test longest -- --ignored`.
#[test]
#[ignore = "slow"]
fn longest_chains() {
    let n = std::env::var("ETENDUE_CHAIN")
        .ok()
        .and_then(|n| n.parse().ok())
        .unwrap_or(60_000);
    let body = |text: String| format!("{HEAD}{text}\n}}");
    survives("sums", &body(format!("d[0] = d[1]{};", "+d[1]".repeat(n))));
    eprintln!("sums");
    survives("members", &body(format!("d[0] = d[0]{};", ".x".repeat(n))));
    eprintln!("members");
    survives(
        "else ifs",
        &body(format!("if(true){{}}{}", "else if(true){}".repeat(n))),
    );
    eprintln!("else ifs");
    survives(
        "ors",
        &body(format!("let a = d[0] > 1.0{};", "||true".repeat(n))),
    );
    eprintln!("ors");
}
