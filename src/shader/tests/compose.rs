//! Includes.

use super::*;

fn text_of(files: &[(&str, &str)]) -> String {
    compose_files(files).expect("composes").text
}

#[test]
fn each_file_once_and_nested() {
    let text = text_of(&[
        (
            "main.wgsl",
            "#include \"a.wgsl\"\n#include \"b/c.wgsl\"\nlast",
        ),
        ("a.wgsl", "A\n#include \"b/c.wgsl\"\n"),
        ("b/c.wgsl", "C"),
    ]);
    let expected = "// #include \"a.wgsl\"\nA\n// #include \"b/c.wgsl\"\nC\n\
                    // #include \"b/c.wgsl\" (already included)\nlast\n";
    assert_eq!(text, expected);
}

#[test]
fn cycles_and_self_inclusion_end() {
    let text = text_of(&[
        (
            "main.wgsl",
            "#include \"main.wgsl\"\n#include \"a.wgsl\"\nm",
        ),
        ("a.wgsl", "#include \"b.wgsl\"\na"),
        ("b.wgsl", "#include \"a.wgsl\"\n#include \"main.wgsl\"\nb"),
    ]);
    let kept: Vec<_> = text.lines().filter(|l| !l.starts_with("//")).collect();
    assert_eq!(kept, ["b", "a", "m"]);
}

#[test]
fn virtual_files_win_even_as_the_entry() {
    let library = library(&[("main.wgsl", "library"), ("a.wgsl", "library")]);
    let file = |p: &str, t: &str| (p.to_owned(), t.to_owned());
    let virtuals = VirtualFiles::from([
        file("main.wgsl", "#include \"a.wgsl\""),
        file("a.wgsl", "virtual"),
    ]);
    let composed = compose(&library, &virtuals, "main.wgsl").expect("composes");
    assert!(composed.text.ends_with("virtual\n"));
    assert_eq!(composed.source_map.files()[1].shown, "<generated>/a.wgsl");
}

#[test]
fn every_composed_line_maps_to_its_file_and_line() {
    let composed = compose_files(&[
        ("main.wgsl", "one\n#include \"a.wgsl\"\nthree\n"),
        ("a.wgsl", "\u{feff}eins\r\nzwei"),
    ])
    .expect("composes");
    let mut byte = 0;
    let mut places = Vec::new();
    for line in composed.text.split_inclusive('\n') {
        places.push(composed.source_map.locate(byte).to_string());
        byte += line.len();
    }
    let expected = [
        "main.wgsl:1:1",
        "main.wgsl:2:1",
        "a.wgsl:1:1",
        "a.wgsl:2:1",
        "main.wgsl:3:1",
    ];
    assert_eq!(places, expected);
    assert_eq!(
        composed.source_map.locate(byte).to_string(),
        "main.wgsl:3:6"
    );
}

#[test]
fn a_span_over_several_files_ends_in_its_own() {
    let composed = compose_files(&[
        ("main.wgsl", "one\n#include \"a.wgsl\"\nthree\n"),
        ("a.wgsl", "eins\nzwei\n"),
    ])
    .expect("composes");
    let at = |needle: &str| composed.text.find(needle).expect("is there");
    let span = |range| composed.source_map.span(range);
    // From the outer file over the inner one and back.
    assert_eq!(span(1..at("three") + 2).range, 1..24);
    // From the outer into the inner file: to the end of the include line.
    assert_eq!(
        (span(1..at("zwei")).file, span(1..at("zwei")).range),
        (0, 1..21)
    );
    // From the inner into the outer file: to the end of the inner.
    assert_eq!(
        (
            span(at("eins")..at("three") + 5).file,
            span(at("eins")..at("three")).range
        ),
        (1, 0..9)
    );
}

#[test]
fn missing_files_are_named_at_the_include() {
    let files = [
        ("main.wgsl", "#include \"a.wgsl\""),
        ("a.wgsl", "\n  #include \"bsdf/ggx.wgsl\" // lobes\n"),
        ("material/ggx.wgsl", ""),
    ];
    let error = compose_files(&files).expect_err("there is no such file");
    assert!(matches!(error, ShaderError::Include(_)));
    let text = error.to_string();
    assert!(
        text.contains("cannot include `bsdf/ggx.wgsl`: it is not in the shader library"),
        "{text}"
    );
    assert!(text.contains("--> a.wgsl:2:13"), "{text}");
    assert!(text.contains("there is `material/ggx.wgsl`"), "{text}");
    assert!(
        text.contains("  #include \"bsdf/ggx.wgsl\" // lobes"),
        "{text}"
    );
}

#[test]
fn a_missing_entry_is_an_error() {
    for entry in ["", "none.wgsl", "../main.wgsl", "/main.wgsl"] {
        let result = compose(&library(&[("main.wgsl", "")]), &VirtualFiles::new(), entry);
        let error = result.expect_err("there is no such entry");
        assert!(error.report().starts_with("error: shader `"), "{error}");
    }
}

#[test]
fn escaping_includes_are_refused() {
    for path in [
        "../main.wgsl",
        "a/../main.wgsl",
        "/etc/passwd",
        "./a.wgsl",
        "",
        "a\\b.wgsl",
    ] {
        let text = format!("\n#include \"{path}\"\n");
        assert_eq!(
            place_of(compose_files(&[("main.wgsl", &text)])),
            "main.wgsl:2:11",
            "{path}"
        );
    }
}

#[test]
fn malformed_includes_have_a_place() {
    let place = |text: &str| place_of(compose_files(&[("main.wgsl", text)]));
    assert_eq!(place("x\n  #include a.wgsl"), "main.wgsl:2:3");
    assert_eq!(place("#include \"a.wgsl"), "main.wgsl:1:1");
    assert_eq!(place("#ifdef X\n"), "main.wgsl:1:1");
    assert_eq!(place("\t#include \"main.wgsl\" fn f() {}"), "main.wgsl:1:2");
}

#[test]
fn block_comments_hide_includes_and_must_end() {
    let text = text_of(&[("main.wgsl", "/* a\n#include \"none.wgsl\"\n#if\n*/\nx")]);
    assert_eq!(text, "/* a\n#include \"none.wgsl\"\n#if\n*/\nx\n");
    let open = [
        ("main.wgsl", "#include \"a.wgsl\"\n"),
        ("a.wgsl", "é /* é\n/**/\n"),
    ];
    assert_eq!(place_of(compose_files(&open)), "a.wgsl:1:3");
}

#[test]
fn empty_files_compose() {
    assert_eq!(text_of(&[("main.wgsl", "")]), "");
    assert_eq!(
        text_of(&[("main.wgsl", "\n#include \"a.wgsl\""), ("a.wgsl", "")]),
        "\n// #include \"a.wgsl\"\n"
    );
    assert!(place_of(compile_text("")).starts_with("main.wgsl:1:1"));
}
