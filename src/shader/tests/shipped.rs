//! The shaders in `/shaders`, whatever they are.

use super::super::include::{Line, read_line};
use super::super::path;
use super::*;

/// Includes of the shipped files are well-formed, and name shipped files or generated ones.
#[test]
fn includes_of_shipped_files_are_well_formed() {
    let library = ShaderLibrary::embedded();
    for file in library.list() {
        let text = library.read(&file).expect("is listed");
        for (i, line) in text.lines().enumerate() {
            match read_line(line) {
                Line::Text => {}
                Line::Include(range) => {
                    assert_eq!(path::check(&line[range]), Ok(()), "{file}:{}", i + 1)
                }
                Line::Malformed(why, _) => panic!("{file}:{}: {why}", i + 1),
            }
        }
    }
}

/// Files whose includes are all shipped, and which need no generated name, are valid WGSL. A file
/// that does need one must fail with a place inside a shipped file.
#[test]
fn shipped_files_compose_and_parse_or_point_at_what_is_missing() {
    let library = ShaderLibrary::embedded();
    for file in library.list() {
        let result = compose(&library, &VirtualFiles::new(), &file)
            .and_then(|composed| compile(&composed, &CompileOptions::default()));
        if let Err(error) = result {
            let place = error
                .diagnostic()
                .and_then(Diagnostic::location)
                .expect("has a place");
            let text = library.read(&place.file).expect("is a shipped file");
            assert!(place.line <= text.lines().count().max(1), "{place}");
        }
    }
}

#[test]
fn the_embedded_library_is_the_folder() {
    let root = concat!(env!("CARGO_MANIFEST_DIR"), "/shaders");
    let folder = ShaderLibrary::from_dir(root).expect("reads");
    let embedded = ShaderLibrary::embedded();
    assert_eq!(
        embedded.list(),
        folder.list(),
        "build again: a new shader is not compiled in"
    );
    for file in embedded.list() {
        assert_eq!(embedded.read(&file).ok(), folder.read(&file).ok(), "{file}");
    }
}
