//! Ctrl-C.
#![cfg(unix)]

use std::path::Path;
use std::process::{Child, Command};
use std::thread::sleep;
use std::time::{Duration, Instant};

use crate::common::{command, finish, folder, path_in};

/// More samples than any machine draws while a test waits.
const ENDLESS: &str = "4000000000";

fn signal(child: &Child, name: &str) {
    let id = child.id().to_string();
    let status = Command::new("kill").args(["-s", name, &id]).status();
    assert!(status.expect("kill").success());
}

#[test]
fn ctrl_c_writes_what_has_been_accumulated() {
    let folder = folder();
    let output = path_in(&folder, "a.exr");
    let arguments = [
        "render",
        "scenes/cornell_box.gltf",
        "--size",
        "32x32",
        "--spp",
        ENDLESS,
        "-o",
        &output,
        "--aov",
        "albedo",
        "--json",
        "-",
    ];
    // Before the first sample there is nothing to save: wait longer until there is.
    for seconds in [1, 2, 4, 8, 16, 32, 64] {
        let child = command(&arguments).spawn().expect("the program starts");
        sleep(Duration::from_secs(seconds));
        signal(&child, "INT");
        let start = Instant::now();
        let run = finish(child).ends_with(130);
        if !Path::new(&output).exists() {
            assert_eq!(run.stdout, "");
            continue;
        }
        assert!(start.elapsed() < Duration::from_secs(10));
        let report = run.json();
        assert_eq!(report["interrupted"], true);
        let spp = report["spp"].as_f64().expect("a number");
        assert!(spp > 0.0 && spp < 4e9, "{spp}");
        assert!(run.stderr.contains("AOV \"albedo\""), "{}", run.stderr);
        let (picture, metadata) = etendue::image::exr::read(&output).expect("a readable EXR");
        assert_eq!((picture.width, picture.height), (32, 32));
        assert_eq!(metadata.0["etendue.interrupted"], "true");
        assert_eq!(metadata.0["etendue.spp"].parse(), Ok(spp));
        return;
    }
    panic!("no sample was drawn in 64 seconds");
}

#[test]
fn a_signal_before_the_first_sample_ends_it_at_once() {
    let arguments = [
        "render",
        "scenes/cornell_box.gltf",
        "--spp",
        ENDLESS,
        "--json",
        "-",
    ];
    let child = command(&arguments).spawn().expect("the program starts");
    sleep(Duration::from_millis(100));
    signal(&child, "TERM");
    sleep(Duration::from_millis(100));
    // Should the first one have come in time for a clean stop.
    let _ = Command::new("kill").arg(child.id().to_string()).status();
    let run = finish(child);
    // Before the handler is there, the signal itself ends the process.
    assert!(run.code.is_none_or(|code| code == 130), "{:?}", run.code);
}
