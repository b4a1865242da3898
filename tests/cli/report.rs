//! The report of `etendue render --json`.

use crate::common::{folder, path_in, render, render_scene};
use serde_json::Value;

#[test]
fn the_report_has_every_field() {
    let folder = folder();
    let output = path_in(&folder, "a.exr");
    let run = render(&["-o", &output, "--json", "-", "--stats"]).ends_with(0);
    let report = run.json();
    for key in ["load", "accel", "compile", "render", "write", "total"] {
        assert!(
            report["seconds"][key].as_f64() >= Some(0.0),
            "seconds.{key}"
        );
    }
    for key in [
        "scene",
        "device",
        "driver",
        "version",
        "integrator",
        "sampler",
        "scene_hash",
    ] {
        assert!(report[key].is_string(), "{key}");
    }
    for key in [
        "paths_per_second",
        "rays_per_second",
        "triangles",
        "device_bytes",
    ] {
        assert!(report[key].as_f64() > Some(0.0), "{key}");
    }
    assert_eq!(report["width"], 16);
    assert_eq!(report["height"], 12);
    assert_eq!(report["spp"].as_u64(), Some(4));
    assert_eq!(report["seed"], 0);
    assert_eq!(report["max_depth"], 8);
    assert_eq!(report["non_finite_samples"], 0);
    assert_eq!(report["interrupted"], false);
    assert_eq!(report["warnings"], Value::Array(Vec::new()));
    assert_eq!(report["outputs"][0], output.as_str());
    assert!(report["rays"]["closest"].as_u64() >= Some(16 * 12 * 4));
    assert!(report["rays"]["any"].as_u64() > Some(0));
    check_list_counts(&report);
    assert!(report["mean_radiance"][2].as_f64() > Some(0.0));
    assert!(report["relative_error"].as_f64() > Some(0.0));
}

/// A list of solids: closest-hit rays test the one pair that the planes tell, shadow rays none; a ray in a thousand, near
/// an edge, tests all.
fn check_list_counts(report: &Value) {
    let number = |value: &Value| value.as_f64().expect("a number");
    let rays = &report["rays"];
    assert_eq!(rays["nodes_per_ray"], 0.0);
    let (closest, any) = (number(&rays["closest"]), number(&rays["any"]));
    let more = number(&rays["pairs_per_ray"]) * (closest + any) - closest;
    let all = number(&report["bvh"]["bytes"]) / 64.0;
    assert!(
        more > -1e-6 && more < all * 1e-3 * (closest + any),
        "{rays}"
    );
}

#[test]
fn the_report_tells_what_instances_share() {
    let instances = |mode: &str| {
        let arguments = ["--instancing", mode, "--spp", "1", "--json", "-"];
        let report = render_scene("scenes/foliage.gltf", &arguments)
            .ends_with(0)
            .json();
        report["bvh"]["instancing"]["instances"].as_u64()
    };
    assert_eq!(instances("auto"), Some(0));
    assert_eq!(instances("never"), Some(0));
    assert!(instances("always") > Some(0));
}

#[test]
fn a_report_alone_goes_to_a_file_and_leaves_out_what_was_not_counted() {
    let folder = folder();
    let path = path_in(&folder, "report.json");
    let run = render(&["--json", &path, "--spp", "1", "--max-depth", "1"]).ends_with(0);
    assert_eq!((run.stdout.as_str(), run.stderr.as_str()), ("", ""));
    let text = std::fs::read_to_string(path).expect("the report");
    let report: Value = serde_json::from_str(&text).expect("JSON");
    assert_eq!(report.get("rays"), None);
    assert_eq!(
        report["relative_error"],
        Value::Null,
        "one sample has no variance"
    );
    assert_eq!(report["max_depth"], 1);
}

#[test]
fn the_report_says_whether_paths_were_guided() {
    let guiding = |more: &[&str]| {
        let run = render(&[&["--json", "-", "--spp", "8"], more].concat()).ends_with(0);
        let report = run.json();
        (
            report["guiding"].clone(),
            report["mean_radiance"][1].as_f64(),
            report["warnings"].clone(),
        )
    };
    let none = Value::Array(Vec::new());
    // The picture is too small to try.
    let (auto, mean, warnings) = guiding(&[]);
    assert_eq!(
        (&auto["asked"], &auto["used"]),
        (&Value::from("auto"), &Value::from(false))
    );
    assert_eq!((&auto["forecast"], warnings), (&Value::Null, none.clone()));
    assert_eq!(guiding(&["--guiding", "off"]).1, mean);
    let (on, guided, warnings) = guiding(&["--guiding", "on"]);
    assert_eq!((&on["used"], warnings), (&Value::from(true), none));
    assert!(on["forecast"].as_f64() > Some(0.0) && on["densities"].as_u64() > Some(6));
    assert!(on["roulette_threshold"].as_f64() > Some(0.0));
    assert!(on["roulette_forecast"].as_f64() < Some(1.0));
    assert_eq!(
        on["light_samples"].is_null(),
        on["light_samples_forecast"].is_null()
    );
    assert!(on["seconds"].as_f64() > Some(0.0));
    // Other samples of the same picture.
    let ratio = guided.expect("a mean") / mean.expect("a mean");
    assert!(ratio != 1.0 && (0.8..1.25).contains(&ratio), "{ratio}");
    let (missed, _, warnings) = guiding(&["--guiding", "on", "--max-depth", "2"]);
    assert_eq!(missed["used"], Value::from(false));
    assert!(
        warnings[0]
            .as_str()
            .is_some_and(|w| w.contains("--max-depth 3")),
        "{warnings}"
    );
    render(&["--json", "-", "--guiding", "some"]).refused(&["some", "auto, on or off"]);
}
