//! Runs the built program.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

/// What a run left behind.
pub struct Run {
    /// The exit code; none if a signal ended it.
    pub code: Option<i32>,
    pub stdout: String,
    pub stderr: String,
}

impl Run {
    fn of(output: Output) -> Self {
        let text = |bytes| String::from_utf8(bytes).expect("UTF-8");
        Self {
            code: output.status.code(),
            stdout: text(output.stdout),
            stderr: text(output.stderr),
        }
    }

    /// Fails unless the program ended with `code`; shows what it said.
    #[track_caller]
    pub fn ends_with(self, code: i32) -> Self {
        let Self { stdout, stderr, .. } = &self;
        assert_eq!(
            self.code,
            Some(code),
            "stdout:\n{stdout}\nstderr:\n{stderr}"
        );
        self
    }

    /// Fails unless it was refused with one sentence that holds each of `parts`.
    #[track_caller]
    pub fn refused(self, parts: &[&str]) {
        let run = self.ends_with(2);
        assert!(run.stderr.starts_with("error: "), "{}", run.stderr);
        for part in parts {
            assert!(run.stderr.contains(part), "no {part:?} in: {}", run.stderr);
        }
        for sign in ["panicked", "RUST_BACKTRACE", "Error {", "Some(", "Os {"] {
            assert!(!run.stderr.contains(sign), "{}", run.stderr);
        }
        assert_eq!(run.stdout, "");
    }

    pub fn json(&self) -> serde_json::Value {
        serde_json::from_str(&self.stdout).unwrap_or_else(|e| panic!("{e} in: {}", self.stdout))
    }
}

/// The program with arguments, its streams in pipes. A private driver may need a program of its own
/// to start others with (`tools/lavapipe`).
pub fn command<S: AsRef<OsStr>>(arguments: &[S]) -> Command {
    match std::env::var_os("ETENDUE_RUNNER").filter(|r| !r.is_empty()) {
        Some(runner) => {
            let mut command = Command::new(runner);
            command.arg(env!("CARGO_BIN_EXE_etendue"));
            piped(command, arguments)
        }
        None => plain_command(arguments),
    }
}

/// The program with arguments, started as it is, whatever driver there may be.
pub fn plain_command<S: AsRef<OsStr>>(arguments: &[S]) -> Command {
    piped(Command::new(env!("CARGO_BIN_EXE_etendue")), arguments)
}

fn piped<S: AsRef<OsStr>>(mut command: Command, arguments: &[S]) -> Command {
    command
        .args(arguments)
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped());
    command
}

/// Runs the program to its end.
pub fn etendue<S: AsRef<OsStr>>(arguments: &[S]) -> Run {
    Run::of(command(arguments).output().expect("the program starts"))
}

/// Runs `etendue render scenes/cornell_box.gltf` at a tiny size, with further arguments.
pub fn render<S: AsRef<OsStr>>(arguments: &[S]) -> Run {
    render_scene("scenes/cornell_box.gltf", arguments)
}

/// Runs `etendue render SCENE` at a tiny size, with further arguments.
pub fn render_scene<S: AsRef<OsStr>>(scene: &str, arguments: &[S]) -> Run {
    // A flag that is given again takes its last value.
    let first = ["render", scene, "--size", "16x12", "--spp", "4"];
    let mut all: Vec<&OsStr> = first.iter().map(OsStr::new).collect();
    all.extend(arguments.iter().map(AsRef::as_ref));
    etendue(&all)
}

/// Waits for a child and takes what it said.
pub fn finish(child: std::process::Child) -> Run {
    Run::of(child.wait_with_output().expect("the program ends"))
}

pub fn folder() -> tempfile::TempDir {
    tempfile::tempdir().expect("a temporary folder")
}

/// A path in a folder, as text.
pub fn path_in(folder: &tempfile::TempDir, name: &str) -> String {
    text(&folder.path().join(name))
}

pub fn text(path: &Path) -> String {
    path.to_str().expect("UTF-8").to_owned()
}

/// A file with a mesh that an animation moves from x = 0 to x = 8 in two seconds.
pub fn moving(folder: &tempfile::TempDir) -> String {
    let floats = [
        0.0_f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, // the triangle
        0.0, 2.0, // times
        0.0, 0.0, 0.0, 8.0, 0.0, 0.0, // places
    ];
    let bytes: Vec<u8> = floats.iter().flat_map(|x| x.to_le_bytes()).collect();
    std::fs::write(folder.path().join("a.bin"), bytes).expect("a file");
    let scene = path_in(folder, "a.gltf");
    let text = r#"{"asset":{"version":"2.0"},"nodes":[{"mesh":0}],
        "buffers":[{"uri":"a.bin","byteLength":68}],"bufferViews":[{"buffer":0,"byteLength":68}],
        "accessors":[
            {"bufferView":0,"componentType":5126,"type":"VEC3","count":3},
            {"bufferView":0,"byteOffset":36,"componentType":5126,"type":"SCALAR","count":2},
            {"bufferView":0,"byteOffset":44,"componentType":5126,"type":"VEC3","count":2}],
        "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
        "animations":[{"name":"slide","samplers":[{"input":1,"output":2}],
            "channels":[{"sampler":0,"target":{"node":0,"path":"translation"}}]}]}"#;
    std::fs::write(&scene, text).expect("a file");
    scene
}

/// The shaders in a folder of their own.
pub fn exported() -> (tempfile::TempDir, PathBuf) {
    let folder = folder();
    let shaders = folder.path().join("shaders");
    etendue(&["shaders", "export", &text(&shaders)]).ends_with(0);
    (folder, shaders)
}
