//! `scenes/` is what `tools/make-scenes` writes, byte for byte, and shows what the names say.

use std::fs;
use std::path::Path;
use std::process::Command;

use etendue::scene::gltf::{LoadOptions, load};
use etendue::scene::{Features, Scene, Selector};

#[test]
fn the_scenes_are_what_their_generator_writes() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let folder = tempfile::tempdir().expect("a temporary folder");
    let status = Command::new(root.join("tools/make-scenes"))
        .arg(folder.path())
        .status()
        .expect("python3 is installed (apt-get install python3, or run tools/test)");
    assert!(status.success(), "tools/make-scenes failed");
    let mut compared = 0;
    for entry in fs::read_dir(folder.path()).expect("the folder") {
        let made = entry.expect("an entry").path();
        let name = made.file_name().expect("a file name");
        let committed = fs::read(root.join("scenes").join(name)).expect("the committed scene");
        assert!(
            fs::read(&made).expect("the made scene") == committed,
            "{} differs: run tools/make-scenes and commit what it writes",
            name.display()
        );
        compared += 1;
    }
    let committed = fs::read_dir(root.join("scenes")).expect("scenes/").count();
    assert_eq!(
        compared, committed,
        "scenes/ holds files that the generator does not write"
    );
}

/// A scene of scenes/, which must be valid and raise no warning.
fn scene(name: &str, options: &LoadOptions) -> Scene {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("scenes")
        .join(name);
    let scene = load(&path, options).unwrap_or_else(|error| panic!("{error}"));
    scene
        .validate()
        .unwrap_or_else(|error| panic!("{name}: {error}"));
    assert_eq!(scene.warnings, Vec::<String>::new(), "{name}");
    scene
}

fn requires(scene: &Scene, feature: &str) -> bool {
    let flags = Features::of(scene).flags();
    let flag = flags.iter().find(|(name, _)| *name == feature);
    flag.unwrap_or_else(|| panic!("there is no feature {feature}"))
        .1
}

#[test]
fn scenes_of_materials_need_what_they_are_named_after() {
    for (name, features) in [
        ("anisotropy", &["anisotropy", "tangents"][..]),
        ("clearcoat", &["clearcoat"]),
        ("diffuse_transmission", &["diffuse_transmission"]),
        ("dispersion", &["dispersion", "transmission", "media"]),
        ("iridescence", &["iridescence"]),
        ("rough_glass", &["transmission", "media", "absorption"]),
        ("sheen", &["sheen"]),
        ("specular_glossiness", &["ior", "specular"]),
        ("variants", &["diffuse"]),
    ] {
        let scene = scene(&format!("material_{name}.gltf"), &LoadOptions::default());
        for feature in features {
            assert!(requires(&scene, feature), "{name} does not need {feature}");
        }
        let lit = requires(&scene, "emissive");
        assert!(
            lit && scene.environment.is_none() && scene.cameras.len() == 1,
            "{name}"
        );
    }
}

#[test]
fn variants_need_what_they_are_named_after() {
    for (variant, feature) in [
        ("metal", "metallic"),
        ("glass", "absorption"),
        ("cloth", "sheen"),
    ] {
        let options = LoadOptions {
            variant: Some(Selector::Name(variant.into())),
            ..LoadOptions::default()
        };
        assert!(requires(
            &scene("material_variants.gltf", &options),
            feature
        ));
        let usual = scene("material_variants.gltf", &LoadOptions::default());
        assert!(!requires(&usual, feature), "{feature}");
    }
}
