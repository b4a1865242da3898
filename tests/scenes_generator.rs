//! `scenes/` is what `tools/make-scenes` writes, byte for byte.

use std::fs;
use std::path::Path;
use std::process::Command;

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
