//! `tools/run`: when it offers the newest lavapipe, asks, remembers, and leaves it be. Everything that it starts is
//! a stand-in; nothing is built or fetched.

use std::fs;
use std::io::Write;
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// Drivers as `etendue devices --json` names them.
const OLD: &str = "llvmpipe, Mesa 22.3.6 (LLVM 15.0.6)";
const NEW: &str = "llvmpipe, Mesa 26.1.6 (LLVM 19.1.7)";
const GPU: &str = "NVIDIA, 570.86.10";

/// What `etendue` prints in its place: its arguments, and whether it runs under the newest lavapipe.
const PROGRAM: &str = r#"#!/bin/sh
if [ "$1" = devices ]; then cat "$(dirname "$0")/devices"; exit; fi
case ${ETENDUE_RUNNER:-} in */trixie-backports/run) echo "newest: $*" ;; *) echo "system: $*" ;; esac
"#;

/// What `ldconfig` prints in its place: more after the loader than a pipe holds.
const LIBRARIES: &str = "#!/bin/sh
echo 'libvulkan.so.1 (libc6,x86-64) => /lib/libvulkan.so.1'
seq 100000
";

struct Stage {
    folder: tempfile::TempDir,
}

impl Stage {
    /// A machine with these devices, a Vulkan loader among many libraries, and the newest lavapipe
    /// fetched.
    fn new(drivers: &[&str]) -> Self {
        let stage = Self {
            folder: tempfile::tempdir().expect("a folder"),
        };
        stage.script("bin/cargo", "#!/bin/sh\n");
        stage.script("bin/cc", "#!/bin/sh\n");
        stage.script("bin/ldconfig", LIBRARIES);
        stage.write("data/vulkan/icd.d/lvp_icd.json", "{}");
        stage.script("lavapipe/trixie-backports/run", "#!/bin/sh\nexit 9\n");
        stage.write("lavapipe/trixie-backports/version", "26.1.6-1\n");
        stage.script("target/release/etendue", PROGRAM);
        let devices: Vec<_> = drivers
            .iter()
            .map(|driver| serde_json::json!({ "name": "a device", "driver": driver, "index": 0 }))
            .collect();
        let text = serde_json::to_string_pretty(&devices).expect("JSON");
        stage.write("target/release/devices", &text);
        stage
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn write(&self, name: &str, text: &str) {
        let path = self.path(name);
        fs::create_dir_all(path.parent().expect("a parent")).expect("a folder");
        fs::write(path, text).expect("written");
    }

    fn script(&self, name: &str, text: &str) {
        self.write(name, text);
        let executable = fs::Permissions::from_mode(0o755);
        fs::set_permissions(self.path(name), executable).expect("executable");
    }

    fn answer(&self) -> Option<String> {
        fs::read_to_string(self.path("config/etendue/lavapipe")).ok()
    }

    /// Runs a program with these variables; gives the exit code, stdout and stderr.
    fn run(&self, mut command: Command, set: &[(&str, &str)], input: &str) -> Said {
        for name in ["ETENDUE_RUNNER", "VK_DRIVER_FILES", "VK_ICD_FILENAMES"] {
            command.env_remove(name);
        }
        let path = std::env::var("PATH").unwrap_or_default();
        command
            .env("PATH", format!("{}:{path}", self.path("bin").display()))
            .env("CARGO_TARGET_DIR", self.path("target"))
            .env("ETENDUE_LAVAPIPE_DIR", self.path("lavapipe"))
            .env("XDG_CONFIG_HOME", self.path("config"))
            .env("XDG_DATA_HOME", self.path("data"))
            .env_remove("ETENDUE_LAVAPIPE")
            .env_remove("ETENDUE_NO_INSTALL")
            .envs(set.iter().copied())
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped());
        let mut child = command.spawn().expect("it starts");
        let mut stdin = child.stdin.take().expect("a pipe");
        // Who does not ask does not read.
        let _ = stdin.write_all(input.as_bytes());
        drop(stdin);
        let output = child.wait_with_output().expect("it ends");
        let text = |bytes| String::from_utf8(bytes).expect("UTF-8");
        Said {
            code: output.status.code(),
            stdout: text(output.stdout),
            stderr: text(output.stderr),
        }
    }

