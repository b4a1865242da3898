//! Every error points into the file that its author edited.

use super::*;

const KERNEL: &str = "#include \"lib/f.wgsl\"\n\
    @group(0) @binding(0) var<storage, read_write> data: array<f32>;\n\
    @compute @workgroup_size(64)\nfn main() { data[0] = f(1.0); }\n";

#[track_caller]
fn expect(included: &str, place: &str, message: &str) {
    let files = [("main.wgsl", KERNEL), ("lib/f.wgsl", included)];
    let result = compile_files(&files, &CompileOptions::default());
    let text = result
        .as_ref()
        .expect_err("an error is expected")
        .to_string();
    assert!(text.contains(message), "{text}");
    assert!(text.contains('^'), "{text}");
    assert_eq!(place_of(result), place, "{text}");
}

#[test]
fn the_kernel_itself_is_right() {
    let files = [
        ("main.wgsl", KERNEL),
        ("lib/f.wgsl", "fn f(x: f32) -> f32 { return x; }"),
    ];
    compile_files(&files, &CompileOptions::default()).expect("compiles");
}

#[test]
fn syntax_errors() {
    expect(
        "fn f(x: f32) -> f32 { return x }",
        "lib/f.wgsl:1:32",
        "expected",
    );
    expect(
        "\n\nfn f(x: f32) -> f32 {\n  let = 1;\n}",
        "lib/f.wgsl:4:7",
        "expected identifier",
    );
    expect(
        "fn f(x: f32) -> f32 { return x; }\n}",
        "lib/f.wgsl:2:1",
        "expected",
    );
}

#[test]
fn unknown_identifiers() {
    expect("fn f(x: f32) -> f32 { return y; }", "lib/f.wgsl:1:30", "y");
    expect(
        "fn f(x: f32) -> f32 {\n  return g(x);\n}\n",
        "lib/f.wgsl:2:10",
        "g",
    );
    expect("fn f(x: F) -> f32 { return 1.0; }", "lib/f.wgsl:1:9", "F");
}

#[test]
fn type_errors() {
    expect(
        "fn f(x: f32) -> f32 {\n  let a: i32 = x;\n  return x;\n}",
        "lib/f.wgsl:2:7",
        "i32",
    );
    expect(
        "fn f(x: f32) -> f32 {\n  return x + vec2u(1);\n}",
        "lib/f.wgsl:2:10",
        "",
    );
    expect(
        "fn f(x: f32) -> f32 {\n  return x + 1u;\n}",
        "lib/f.wgsl:2:10",
        "",
    );
}

#[test]
fn types_are_written_as_in_wgsl_and_calls_are_the_place() {
    let sum = "fn f(x: f32) -> f32 {\n  return x + 1u;\n}";
    expect(sum, "lib/f.wgsl:2:10", "(of type u32)");
    let vector = "fn f(x: f32) -> f32 {\n  let v = vec3f(x) + vec3u(1);\n  return v.x;\n}";
    expect(vector, "lib/f.wgsl:2:11", "vec3<u32>");
    let call = "fn g(a: f32, b: i32) {}\nfn f(x: f32) -> f32 {\n  g(x, x);\n  return x;\n}";
    expect(call, "lib/f.wgsl:3:3", "Argument 1");
}

#[test]
fn tabs_and_other_alphabets_before_the_column() {
    expect(
        "fn f(x: f32) -> f32 {\n\t\treturn y;\n}",
        "lib/f.wgsl:2:10",
        "y",
    );
    expect(
        "fn f(x: f32) -> f32 { /* é漢🙂 */ return y; }",
        "lib/f.wgsl:1:40",
        "y",
    );
    expect("fn f(x: f32) -> f32 { return é; }", "lib/f.wgsl:1:30", "é");
}

#[test]
fn validation_errors() {
    expect(
        "fn f(x: f32) -> f32 {\n  if (x > 1.0) { return x; }\n}",
        "lib/f.wgsl:1:1",
        "return",
    );
    expect(
        "\n\nvar<private> a: array<f32, 4>;\nfn f(x: f32) -> f32 { return a[7]; }",
        "lib/f.wgsl:4:30",
        "",
    );
    expect("fn f(x: f32) -> f32 { return f(x); }", "lib/f.wgsl:1:4", "");
}

