//! Extensions, features and summaries.

use etendue::scene::*;
use serde_json::json;

use crate::common::*;
use crate::seeds;

#[test]
fn extensions_that_are_only_used_are_warnings() {
    let mut builder = Builder::textured();
    builder.json["extensionsUsed"] = json!([
        "KHR_materials_clearcoat",
        "KHR_materials_volume_scatter",
        "ACME_secret"
    ]);
    builder.json["materials"][0]["extensions"] = json!({"KHR_materials_sheen": {}});
    builder.json["extras"] = json!({"extensions": {"NOT_one": {}}});
    let scene = builder.scene();
    let found: Vec<(&str, bool)> = scene
        .extensions
        .iter()
        .map(|extension| (extension.name.as_str(), extension.supported))
        .collect();
    assert_eq!(
        found,
        [
            ("ACME_secret", false),
            ("KHR_materials_clearcoat", true),
            ("KHR_materials_sheen", true),
            ("KHR_materials_volume_scatter", false)
        ]
    );
    warned(
        &scene,
        "KHR_materials_volume_scatter is not supported: the picture does not show scattering inside of surfaces",
    );
    warned(
        &scene,
        "ACME_secret is not supported: the picture does not show what it describes",
    );
    warned(
        &scene,
        "KHR_materials_sheen is used but not listed in `extensionsUsed`; it is honoured",
    );
    assert_eq!(scene.warnings.len(), 3);
}

#[test]
fn features_follow_from_what_is_used() {
    let plain = Features::of(&Builder::square().scene());
    let set: Vec<&str> = plain
        .flags()
        .into_iter()
        .filter(|flag| flag.1)
        .map(|flag| flag.0)
        .collect();
    assert_eq!(
        set,
        [
            "flat_normals",
            "single_sided",
            "lit",
            "specular",
            "metallic"
        ]
    );
    let scene = seeds::textured().scene();
    let rich = Features::of(&scene);
    assert!(rich.base_color_texture && rich.specular_color_texture && rich.alpha_mask && rich.uv1);
    assert!(
        rich.texture_transform
            && rich.wrap_mirror
            && rich.filter_nearest
            && rich.diffuse
            && rich.ior
    );
    assert!(
        !rich.alpha_blend && !rich.normals && !rich.texels_16 && !rich.point_light && !rich.unlit
    );
    let reason = rich
        .reasons
        .iter()
        .find(|reason| reason.feature == "alpha_mask");
    assert_eq!(
        reason.map(|reason| reason.reason.as_str()),
        Some("material 0")
    );
    let lights = Features::of(&seeds::nodes().scene());
    assert!(
        lights.point_light && lights.spot_light && lights.directional_light && lights.light_range
    );
    assert!(Features::all().flags().iter().all(|flag| flag.1));
}

#[test]
fn summaries_count_instances() {
    let summary = Summary::of(&seeds::nodes().scene());
    assert_eq!(
        (
            summary.triangles,
            summary.unique_triangles,
            summary.unique_vertices
        ),
        (4, 2, 4)
    );
    assert_eq!(summary.cameras[1].kind, "orthographic");
    assert_eq!(
        summary
            .lights
            .iter()
            .map(|light| light.kind)
            .collect::<Vec<_>>(),
        ["point", "spot", "directional"]
    );
    assert!(summary.extensions[0].supported);
    let json = serde_json::to_value(&summary).expect("a summary can be written");
    assert_eq!(json["bounds"].as_array().map(Vec::len), Some(2));
}

#[test]
fn lenses_and_panoramas_are_features_of_cameras() {
    let mut scene = seeds::nodes().scene();
    let lens = |radius| {
        Some(Lens {
            radius,
            focus_distance: 1.0,
        })
    };
    scene.cameras[0].lens = lens(0.0);
    assert!(!Features::of(&scene).lens);
    scene.cameras[0].lens = lens(0.1);
    scene.cameras[1].projection = Projection::Panorama;
    scene.validate().expect("a valid scene");
    let features = Features::of(&scene);
    assert!(features.lens && features.panorama);
    let reason = features.reasons.iter().find(|r| r.feature == "panorama");
    assert!(
        reason.is_some_and(|r| r.reason.starts_with("camera 1")),
        "{reason:?}"
    );
    scene.cameras[0].lens = Some(Lens {
        radius: 0.1,
        focus_distance: 0.0,
    });
    assert!(scene.validate().is_err());
    scene.cameras[0].lens = None;
    scene.cameras[1].lens = lens(0.1);
    assert!(scene.validate().is_err(), "a panorama has no lens");
}