    /// `tools/run render a.gltf` in a pipe.
    fn in_pipe(&self, set: &[(&str, &str)]) -> Said {
        let mut command = Command::new(tool());
        command.args(["render", "a.gltf"]);
        self.run(command, set, "y\n")
    }

    /// The same on a terminal of Python's making, where somebody types `input`.
    fn on_terminal(&self, input: &str) -> Said {
        let mut command = Command::new("python3");
        let script = "import os, pty, sys\n\
            sys.exit(os.waitstatus_to_exitcode(pty.spawn(sys.argv[1:])))";
        command.args(["-c", script]).arg(tool());
        command.args(["render", "a.gltf"]);
        self.run(command, &[("TERM", "dumb")], input)
    }
}

struct Said {
    code: Option<i32>,
    stdout: String,
    stderr: String,
}

impl Said {
    #[track_caller]
    fn is(&self, stdout: &str) {
        let Self { code, stderr, .. } = self;
        assert_eq!((*code, self.stdout.as_str()), (Some(0), stdout), "{stderr}");
    }
}

fn tool() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tools/run")
}

const SYSTEM: &str = "system: render a.gltf\n";
const NEWEST: &str = "newest: render a.gltf\n";

#[test]
fn in_a_pipe_one_line_says_how() {
    let stage = Stage::new(&[OLD]);
    let said = stage.in_pipe(&[]);
    said.is(SYSTEM);
    assert_eq!(said.stderr.lines().count(), 1, "{}", said.stderr);
    for part in [
        "22.3.6",
        "ETENDUE_LAVAPIPE=newest",
        "ETENDUE_LAVAPIPE=system",
    ] {
        assert!(said.stderr.contains(part), "no {part} in {}", said.stderr);
    }
    assert_eq!(stage.answer(), None);
}

#[test]
fn the_variable_decides() {
    let stage = Stage::new(&[OLD]);
    let newest = stage.in_pipe(&[("ETENDUE_LAVAPIPE", "newest")]);
    newest.is(NEWEST);
    let system = stage.in_pipe(&[("ETENDUE_LAVAPIPE", "system")]);
    system.is(SYSTEM);
    assert_eq!((newest.stderr.as_str(), system.stderr.as_str()), ("", ""));
    let wrong = stage.in_pipe(&[("ETENDUE_LAVAPIPE", "yes")]);
    assert_eq!((wrong.code, wrong.stdout.as_str()), (Some(2), ""));
    assert!(wrong.stderr.contains("expected 'newest' or 'system'"));
}

#[test]
fn other_devices_are_left_alone() {
    for drivers in [&[NEW][..], &[OLD, GPU], &[GPU], &[OLD, NEW], &[]] {
        let said = Stage::new(drivers).in_pipe(&[]);
        said.is(SYSTEM);
        assert_eq!(said.stderr, "", "{drivers:?}");
    }
    let said = Stage::new(&[OLD]).in_pipe(&[("VK_DRIVER_FILES", "/a/driver.json")]);
    said.is(SYSTEM);
    assert_eq!(said.stderr, "");
}

#[test]
fn a_terminal_is_asked_once() {
    for (input, expected, answer) in [
        ("y\n", "newest: ", "newest\n"),
        ("n\n", "system: ", "system\n"),
    ] {
        let stage = Stage::new(&[OLD]);
        let first = stage.on_terminal(input);
        assert_eq!(first.code, Some(0), "{}", first.stderr);
        assert!(
            first.stdout.contains("use it from now on? [y/N]"),
            "{}",
            first.stdout
        );
        assert!(first.stdout.contains(expected), "{}", first.stdout);
        assert_eq!(stage.answer().as_deref(), Some(answer));
        let second = stage.on_terminal("");
        assert_eq!(second.stdout, format!("{expected}render a.gltf\r\n"));
        // The answer counts in pipes, too.
        let third = stage.in_pipe(&[]);
        third.is(&format!("{expected}render a.gltf\n"));
        assert_eq!(third.stderr, "");
    }
}
