//! Libraries in memory, in folders, and their export.

use std::fs;

use super::*;

#[test]
fn lists_and_names() {
    let library = library(&[
        ("integrator/path.wgsl", "p"),
        ("integrator/ao.wgsl", ""),
        ("integrator/parts/mis.wgsl", ""),
        ("main.wgsl", ""),
    ]);
    assert_eq!(library.names_in("integrator"), ["ao", "path"]);
    assert_eq!(library.names_in("integrator/parts/"), ["mis"]);
    assert!(library.names_in("bsdf").is_empty());
    assert_eq!(library.list().last().map(String::as_str), Some("main.wgsl"));
    assert_eq!(library.read("integrator/path.wgsl").ok(), Some("p"));
    for path in ["none.wgsl", "../main.wgsl", "integrator"] {
        assert!(library.read(path).is_err(), "{path}");
    }
}

#[test]
fn export_and_from_dir_are_inverse() {
    let dir = tempfile::tempdir().expect("a folder");
    let files = [("main.wgsl", "m"), ("a/b/c.wgsl", "ü\r\n")];
    let written = library(&files).export(dir.path()).expect("exports");
    assert_eq!(written.len(), 2);
    fs::write(dir.path().join("notes.txt"), [0xff]).expect("writes");
    let read = ShaderLibrary::from_dir(dir.path()).expect("reads");
    assert_eq!(read.list(), ["a/b/c.wgsl", "main.wgsl"]);
    assert_eq!(read.read("a/b/c.wgsl").ok(), Some("ü\r\n"));
    assert!(
        read.export(dir.path())
            .expect("the same files are there")
            .is_empty()
    );
}

#[test]
fn export_overwrites_nothing() {
    let dir = tempfile::tempdir().expect("a folder");
    fs::write(dir.path().join("z.wgsl"), "mine").expect("writes");
    let error = library(&[("a.wgsl", "new"), ("z.wgsl", "new")]).export(dir.path());
    let text = error.expect_err("z.wgsl differs").to_string();
    assert!(text.contains("z.wgsl"), "{text}");
    assert!(!dir.path().join("a.wgsl").exists());
}

#[test]
fn a_folder_is_the_whole_library_and_is_named() {
    let dir = tempfile::tempdir().expect("a folder");
    fs::write(dir.path().join("main.wgsl"), "\n#include \"math.wgsl\"").expect("writes");
    let library = ShaderLibrary::from_dir(dir.path()).expect("reads");
    let text = compose(&library, &VirtualFiles::new(), "main.wgsl")
        .expect_err("missing")
        .to_string();
    let folder = dir.path().display();
    assert!(
        text.contains(&format!("not in the shader folder `{folder}`")),
        "{text}"
    );
    assert!(
        text.contains(&format!("--> {folder}/main.wgsl:2:11")),
        "{text}"
    );
    assert!(text.contains("etendue shaders export DIR"), "{text}");
}

#[test]
fn bad_folders_and_files_are_named() {
    let dir = tempfile::tempdir().expect("a folder");
    let missing = ShaderLibrary::from_dir(dir.path().join("none")).expect_err("no folder");
    assert!(missing.report().contains("none"), "{missing}");
    fs::write(dir.path().join("latin1.wgsl"), b"// \xe9").expect("writes");
    let error = ShaderLibrary::from_dir(dir.path()).expect_err("not UTF-8");
    assert!(error.to_string().contains("latin1.wgsl"), "{error}");
}

#[cfg(unix)]
#[test]
fn links_stay_inside_the_folder() {
    use std::os::unix::fs::symlink;
    let outside = tempfile::tempdir().expect("a folder");
    fs::write(outside.path().join("secret.wgsl"), "s").expect("writes");
    let dir = tempfile::tempdir().expect("a folder");
    fs::write(dir.path().join("a.wgsl"), "a").expect("writes");
    symlink(dir.path().join("a.wgsl"), dir.path().join("b.wgsl")).expect("links");
    symlink(dir.path(), dir.path().join("loop")).expect("links");
    symlink(outside.path(), dir.path().join("out")).expect("links");
    let library = ShaderLibrary::from_dir(dir.path()).expect("reads");
    assert_eq!(library.list(), ["a.wgsl", "b.wgsl"]);
    symlink(
        outside.path().join("secret.wgsl"),
        dir.path().join("c.wgsl"),
    )
    .expect("links");
    let error = ShaderLibrary::from_dir(dir.path()).expect_err("c.wgsl leaves the folder");
    assert!(error.to_string().contains("c.wgsl"), "{error}");
}
