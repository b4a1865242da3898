//! Tangents for all that is looked up in tangent space, not for normal maps alone.

use etendue::scene::{Features, Scene};
use serde_json::{Value, json};

use crate::common::*;
use crate::materials_extensions::{layered, with_extension};

/// The square's tangents all point along u, which is +x on it, with v up.
fn has_tangents_along_u(scene: &Scene) {
    let tangents = &scene.meshes[0].tangents;
    assert_eq!(tangents.len(), scene.meshes[0].positions.len());
    for t in tangents {
        assert!(
            t.abs_diff_eq(glam::Vec4::new(1.0, 0.0, 0.0, 1.0), 1e-6),
            "{t}"
        );
    }
}

#[test]
fn anisotropy_gets_tangents() {
    let plain = json!({"anisotropyStrength": 0.5});
    let textured = json!({"anisotropyStrength": 0.5, "anisotropyTexture": {"index": 0}});
    for extension in [plain, textured] {
        let scene = with_extension("KHR_materials_anisotropy", extension.clone()).scene();
        has_tangents_along_u(&scene);
        let features = Features::of(&scene);
        assert!(features.tangents && features.anisotropy && !features.normal_texture);
        let has_texture = extension["anisotropyTexture"].is_object();
        assert_eq!(features.anisotropy_texture, has_texture);
    }
}

#[test]
fn normal_maps_of_coats_get_tangents() {
    let coat = json!({"clearcoatFactor": 1, "clearcoatNormalTexture": {"index": 0}});
    let scene = with_extension("KHR_materials_clearcoat", coat).scene();
    has_tangents_along_u(&scene);
    let features = Features::of(&scene);
    assert!(features.clearcoat_normal_texture && features.tangents && !features.normal_texture);
}

#[test]
fn what_is_not_there_needs_no_tangents() {
    let uncoated = json!({"clearcoatNormalTexture": {"index": 0}});
    let isotropic = json!({"anisotropyTexture": {"index": 0}});
    let coated = json!({"clearcoatFactor": 1, "clearcoatTexture": {"index": 0}});
    for (name, extension) in [
        ("KHR_materials_clearcoat", uncoated),
        ("KHR_materials_anisotropy", isotropic),
        ("KHR_materials_clearcoat", coated),
    ] {
        let scene = with_extension(name, extension).scene();
        assert!(scene.meshes[0].tangents.is_empty(), "{name}");
        assert!(!Features::of(&scene).tangents);
    }
}

/// Their texture coordinates are those of the first map there is, in the order of the material.
#[test]
fn tangents_run_along_the_coordinates_of_the_map() {
    let turned = |builder: &mut Builder| {
        // u runs along y, v along x: a quarter turn and a mirror.
        let uvs = builder.floats(&[0., 0., 0., 1., 1., 1., 1., 0.], "VEC2");
        builder.attribute("TEXCOORD_1", uvs);
    };
    let along = |extension: Value, name: &str| {
        let mut builder = with_extension(name, extension);
        turned(&mut builder);
        builder.scene().meshes[0].tangents[0]
    };
    let map = json!({"index": 0, "texCoord": 1});
    let coat = json!({"clearcoatFactor": 1, "clearcoatNormalTexture": map});
    let stretch = json!({"anisotropyStrength": 1, "anisotropyTexture": map});
    for (name, extension) in [
        ("KHR_materials_clearcoat", coat),
        ("KHR_materials_anisotropy", stretch),
    ] {
        let t = along(extension, name);
        assert!(t.truncate().abs_diff_eq(glam::Vec3::Y, 1e-6), "{name}: {t}");
    }
    let t = layered().scene().meshes[0].tangents[0];
    assert!(t.truncate().abs_diff_eq(glam::Vec3::X, 1e-6), "{t}");
}

/// Without texture coordinates there is no direction to stretch along.
#[test]
fn anisotropy_without_coordinates_is_isotropic() {
    let mut builder = Builder::square();
    builder.json["materials"] =
        json!([{"extensions": {"KHR_materials_anisotropy": {"anisotropyStrength": 1}}}]);
    builder.json["meshes"][0]["primitives"][0]["material"] = json!(0);
    let scene = builder.scene();
    assert!(scene.meshes[0].tangents.is_empty() && !Features::of(&scene).anisotropy);
    warned(
        &scene,
        "normal maps and anisotropy of material 0 are not used",
    );
}
