//! Start-up: what the report says of it, and the compiled shaders that are kept between runs.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::{Duration, SystemTime};

use crate::common::{Run, command, finish, folder};
use serde_json::Value;

/// A tiny render whose report goes to stdout; `cache` is its folder for compiled shaders.
fn render(cache: &Path) -> Command {
    render_samples(cache, "16x12", 4)
}

fn render_samples(cache: &Path, size: &str, samples: usize) -> Command {
    let scene = "scenes/cornell_box.gltf";
    let samples = samples.to_string();
    let mut command = command(&[
        "render", scene, "--size", size, "--spp", &samples, "--json", "-", "-q",
    ]);
    command
        .env("ETENDUE_CACHE_DIR", cache)
        .env_remove("ETENDUE_NO_CACHE");
    command
}

fn run(mut command: Command) -> Run {
    finish(command.spawn().expect("the program starts")).ends_with(0)
}

/// The files of a kind in a cache.
fn entries(cache: &Path, kind: &str) -> Vec<PathBuf> {
    let listing = fs::read_dir(cache).expect("the cache's folder");
    let is_of_kind = |path: &PathBuf| {
        let name = path.file_name().unwrap_or_default();
        name.to_string_lossy().starts_with(kind)
    };
    let paths = listing.map(|f| f.expect("an entry").path());
    paths.filter(is_of_kind).collect()
}

/// The file of the only shader.
fn entry(cache: &Path) -> PathBuf {
    let files = entries(cache, "spirv-");
    assert_eq!(files.len(), 1, "{files:?}");
    files[0].clone()
}

#[test]
fn how_memory_is_read_is_measured_for_pictures_that_take_longer_than_that() {
    let folder = folder();
    let measured = |mut command: Command| {
        command.env("LP_NUM_THREADS", "2");
        run(command);
        entries(folder.path(), "loads-").len()
    };
    assert_eq!(measured(render(folder.path())), 0);
    let larger = || render_samples(folder.path(), "64x97", 2);
    assert_eq!(measured(larger()), 1);
    assert_eq!(measured(larger()), 1);
}

/// What must not depend on the cache.
fn result(run: &Run) -> (Value, Value) {
    let report = run.json();
    assert_eq!(report["warnings"], Value::Array(Vec::new()));
    assert_eq!(run.stderr, "");
    (
        report["mean_radiance"].clone(),
        report["relative_error"].clone(),
    )
}

#[test]
fn the_report_says_where_start_up_time_goes() {
    let folder = folder();
    let report = run(render(folder.path())).json();
    let first = report["startup"]["first_sample"].as_f64().expect("seconds");
    assert!(first > 0.0 && Some(first) <= report["seconds"]["total"].as_f64());
    let stages = report["startup"]["stages"].as_object().expect("stages");
    for name in [
        "environment",
        "read",
        "parse",
        "buffers",
        "meshes",
        "images",
        "validate",
        "instance",
        "devices",
        "device",
        "probe",
        "flatten",
        "bvh",
        "upload",
        "compose",
        "spirv",
        "pipeline",
        "film",
        "driver",
    ] {
        let seconds = stages.get(name).and_then(Value::as_f64);
        let seconds = seconds.unwrap_or_else(|| panic!("no stage {name} in {stages:?}"));
        assert!((0.0..first).contains(&seconds), "{name}: {seconds}");
    }
    // All but 100 ms of the wall time has a name (stages that overlap may name it twice).
    let sum: f64 = stages.values().filter_map(Value::as_f64).sum();
    let render = report["seconds"]["render"].as_f64().expect("seconds");
    assert!(sum + render + 0.1 > first, "{first} s, in stages {sum} s");
}

