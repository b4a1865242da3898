//! The layers import only downwards (ARCHITECTURE.md), and what belongs to one layer stays there.

use std::fs;
use std::path::{Path, PathBuf};

/// Lowest first: a layer may use those before it.
const LAYERS: [&str; 10] = [
    "host", "geometry", "accel", "scene", "shader", "gpu", "image", "render", "study", "cli",
];

/// Words that only the files below a folder may contain.
const BELONGS: [(&str, &str); 5] = [
    ("unsafe {", "gpu"),
    ("ash::", "gpu"),
    ("anyhow::", "cli"),
    ("clap::", "cli"),
    ("::gltf::", "scene/gltf"),
];

fn source() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("src")
}

fn rust_files(folder: &Path) -> Vec<PathBuf> {
    let mut files = Vec::new();
    for entry in fs::read_dir(folder).expect("a folder of sources") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            files.extend(rust_files(&path));
        } else if path.extension().is_some_and(|e| e == "rs") {
            files.push(path);
        }
    }
    files
}

/// The text without what a reader of code ignores: comments.
fn code(path: &Path) -> String {
    let text = fs::read_to_string(path).expect("a source file");
    text.lines()
        .filter(|line| !line.trim_start().starts_with("//"))
        .collect::<Vec<_>>()
        .join("\n")
}

/// The layers that a text names after `crate::`, also in braces (`use crate::{a, b}`).
fn imported_layers(code: &str) -> Vec<String> {
    code.match_indices("crate::")
        .flat_map(|(at, word)| {
            let rest = &code[at + word.len()..];
            let names = match rest.strip_prefix('{') {
                Some(list) => list.split('}').next().unwrap_or_default().to_owned(),
                None => rest.to_owned(),
            };
            let several = rest.starts_with('{');
            names
                .split(',')
                .take(if several { usize::MAX } else { 1 })
                .map(first_identifier)
                .collect::<Vec<_>>()
        })
        .collect()
}

fn first_identifier(text: &str) -> String {
    text.trim_start()
        .chars()
        .take_while(|c| c.is_alphanumeric() || *c == '_')
        .collect()
}

#[test]
fn imports_go_down() {
    for (rank, layer) in LAYERS.iter().enumerate() {
        for file in rust_files(&source().join(layer)) {
            for used in imported_layers(&code(&file)) {
                let above = LAYERS.iter().skip(rank + 1).any(|l| *l == used);
                assert!(
                    !above,
                    "{} ({layer}) imports {used}, which is above it",
                    file.display()
                );
            }
        }
    }
}

#[test]
fn what_belongs_to_one_layer_stays_there() {
    for file in rust_files(&source()) {
        let relative = file.strip_prefix(source()).expect("below src");
        let code = code(&file);
        for (word, folder) in BELONGS {
            let inside = relative.starts_with(folder) || relative == Path::new("main.rs");
            assert!(
                inside || !contains_word(&code, word),
                "{} contains `{word}`, which belongs to {folder}/",
                file.display()
            );
        }
    }
}

/// Whether a text has a word, not as the end of a longer one: `hash::` is not `ash::`.
fn contains_word(text: &str, word: &str) -> bool {
    let is_part = |c: char| c.is_alphanumeric() || c == '_';
    text.match_indices(word)
        .any(|(at, _)| !text[..at].ends_with(is_part))
}

#[test]
fn a_word_is_not_the_end_of_another() {
    assert!(contains_word("use ash::vk;", "ash::") && contains_word("ash::vk", "ash::"));
    assert!(!contains_word("use std::hash::Hash;", "ash::"));
}

#[test]
fn the_scan_finds_imports() {
    let found = imported_layers(
        "use crate::{cli::x, gpu};\nuse crate::render::Film;\nlet a = crate::scene::b();",
    );
    assert_eq!(found, ["cli", "gpu", "render", "scene"]);
}
