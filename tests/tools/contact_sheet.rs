//! `tools/contact-sheet`: tiles where they belong, and files that cannot be rendered. A stand-in renders.

use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::path::Path;
use std::process::{Command, Output};

use image::{ImageEncoder, Rgb, RgbImage};

/// "Renders" a file that holds a picture; every option must have a value.
const PROGRAM: &str = r#"#!/bin/sh
[ "$1" = render ] && [ "$3 $4 $5" = "--env 0.5 --size" ] || exit 9
file=$2
while [ "$1" != -o ]; do shift; done
[ -s "$file" ] || { echo "error: $file: it is empty" >&2; exit 2; }
cp "$file" "$2"
"#;

/// Rows from a tile to the one below: a gap, the picture, a smaller gap, the label.
const CELL: u32 = 6 + 30 + 3 + 12;

/// A noisy picture, so that the encoder uses every filter of PNG.
fn picture() -> RgbImage {
    RgbImage::from_fn(40, 30, |x, y| {
        let noise = (x * 7919 + y * 104_729) % 251;
        Rgb([
            (x * 6) as u8,
            (y * 8) as u8,
            if y > 15 { noise as u8 } else { 9 },
        ])
    })
}

fn encoded(filter: image::codecs::png::FilterType) -> Vec<u8> {
    let picture = picture();
    let mut bytes = Vec::new();
    image::codecs::png::PngEncoder::new_with_quality(&mut bytes, Default::default(), filter)
        .write_image(&picture, 40, 30, image::ExtendedColorType::Rgb8)
        .expect("pixels that fit");
    bytes
}

fn contact_sheet(folder: &Path, more: &[&str]) -> Output {
    let program = folder.join("program");
    fs::write(&program, PROGRAM).expect("the folder can be written");
    fs::set_permissions(&program, fs::Permissions::from_mode(0o755)).expect("its own file");
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut command = Command::new(root.join("tools/contact-sheet"));
    command
        .arg(folder.join("models"))
        .args(["--env", "0.5", "--size", "40x30", "--columns", "2"]);
    command
        .arg("--program")
        .arg(&program)
        .arg("-o")
        .arg(folder.join("sheet.png"));
    command.args(more).output().expect("python3 is installed")
}

/// A folder with these models.
fn models(files: &[(&str, Vec<u8>)]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a temporary folder");
    fs::create_dir_all(folder.path().join("models/deep")).expect("a folder");
    for (name, bytes) in files {
        fs::write(folder.path().join("models").join(name), bytes).expect("a file");
    }
    folder
}

fn sheet(folder: &Path) -> RgbImage {
    let sheet = image::open(folder.join("sheet.png")).expect("a PNG");
    sheet.to_rgb8()
}

/// The tile in a column and a row.
fn tile(sheet: &RgbImage, column: u32, row: u32) -> RgbImage {
    image::imageops::crop_imm(sheet, 6 + 46 * column, 6 + CELL * row, 40, 30).to_image()
}

#[test]
fn pictures_are_gathered_in_rows() {
    use image::codecs::png::FilterType::*;
    let filters = [
        ("a.glb", Sub),
        ("b.gltf", Up),
        ("c.glb", Avg),
        ("deep/d.glb", Paeth),
    ];
    let files = filters.map(|(name, filter)| (name, encoded(filter)));
    let folder = models(&files);
    let output = contact_sheet(folder.path(), &[]);
    let errors = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{errors}");
    let sheet = sheet(folder.path());
    assert_eq!(sheet.dimensions(), (2 * 46 + 6, 2 * CELL + 6));
    for (column, row) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
        assert!(
            tile(&sheet, column, row) == picture(),
            "tile {column}, {row}"
        );
    }
}

#[test]
fn files_that_fail_are_named() {
    let good = encoded(image::codecs::png::FilterType::Adaptive);
    let folder = models(&[("bad.glb", Vec::new()), ("good.glb", good)]);
    let output = contact_sheet(folder.path(), &[]);
    let errors = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(1), "{errors}");
    assert!(
        errors.contains("bad.glb: error: ") && errors.contains("it is empty"),
        "{errors}"
    );
    assert!(!errors.contains("good.glb"), "{errors}");
    let sheet = sheet(folder.path());
    assert!(tile(&sheet, 1, 0) == picture());
    assert!(
        tile(&sheet, 0, 0)
            .pixels()
            .all(|p| *p == Rgb([0x60, 0, 0x30]))
    );
}

#[test]
fn wrong_arguments_are_refused() {
    let folder = models(&[]);
    for (arguments, part) in [
        (&["--size", "40"][..], "expected WIDTHxHEIGHT"),
        (&["--columns", "0"], "expected at least 1"),
        (&[], "holds no .glb or .gltf file"),
    ] {
        let output = contact_sheet(folder.path(), arguments);
        let errors = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{errors}");
        assert!(errors.contains(part), "{errors}");
    }
}