#[test]
fn compiled_shaders_are_kept_and_used_again() {
    let folder = folder();
    let cache = folder.path().join("new");
    let first = result(&run(render(&cache)));
    let path = entry(&cache);
    let content = fs::read(&path).expect("the entry");
    // A hard link tells whether the file is replaced, its time whether it is used.
    let link = folder.path().join("link");
    fs::hard_link(&path, &link).expect("a link");
    let long_ago = SystemTime::UNIX_EPOCH + Duration::from_secs(1);
    let file = fs::File::options().append(true).open(&path);
    file.expect("the entry")
        .set_modified(long_ago)
        .expect("a time");
    assert_eq!(result(&run(render(&cache))), first);
    let used = |path: &Path| fs::metadata(path).and_then(|about| about.modified());
    assert!(used(&path).expect("a time") > long_ago, "it was not used");
    assert!(used(&link).expect("a time") > long_ago, "it was replaced");
    assert_eq!(fs::read(entry(&cache)).expect("the entry"), content);
}

#[test]
fn a_damaged_entry_is_replaced_without_a_word() {
    let folder = folder();
    let first = result(&run(render(folder.path())));
    let path = entry(folder.path());
    let good = fs::read(&path).expect("the entry");
    let mut flipped = good.clone();
    let middle = flipped.len() / 2;
    flipped[middle] ^= 4;
    for bad in [&flipped[..], &good[..middle], b"", &[0; 4096]] {
        fs::write(&path, bad).expect("written");
        assert_eq!(result(&run(render(folder.path()))), first);
        assert_eq!(fs::read(entry(folder.path())).expect("the entry"), good);
    }
}

#[test]
fn processes_share_a_cache() {
    let folder = folder();
    let cache = folder.path().join("new");
    // What a device prefers is measured, and processes that do so at the same time may each find
    // something else: let it be known, but no shader.
    run(render(&cache));
    fs::remove_file(entry(&cache)).expect("removed");
    let start = |_| render(&cache).spawn().expect("the program starts");
    let children: Vec<_> = (0..4).map(start).collect();
    let results: Vec<_> = children
        .into_iter()
        .map(|child| result(&finish(child).ends_with(0)))
        .collect();
    assert!(results.iter().all(|other| *other == results[0]));
    entry(&cache);
}

#[test]
fn a_cache_that_is_off_or_impossible_changes_nothing() {
    let folder = folder();
    let cache = folder.path().join("cache");
    let with = result(&run(render(&cache)));
    fs::remove_dir_all(&cache).expect("removed");
    let mut off = render(&cache);
    off.env("ETENDUE_NO_CACHE", "1");
    assert_eq!(result(&run(off)), with);
    assert!(!cache.exists());
    fs::write(&cache, "a file where the folder should be").expect("written");
    assert_eq!(result(&run(render(&cache))), with);
    let mut nowhere = render(&cache);
    for name in ["ETENDUE_CACHE_DIR", "XDG_CACHE_HOME", "HOME"] {
        nowhere.env_remove(name);
    }
    assert_eq!(result(&run(nowhere)), with);
}

#[test]
fn a_kernel_that_is_compiled_quickly_draws_the_same_picture() {
    let folder = folder();
    let devices = finish(command(&["devices", "--json"]).spawn().expect("a start"));
    let device = devices.ends_with(0).json()[0].clone();
    let can = device["can_compile_quickly"].as_bool().expect("a field");
    let draw = |optimization| {
        let output = folder.path().join(format!("{optimization}.exr"));
        let mut command = render(folder.path());
        command.args(["--optimization", optimization, "--device", "0", "-o"]);
        // An option says more than a variable, and auto heeds it.
        command.arg(&output).env_remove("GALLIVM_PERF");
        if optimization == "full" {
            command.env("GALLIVM_PERF", "rho_approx,nopt");
        }
        let run = run(command);
        let film = etendue::image::exr::read(&output).expect("a readable EXR");
        (film.0, run.json())
    };
    let (full, report) = draw("full");
    assert_eq!(report["optimization"], "full");
    for loads in ["doublewords", "texels"] {
        assert!(report["loads"][loads].is_boolean(), "{loads}");
    }
    for optimization in ["auto", "quick"] {
        let (picture, report) = draw(optimization);
        assert_eq!(report["optimization"], if can { "quick" } else { "full" });
        let warnings = report["warnings"].as_array().expect("a list");
        let is_missed = optimization == "quick" && !can;
        assert_eq!(warnings.len(), usize::from(is_missed), "{warnings:?}");
        assert_eq!(picture, full, "{optimization}");
    }
}
