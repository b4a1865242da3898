//! How a light is chosen: what `--lights` takes, and what the reports say.

use crate::common::{etendue, render, render_scene};
use serde_json::{Value, json};

#[test]
fn the_number_of_lamps_decides() {
    // Two triangles of one lamp.
    let few = render(&["--json", "-"]).ends_with(0).json();
    assert_eq!(few["lights"]["selection"], "power");
    assert_eq!(few["lights"]["count"], 2);
    assert_eq!(few["lights"]["in_tree"], 0);
    let wished = render(&["--json", "-", "--lights", "tree"]).ends_with(0);
    assert_eq!(wished.json()["lights"]["in_tree"], 2);

    let scene = "scenes/many_lights.gltf";
    let many = render_scene(scene, &["--json", "-"]).ends_with(0).json();
    let lights = &many["lights"];
    assert_eq!(lights["selection"], "tree");
    // All but the sun.
    assert_eq!(
        lights["count"].as_u64(),
        lights["in_tree"].as_u64().map(|n| n + 1)
    );
    assert!(lights["bytes"].as_u64() > lights["count"].as_u64().map(|n| 64 * n));
    for name in ["uniform", "power"] {
        let other = render_scene(scene, &["--json", "-", "--lights", name]).ends_with(0);
        assert_eq!(other.json()["lights"]["selection"], name);
        assert_eq!(other.json()["lights"]["in_tree"], 0);
    }
}

#[test]
fn info_says_how_lights_are_chosen() {
    let arguments = ["info", "scenes/many_lights.gltf", "--bvh", "fast"];
    let text = etendue(&arguments).ends_with(0).stdout;
    assert!(text.contains("choice of a light"), "{text}");
    let json = etendue(&[&arguments[..], &["--json"]].concat()).ends_with(0);
    assert_eq!(json.json()["light_selection"]["selection"], "tree");
}

#[test]
fn wishes_that_cannot_be_met() {
    render(&["--json", "-", "--lights", "best"]).refused(&["best", "uniform, power or tree"]);
    let folder = tempfile::tempdir().expect("a folder");
    let path = written(&folder, &furnace_put_out());
    let sky = ["--json", "-", "--lights", "tree", "--env", "1"];
    let run = render_scene(&path, &sky).ends_with(0);
    assert_eq!(run.json()["lights"]["selection"], "power");
    assert!(run.stderr.contains("by power"), "{}", run.stderr);
}

/// With a tree of one lamp, which is chosen for certain, no bit differs from the table's.
#[test]
fn a_choice_of_nothing_changes_no_bit() {
    let mut scene = furnace_put_out();
    let lamp = json!({"type": "point", "intensity": 3.0});
    scene["extensions"] = json!({"KHR_lights_punctual": {"lights": [lamp]}});
    list(&mut scene["extensionsUsed"]).push("KHR_lights_punctual".into());
    let nodes = list(&mut scene["nodes"]);
    nodes.push(json!({"extensions": {"KHR_lights_punctual": {"light": 0}}}));
    let index = nodes.len() - 1;
    list(&mut scene["scenes"][0]["nodes"]).push(index.into());
    let folder = tempfile::tempdir().expect("a folder");
    let path = written(&folder, &scene);
    let mean = |name| {
        let run = render_scene(&path, &["--json", "-", "--lights", name]).ends_with(0);
        run.json()["mean_radiance"].clone()
    };
    let table = mean("power");
    assert!(table[0].as_f64() > Some(0.0), "{table}");
    assert_eq!(mean("tree"), table);
}

/// The furnace with nothing that emits.
fn furnace_put_out() -> Value {
    let text = std::fs::read_to_string("scenes/furnace.gltf").expect("the scene");
    let mut scene: Value = serde_json::from_str(&text).expect("JSON");
    for material in list(&mut scene["materials"]) {
        let material = material.as_object_mut().expect("a material");
        material.remove("emissiveFactor");
    }
    scene
}

fn list(value: &mut Value) -> &mut Vec<Value> {
    value.as_array_mut().expect("a list")
}

fn written(folder: &tempfile::TempDir, scene: &Value) -> String {
    let path = folder.path().join("scene.gltf");
    std::fs::write(&path, scene.to_string()).expect("written");
    path.to_str().expect("a name").into()
}
