//! KHR_materials_variants.

use etendue::scene::Selector;
use etendue::scene::gltf::LoadOptions;
use serde_json::{Value, json};

use crate::common::*;

/// A square that is red, and green or blue in variants; no mapping names the variant "plain".
fn colors() -> Builder {
    let mut builder = Builder::square();
    let paint = |name: &str, color: Value| json!({"name": name, "pbrMetallicRoughness": {"baseColorFactor": color}});
    builder.json["materials"] = json!([
        paint("red", json!([1, 0, 0, 1])),
        paint("green", json!([0, 1, 0, 1])),
        paint("blue", json!([0, 0, 1, 1])),
    ]);
    builder.json["extensionsUsed"] = json!(["KHR_materials_variants"]);
    builder.json["extensions"] = json!({"KHR_materials_variants": {"variants": [
        {"name": "meadow"}, {"name": "sea"}, {"name": "plain"}, {"name": "sky"},
    ]}});
    let primitive = &mut builder.json["meshes"][0]["primitives"][0];
    primitive["material"] = json!(0);
    primitive["extensions"] = json!({"KHR_materials_variants": {"mappings": [
        {"material": 1, "variants": [0]},
        {"material": 2, "variants": [1, 3], "name": "water and air"},
    ]}});
    builder
}

/// The name of the material that the square shows.
fn shown(builder: &Builder, variant: Option<&str>) -> String {
    let parse = |text: &str| text.parse::<Selector>().expect("never fails");
    let options = LoadOptions {
        variant: variant.map(parse),
        ..LoadOptions::default()
    };
    let scene = builder
        .load_with(&options)
        .unwrap_or_else(|error| panic!("{error}"));
    scene.validate().unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(scene.variant_names.len(), 4);
    silent(&scene);
    scene.materials[scene.meshes[0].material].name.clone()
}

#[test]
fn variants_are_chosen_by_name_and_by_index() {
    let builder = colors();
    for (variant, material) in [
        (None, "red"),
        (Some("meadow"), "green"),
        (Some("sea"), "blue"),
        (Some("sky"), "blue"),
        (Some("plain"), "red"),
        (Some("0"), "green"),
        (Some("2"), "red"),
        (Some("3"), "blue"),
    ] {
        assert_eq!(shown(&builder, variant), material, "{variant:?}");
    }
}

/// Only a variant gives this primitive a material.
#[test]
fn a_variant_may_be_the_only_material() {
    let mut builder = colors();
    let primitive = &mut builder.json["meshes"][0]["primitives"][0];
    primitive["material"] = json!(null);
    assert_eq!(shown(&builder, Some("sea")), "blue");
    assert_eq!(shown(&builder, None), "", "the default material");
}

#[test]
fn unknown_variants_list_the_known_ones() {
    let error = |builder: &Builder, variant: Selector| {
        let options = LoadOptions {
            variant: Some(variant),
            ..LoadOptions::default()
        };
        let error = builder
            .load_with(&options)
            .expect_err("there is no such variant");
        error.to_string()
    };
    let sentence = error(&colors(), Selector::Name("desert".into()));
    let expected = "there is no variant \"desert\"; choose one of 0 \"meadow\", 1 \"sea\", 2 \"plain\", 3 \"sky\"";
    assert!(sentence.contains(expected), "{sentence}");
    let sentence = error(&colors(), Selector::Index(4));
    assert!(
        sentence.contains("there is no variant 4; choose one of 0 \"meadow\""),
        "{sentence}"
    );
    let sentence = error(&Builder::square(), Selector::Index(0));
    assert!(
        sentence.contains("there is no variant 0; the file has no variant"),
        "{sentence}"
    );
}

fn with_mapping(mapping: Value) -> Builder {
    let mut builder = colors();
    let primitive = &mut builder.json["meshes"][0]["primitives"][0];
    primitive["extensions"]["KHR_materials_variants"]["mappings"][1] = mapping;
    builder
}

/// Also where no variant is chosen: the file is wrong all the same.
#[test]
fn wrong_mappings_are_errors() {
    let place = "mapping 1";
    refused(
        with_mapping(json!({"variants": [1]})),
        &[place, "`material` is missing"],
    );
    refused(
        with_mapping(json!({"material": 3, "variants": [1]})),
        &[place, "material 3"],
    );
    refused(
        with_mapping(json!({"material": 2, "variants": [4]})),
        &[place, "variant 4"],
    );
    refused(
        with_mapping(json!({"material": 2, "variants": 1})),
        &[place, "`variants`"],
    );
    refused(
        with_mapping(json!({"material": "blue", "variants": [1]})),
        &[place, "`material`"],
    );
    refused(with_mapping(json!(1)), &["mapping"]);
    let mut builder = colors();
    builder.json["extensions"]["KHR_materials_variants"]["variants"][1] = json!({"name": 7});
    refused(builder, &["variant 1", "`name`"]);
}
