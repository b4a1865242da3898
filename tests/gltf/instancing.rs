//! EXT_mesh_gpu_instancing.

use serde_json::{Value, json};

use crate::common::*;
use crate::seeds;

#[test]
fn a_node_shows_its_mesh_as_often_as_it_says() {
    let scene = seeds::instances().scene();
    silent(&scene);
    assert_eq!((scene.meshes.len(), scene.instances.len()), (1, 3));
    assert!(
        scene
            .instances
            .iter()
            .all(|instance| instance.name == "node")
    );
    let corner = |instance: usize| world_positions(&scene, instance)[2];
    // The corner (1, 1, 0), scaled, turned, moved, and then the node's own step along z.
    assert_eq!(corner(0).to_array(), [1.0, 1.0, 1.0]);
    assert!(
        corner(1).abs_diff_eq(glam::DVec3::new(4.0, 1.0, 1.0), 1e-9),
        "{}",
        corner(1)
    );
    assert_eq!(corner(2).to_array(), [2.0, 8.0, 1.0]);
}

#[test]
fn rotations_are_floats_or_normalised_bytes_too() {
    let half = 0.5_f32.sqrt();
    for (component, bytes, normalized, precision) in [
        (F32, floats(&[0.0, 0.0, half, half].repeat(3)), false, 1e-7),
        (I8, [0, 0, 90, 90].repeat(3), true, 1e-9),
    ] {
        let mut builder = seeds::instances();
        let turns = builder.accessor(&bytes, component, "VEC4", 3);
        builder.json["accessors"][turns]["normalized"] = json!(normalized);
        instancing(&mut builder)["ROTATION"] = json!(turns);
        let corner = world_positions(&builder.scene(), 0)[2];
        assert!(
            corner.abs_diff_eq(glam::DVec3::new(-1.0, 1.0, 1.0), precision),
            "{corner}"
        );
    }
}

fn instancing(builder: &mut Builder) -> &mut Value {
    &mut builder.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]
}

#[test]
fn many_instances_share_one_mesh() {
    let mut builder = Builder::square();
    let count = 20_000;
    let places: Vec<f32> = (0..count).flat_map(|i| [i as f32, 0.0, 0.0]).collect();
    let places = builder.floats(&places, "VEC3");
    builder.json["nodes"][0]["extensions"] =
        json!({"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": places}}});
    builder.json["extensionsUsed"] = json!(["EXT_mesh_gpu_instancing"]);
    let scene = builder.scene();
    assert_eq!((scene.meshes.len(), scene.instances.len()), (1, count));
    assert_eq!(scene.triangle_count(), 2 * count as u64);
    assert_eq!(
        world_positions(&scene, count - 1)[1].to_array(),
        [count as f64, 0.0, 0.0]
    );
}

#[test]
fn wrong_attributes_are_refused() {
    let change = |key: &str, value: Value| {
        let mut builder = seeds::instances();
        instancing(&mut builder)[key] = value;
        builder
    };
    let here = "node 0 \"node\", EXT_mesh_gpu_instancing, attributes";
    refused(
        change("SCALE", json!(99)),
        &[here, "`SCALE` refers to accessor 99"],
    );
    refused(
        change("SCALE", json!(0)),
        &[here, "SCALE has 4 elements, but another attribute has 3"],
    );
    let mut builder = seeds::instances();
    *instancing(&mut builder) = json!({"_ID": 0});
    refused(builder, &[here, "none of TRANSLATION, ROTATION and SCALE"]);
    let mut builder = seeds::instances();
    builder.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"] = json!({});
    refused(
        builder,
        &["EXT_mesh_gpu_instancing: `attributes` is missing"],
    );
    let mut builder = seeds::instances();
    let far = builder.floats(&[0.0, f32::NAN, 0.0].repeat(3), "VEC3");
    instancing(&mut builder)["TRANSLATION"] = json!(far);
    refused(builder, &["element 0, a TRANSLATION, is not finite"]);
    let mut builder = seeds::instances();
    let turns = instancing(&mut builder)["ROTATION"]
        .as_u64()
        .expect("an index") as usize;
    builder.json["accessors"][turns]["normalized"] = json!(false);
    refused(builder, &["ROTATION has integers"]);
    // So many that their bytes are more than 64 bits can count, and of zeros, so that no buffer is too short.
    let mut builder = seeds::instances();
    let zeros = json!({"componentType": F32, "type": "VEC3", "count": 1_u64 << 60});
    let zeros = builder.push("accessors", zeros);
    *instancing(&mut builder) = json!({"TRANSLATION": zeros});
    refused(builder, &["instances are too many"]);
    let mut builder = seeds::instances();
    let none = builder.floats(&[0.0; 12], "VEC4");
    instancing(&mut builder)["ROTATION"] = json!(none);
    warned(&builder.scene(), "3 of its rotations have no direction");
}
