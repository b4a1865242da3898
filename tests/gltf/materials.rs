//! Materials.

use etendue::scene::*;
use glam::{Vec2, Vec3, Vec4};
use serde_json::json;

use crate::common::*;
use crate::seeds;

#[test]
fn materials_have_all_their_properties() {
    let scene = seeds::textured().scene();
    let m = &scene.materials[0];
    assert_eq!(m.base_color, Vec4::new(0.5, 0.5, 0.5, 0.9));
    assert_eq!(
        (m.metallic, m.roughness, m.ior, m.specular),
        (0.5, 0.5, 1.3, 0.5)
    );
    assert_eq!(m.emissive, Vec3::new(7.0, 3.5, 0.0));
    assert_eq!(m.specular_color, Vec3::new(1.0, 2.0, 0.5));
    assert_eq!(m.alpha_mode, AlphaMode::Mask { cutoff: 0.4 });
    assert!(m.double_sided && !m.unlit);
    assert_eq!(m.texture_slots().count(), 6);
    let sampler = scene.textures[1].sampler;
    assert_eq!(
        sampler,
        Sampler {
            wrap_u: Wrap::ClampToEdge,
            wrap_v: Wrap::MirroredRepeat,
            filter: Filter::Nearest
        }
    );
    assert_eq!(scene.textures[0].sampler.wrap_u, Wrap::Repeat);
    warned(&scene, "KHR_texture_transform is used but not listed");
}

#[test]
fn texture_transforms_turn_uvs_counter_clockwise_with_v_down() {
    let scene = seeds::textured().scene();
    let slot = scene.materials[0].base_color_texture.expect("it has one");
    assert_eq!(slot.tex_coord, 1);
    let (sin, cos) = 1f32.sin_cos();
    assert!(slot.matrix[0].abs_diff_eq(Vec2::new(2.0 * cos, -2.0 * sin), 1e-6));
    assert!(slot.matrix[1].abs_diff_eq(Vec2::new(3.0 * sin, 3.0 * cos), 1e-6));
    assert_eq!(slot.offset, Vec2::new(0.5, 0.0));
}

#[test]
fn factors_out_of_range_are_clamped_with_a_warning() {
    let mut builder = Builder::textured();
    builder.json["materials"][0]["pbrMetallicRoughness"] =
        json!({"roughnessFactor": 2, "metallicFactor": -1});
    builder.json["materials"][0]["emissiveFactor"] = json!([3, 0, 0]);
    builder.json["materials"][0]["extensions"] = json!({"KHR_materials_ior": {"ior": 0}});
    let scene = builder.scene();
    let m = &scene.materials[0];
    assert_eq!(
        (m.roughness, m.metallic, m.emissive.x, m.ior),
        (1.0, 0.0, 3.0, 0.0)
    );
    warned(
        &scene,
        "material 0 \"paint\", pbrMetallicRoughness: `roughnessFactor` is 2, outside its range; 1 is used",
    );
    warned(&scene, "`emissiveFactor` is above 1");
}

#[test]
fn primitives_without_material_get_the_default_one() {
    let mut builder = Builder::textured();
    builder.json["meshes"][0]["primitives"][0]["material"] = json!(null);
    let scene = builder.scene();
    assert_eq!(scene.meshes[0].material, 1);
    assert_eq!(scene.materials[1], Material::default());
    assert!(scene.images.is_empty(), "no used material shows the image");
    assert_eq!(scene.materials[0].texture_slots().count(), 0);
}

#[test]
fn unlit_materials_neither_emit_nor_read_other_textures() {
    let mut builder = seeds::textured();
    builder.json["materials"][0]["extensions"]["KHR_materials_unlit"] = json!({});
    let scene = builder.scene();
    let m = &scene.materials[0];
    assert!(m.unlit && m.base_color_texture.is_some());
    assert_eq!(
        (m.emissive, m.texture_slots().count(), scene.images.len()),
        (Vec3::ZERO, 1, 1)
    );
    let features = Features::of(&scene);
    assert!(features.unlit && !features.lit && !features.emissive && !features.specular);
}
