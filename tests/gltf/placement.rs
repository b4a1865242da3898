//! Nodes, cameras, lights and skins.

use etendue::scene::*;
use glam::{DVec3, Vec3};
use serde_json::json;

use crate::common::*;
use crate::seeds;

#[test]
fn transforms_are_composed_in_double_precision() {
    let scene = seeds::nodes().scene();
    // Turned about +Y by twice atan(0.6 / 0.8); scaled by (1, −2, 3); moved.
    let (sin, cos) = (0.96, 0.28);
    let expected = DVec3::new(5.0 * cos + 1.0, 2.0, 3.0 - 5.0 * sin);
    let leaf = &scene.instances[0];
    assert_eq!(leaf.name, "leaf");
    assert!(
        leaf.to_world
            .transform_point3(DVec3::ZERO)
            .abs_diff_eq(expected, 1e-14)
    );
    assert!(
        (leaf.to_world.determinant() + 6.0).abs() < 1e-13,
        "mirrored, volume 6"
    );
    assert_eq!(scene.instances.len(), 2);
    assert_eq!(scene.meshes.len(), 1, "one mesh, placed twice");
}

#[test]
fn cameras_lose_their_scale() {
    let scene = seeds::nodes().scene();
    assert_eq!(scene.cameras.len(), 2);
    assert_eq!(scene.cameras[0].name, "leaf");
    assert_eq!(
        scene.cameras[0].projection,
        Projection::Perspective {
            yfov: 0.8,
            aspect: Some(1.5)
        }
    );
    assert_eq!(
        scene.cameras[1].projection,
        Projection::Orthographic {
            xmag: 2.0,
            ymag: 1.0
        }
    );
    let z = scene.cameras[0].to_world.z_axis.truncate();
    assert!(z.abs_diff_eq(DVec3::new(0.96, 0.0, 0.28), 1e-14), "{z}");
    assert_eq!(scene.find_camera(&Selector::Name("leaf".into())), Ok(0));
    assert!(scene.find_camera(&Selector::Index(2)).is_err());
    assert!(scene.notes.is_empty());
}

#[test]
fn a_scene_without_cameras_is_framed() {
    for (scale, shift) in [(1.0, 0.0), (1e-6, 0.0), (1e6, 1e6)] {
        let mut builder = Builder::square();
        builder.json["nodes"][0]["scale"] = json!([scale, scale, scale]);
        builder.json["nodes"][0]["translation"] = json!([shift, 0, 0]);
        let scene = builder.scene();
        assert_eq!(scene.notes.len(), 1);
        let camera = &scene.cameras[0];
        let to_camera = camera.to_world.inverse();
        let Projection::Perspective { yfov, .. } = camera.projection else {
            panic!("a perspective camera");
        };
        let mut farthest: f64 = 0.0;
        for corner in square_positions() {
            let p = to_camera.transform_point3(
                scene.instances[0]
                    .to_world
                    .transform_point3(corner.as_dvec3()),
            );
            assert!(p.z < 0.0, "in front");
            farthest = farthest.max((p.x / p.z).abs().max((p.y / p.z).abs()) / (yfov / 2.0).tan());
        }
        assert!(
            (0.6..=1.0).contains(&farthest),
            "it fills the picture: {farthest}"
        );
    }
    let empty = Builder::empty().scene();
    assert_eq!(
        (empty.cameras.len(), empty.triangle_count(), empty.bounds()),
        (1, 0, None)
    );
}

#[test]
fn lights_stand_where_their_nodes_are() {
    let scene = seeds::nodes().scene();
    assert_eq!(scene.lights.len(), 3);
    let [point, spot, sun] = &scene.lights[..] else {
        panic!("three lights")
    };
    assert_eq!(point.intensity, Vec3::new(10.0, 5.0, 2.5));
    assert_eq!((point.kind, point.range), (LightKind::Point, 20.0));
    assert_eq!(point.position, DVec3::new(1.0, 2.0, 3.0));
    assert_eq!(
        spot.kind,
        LightKind::Spot {
            inner: 0.1,
            outer: 0.3
        }
    );
    assert_eq!(spot.range, f64::INFINITY);
    assert!(
        sun.direction
            .abs_diff_eq(DVec3::new(-0.96, 0.0, -0.28), 1e-14)
    );
    assert_eq!(sun.name, "sun");
    silent(&scene);
}

#[test]
fn a_file_without_scenes_shows_its_root_nodes() {
    let mut builder = Builder::square();
    builder.json["nodes"] = json!([{"mesh": 0}, {"children": [0]}, {"mesh": 0}]);
    builder.json["scenes"] = json!(null);
    builder.json["scene"] = json!(null);
    let scene = builder.scene();
    assert_eq!((scene.instances.len(), scene.scene_names.len()), (2, 0));
}

#[test]
fn deep_hierarchies_do_not_overflow_the_stack() {
    let mut builder = Builder::square();
    let last = 200_000;
    let chain = (0..last).map(|node| json!({"children": [node + 1]}));
    let mut nodes: Vec<_> = chain.collect();
    nodes.push(json!({"mesh": 0}));
    builder.json["nodes"] = json!(nodes);
    assert_eq!(builder.scene().instances.len(), 1);
}

#[test]
fn hidden_nodes_hide_what_is_below_them_but_no_camera() {
    let mut builder = seeds::nodes();
    let hidden = json!({"KHR_node_visibility": {"visible": false}});
    let shown = json!({"KHR_node_visibility": {"visible": true}});
    builder.json["extensionsUsed"] = json!(["KHR_lights_punctual", "KHR_node_visibility"]);
    builder.json["nodes"][2]["extensions"]["KHR_node_visibility"] =
        hidden["KHR_node_visibility"].clone();
    builder.json["nodes"][4]["extensions"]["KHR_node_visibility"] =
        shown["KHR_node_visibility"].clone();
    let scene = builder.scene();
    let names: Vec<&str> = scene.instances.iter().map(|i| i.name.as_str()).collect();
    assert_eq!(
        names,
        ["leaf"],
        "the mesh of node 3 is below the hidden node 2"
    );
    assert_eq!((scene.lights.len(), scene.cameras.len()), (0, 2));
    silent(&scene);
    builder.json["nodes"][1]["extensions"] = hidden;
    assert_eq!(
        (
            builder.scene().instances.len(),
            builder.scene().meshes.len()
        ),
        (0, 0)
    );
    builder.json["nodes"][1]["extensions"] = json!({"KHR_node_visibility": {}});
    assert_eq!(
        builder.scene().instances.len(),
        1,
        "nodes are visible unless they say no"
    );
    builder.json["nodes"][1]["extensions"] = json!({"KHR_node_visibility": {"visible": 0}});
    refused(
        builder,
        &["node 1 \"leaf\", KHR_node_visibility: `visible` must be true or false"],
    );
}

#[test]
fn flattened_geometry_is_allowed() {
    let mut builder = Builder::square();
    builder.json["nodes"][0]["scale"] = json!([1, 0, 1]);
    assert_eq!(builder.scene().instances[0].to_world.determinant(), 0.0);
}