#[test]
fn errors_at_the_first_and_the_last_byte() {
    expect("?", "lib/f.wgsl:1:1", "");
    expect(
        "fn f(x: f32) -> f32 { return x; }\nconst a = b",
        "lib/f.wgsl:2:11",
        "",
    );
    assert_eq!(
        place_of(compile_text("@compute @workgroup_size(1) fn main() {")),
        "main.wgsl:1:40"
    );
    assert_eq!(
        place_of(compile_text(
            "@compute @workgroup_size(1) fn main() {\n\n\n"
        )),
        "main.wgsl:3:1"
    );
}

#[test]
fn labels_in_two_files_are_both_shown() {
    let files = [
        (
            "main.wgsl",
            "#include \"a.wgsl\"\nfn f() {}\n@compute @workgroup_size(1) fn main() { f(); }",
        ),
        ("a.wgsl", "\nfn f() {}\n"),
    ];
    let error = compile_files(&files, &CompileOptions::default()).expect_err("two functions f");
    let text = error.to_string();
    assert!(
        text.contains("main.wgsl:2:4") && text.contains("a.wgsl:2:4"),
        "{text}"
    );
}

#[test]
fn the_whole_report() {
    let files = [
        ("main.wgsl", KERNEL),
        (
            "lib/f.wgsl",
            "fn f(x: f32) -> f32 {\n\treturn wrong; // é\n}",
        ),
    ];
    let error = compile_files(&files, &CompileOptions::default()).expect_err("unknown name");
    let expected = "error: no definition in scope for identifier: `wrong`\n  \
                    --> lib/f.wgsl:2:9\n  |\n\
                    2 |     return wrong; // é\n  |            ^^^^^ unknown identifier";
    assert_eq!(error.to_string().trim_end(), expected);
    let colours = error.diagnostic().map(|d| d.to_ansi()).unwrap_or_default();
    assert!(colours.contains("\u{1b}["), "{colours}");
}

#[test]
fn terminals_are_not_written_to() {
    let text = compile_text("\u{1b}[31m é")
        .expect_err("no WGSL")
        .to_string();
    assert!(!text.contains('\u{1b}'), "{text}");
}

#[test]
fn a_missing_entry_point_lists_the_others() {
    let text = "@compute @workgroup_size(1) fn first() {}\nfn main() {}";
    let error = compile_text(text).expect_err("main is no entry point");
    assert!(
        error
            .to_string()
            .contains("its compute entry points are: `first`"),
        "{error}"
    );
    assert_eq!(place_of(compile_text(text)), "main.wgsl:2:4");
}

#[test]
fn an_unfinished_file_is_blamed_before_the_one_that_goes_on() {
    expect("const a = 1", "lib/f.wgsl:1:11", "main.wgsl:2:1");
    expect(
        "fn f(x: f32) -> f32 { return x;",
        "main.wgsl:2:2",
        "lib/f.wgsl:1:31",
    );
}

/// Prints reports for a person to judge: `cargo test show_reports -- --ignored --nocapture`.
#[test]
#[ignore = "prints, asserts nothing"]
fn show_reports() {
    for text in [
        "fn f(x: f32) -> f32 { return x + 1u; }",
        "fn f(x: f32) -> f32 { if (x > 1.0) { return x; } }",
        "fn f(x: f32) -> f32 { let v = vec3f(x); return cross(v, vec2f(x)); }",
        "fn f(x: f32) -> f32 { return x; }\nfn f() {}",
        "struct S { a: bool }\n@group(0) @binding(0) var<storage> s: S;\nfn f(x: f32) -> f32 { return x; }",
        "var<private> a: array<f32, 4>;\nfn f(x: f32) -> f32 {\n    return a[9];\n}",
        "fn g(x: i32) {}\nfn f(x: f32) -> f32 {\n    g(x);\n    return x;\n}",
        "fn f(x: f32) -> f32 {\n    x = 1.0;\n    return x;\n}",
        "fn f(x: f32) -> f32 {\n    for (var i = 0; i < 4; i++) { workgroupBarrier(); if (x > 1.0) { workgroupBarrier(); } }\n    return x;\n}",
        "fn f(x: f32) -> f32 {\n    switch i32(x) { case 1: { return x; } }\n    return x;\n}",
        "fn f(x: f32) -> f32 { return x;",
    ] {
        let files = [("main.wgsl", KERNEL), ("lib/f.wgsl", text)];
        match compile_files(&files, &CompileOptions::default()) {
            Ok(_) => println!("compiles: {text}\n"),
            Err(error) => println!("{error}\n"),
        }
    }
}
