//! `etendue info` and `etendue devices`.

use crate::common::{etendue, folder, moving, path_in};

#[test]
fn info_shows_a_scene_as_text_and_as_json() {
    let text = etendue(&["info", "scenes/foliage.gltf"])
        .ends_with(0)
        .stdout;
    for part in [
        "triangles",
        "cameras",
        "materials",
        "textures",
        "extensions",
        "features of the shader",
        "alpha_mask",
        "supported",
    ] {
        assert!(text.contains(part), "no {part} in:\n{text}");
    }
    let json = etendue(&["info", "scenes/foliage.gltf", "--json"])
        .ends_with(0)
        .json();
    for key in [
        "cameras",
        "lights",
        "materials",
        "textures",
        "extensions",
        "features",
        "warnings",
    ] {
        assert!(json[key].is_array(), "{key}");
    }
    assert!(json["triangles"].as_u64() > Some(0));
    assert!(json["textures"][0]["width"].as_u64() > Some(0));
    assert!(json["features"][0]["reason"].is_string());
}

#[test]
fn info_builds_the_acceleration_structure_when_asked() {
    for preset in ["fast", "balanced", "best"] {
        let arguments = ["info", "scenes/foliage.gltf", "--bvh", preset];
        let text = etendue(&arguments).ends_with(0).stdout;
        assert!(text.contains("acceleration structure"), "{text}");
        let json = etendue(&[&arguments[..], &["--json"]].concat()).ends_with(0);
        let bvh = &json.json()["bvh"];
        assert_eq!(bvh["preset"], preset);
        assert!(bvh["seconds"].as_f64() > Some(0.0));
        assert!(bvh["bytes"].as_u64() > Some(0));
    }
    let without = etendue(&["info", "scenes/foliage.gltf", "--json"]).ends_with(0);
    assert!(without.json()["bvh"].is_null());
    etendue(&["info", "scenes/foliage.gltf", "--bvh", "worst"]).refused(&["worst", "balanced"]);
}

#[test]
fn info_tells_what_instances_share() {
    let instancing = |more: &[&str]| {
        let arguments = [&["info", "scenes/foliage.gltf", "--json"], more].concat();
        etendue(&arguments).ends_with(0).json()["instancing"].clone()
    };
    let usual = instancing(&[]);
    assert_eq!(usual["instances"], 0);
    assert_eq!(usual["estimated_bytes"], usual["estimated_bytes_flat"]);
    let always = instancing(&["--instancing", "always", "--bvh", "fast"]);
    assert!(
        always["trees"].as_u64() > Some(0)
            && always["instances"].as_u64() >= always["trees"].as_u64()
    );
    let text = etendue(&["info", "scenes/foliage.gltf"])
        .ends_with(0)
        .stdout;
    assert!(text.contains("none shared"), "{text}");
    let refused = ["info", "scenes/foliage.gltf", "--instancing", "some"];
    etendue(&refused).refused(&["some", "auto, never or always"]);
}

#[test]
fn info_needs_no_device() {
    let mut command = crate::common::command(&["info", "scenes/furnace.gltf"]);
    // The loader then finds no driver.
    let child = command.env("VK_ICD_FILENAMES", "/nonexistent.json").spawn();
    crate::common::finish(child.expect("the program starts")).ends_with(0);
}

#[test]
fn info_refuses_what_cannot_be_read() {
    etendue(&["info", "no/such/scene.gltf"]).refused(&["no/such/scene.gltf"]);
    etendue(&["info", "scenes/furnace.gltf", "--scene", "9"]).refused(&["no scene 9"]);
}

#[test]
fn info_shows_the_moment_of_an_animation() {
    let folder = folder();
    let scene = moving(&folder);
    let left = |arguments: &[&str]| {
        let all = [&["info", &scene, "--json"], arguments].concat();
        let json = etendue(&all).ends_with(0).json();
        (
            json["bounds"][0][0].as_f64(),
            json["animation_index"].as_u64(),
        )
    };
    assert_eq!(left(&[]), (Some(0.0), None));
    assert_eq!(left(&["--at", "0.5"]), (Some(2.0), Some(0)));
    assert_eq!(
        left(&["--animation", "slide", "--at", "99"]),
        (Some(8.0), Some(0))
    );
    assert_eq!(
        left(&["--animation", "0", "--at", "-1"]),
        (Some(0.0), Some(0))
    );
    let text = etendue(&["info", &scene, "--at", "0.5"])
        .ends_with(0)
        .stdout;
    assert!(text.contains("\"slide\"  shown at 0.5 s"), "{text}");
    etendue(&["info", &scene, "--animation", "walk"])
        .refused(&["no animation \"walk\"; choose one of 0 \"slide\""]);
    etendue(&["info", &scene, "--at", "soon"]).refused(&["--at", "soon"]);
    etendue(&["info", "scenes/furnace.gltf", "--at", "1"]).refused(&["the file has no animation"]);
}

#[test]
fn names_from_a_file_do_not_reach_the_terminal_raw() {
    let folder = folder();
    let scene = path_in(&folder, "a.gltf");
    let text = r#"{"asset":{"version":"2.0"},"scenes":[{"name":"\u001b[31mred","nodes":[0]}],
        "nodes":[{"name":"\u001b]0;title\u0007","camera":0}],"extensionsUsed":["\u001b[1m"],
        "cameras":[{"type":"perspective","perspective":{"yfov":1,"znear":1}}]}"#;
    std::fs::write(&scene, text).expect("a file");
    let run = etendue(&["info", &scene]).ends_with(0);
    assert!(!run.stdout.contains('\u{1b}'), "{:?}", run.stdout);
}

#[test]
fn devices_are_listed() {
    let text = etendue(&["devices"]).ends_with(0).stdout;
    assert!(text.starts_with("0: "), "{text}");
    let json = etendue(&["devices", "--json"]).ends_with(0).json();
    assert_eq!(json[0]["index"], 0);
    assert!(json[0]["driver"].is_string());
}

#[test]
fn without_a_driver_it_says_how_to_get_one() {
    for arguments in [
        &["devices"][..],
        &["render", "scenes/furnace.gltf", "--json", "-"],
    ] {
        let mut command = crate::common::plain_command(arguments);
        let command = command
            .env("VK_ICD_FILENAMES", "/nonexistent.json")
            .env("VK_DRIVER_FILES", "/nonexistent.json");
        let run = crate::common::finish(command.spawn().expect("the program starts")).ends_with(3);
        assert!(run.stderr.contains("apt install"), "{}", run.stderr);
    }
}

#[test]
fn what_is_wrong_in_a_file_is_an_error_or_a_warning() {
    let folder = folder();
    let path = path_in(&folder, "wrong.gltf");
    let json = serde_json::json!({
        "asset": {"version": "2.0"},
        "materials": [{"name": "paint", "alphaMode": 7}],
    });
    std::fs::write(&path, json.to_string()).expect("a file");
    etendue(&["info", &path]).refused(&["wrong.gltf", "material 0 \"paint\"", "alphaMode"]);
    let run = etendue(&["info", &path, "--lenient", "--json"]).ends_with(0);
    let warning = run.json()["warnings"][0].as_str().unwrap_or("").to_owned();
    assert!(
        warning.contains("material 0 \"paint\": `alphaMode`"),
        "{warning}"
    );
    assert!(warning.ends_with("magenta is shown instead"), "{warning}");
}
