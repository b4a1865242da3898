//! Data and hierarchies that break the rules.

use serde_json::{Value, json};

use crate::common::*;

#[test]
fn indices_must_be_in_range() {
    let indexed = |bytes: &[u8], component, count| {
        let mut builder = Builder::square();
        let indices = builder.accessor(bytes, component, "SCALAR", count);
        builder.json["meshes"][0]["primitives"][0]["indices"] = json!(indices);
        builder
    };
    refused(
        indexed(&[0, 1, 2, 0, 2, 4], U8, 6),
        &["mesh 0 \"square\", primitive 0: index 5 of 6 refers to vertex 4, but it has 4 vertices"],
    );
    for (bytes, component) in [
        (vec![0, 1, 255], U8),
        (shorts(&[0, 1, 65535]), U16),
        (words(&[0, 1, u32::MAX]), U32),
    ] {
        refused(
            indexed(&bytes, component, 3),
            &["index 2 of 3", "primitive restart"],
        );
    }
}

#[test]
fn attributes_must_have_one_length() {
    let mut builder = Builder::square();
    let normals = builder.accessor(&floats(&[0.0; 9]), F32, "VEC3", 3);
    builder.attribute("NORMAL", normals);
    refused(
        builder,
        &["primitive 0: attribute \"NORMAL\" has 3 elements, but POSITION has 4"],
    );
}

#[test]
fn sparse_accessors_are_checked() {
    let sparse = |sparse: Value| {
        let mut builder = Builder::square();
        builder.view(&[3, 0]);
        builder.view(&floats(&[1.0, 2.0, 3.0]));
        builder.json["accessors"][0]["sparse"] = sparse;
        builder
    };
    let good = json!({"count": 1, "indices": {"bufferView": 2, "componentType": 5121}, "values": {"bufferView": 3}});
    assert!(sparse(good.clone()).load().is_ok());
    let change = |pointer: &str, value: Value| {
        let mut changed = good.clone();
        set(&mut changed, pointer, value);
        sparse(changed)
    };
    refused(
        change("count", json!(5)),
        &["accessor 0, sparse: it replaces 5 elements, but the accessor has 4"],
    );
    refused(
        change("count", json!(4)),
        &["accessor 0, sparse, indices", "do not fit"],
    );
    refused(change("indices", json!(null)), &["`indices` is missing"]);
    refused(
        change("values/bufferView", json!(null)),
        &["`bufferView` is missing"],
    );
    refused(
        change("indices/componentType", json!(5126)),
        &["`componentType` must be 5121, 5123 or 5125"],
    );
    let mut out_of_range = sparse(good);
    let at = out_of_range.bin.len() - 14;
    out_of_range.bin[at] = 4;
    refused(
        out_of_range,
        &["sparse index 0 is 4, but the accessor has 4 elements"],
    );
}

#[test]
fn lying_counts_allocate_nothing() {
    let mut builder = Builder::square();
    builder.json["accessors"][0] =
        json!({"componentType": F32, "type": "VEC3", "count": 4_000_000_000_u64});
    builder.json["meshes"][0]["primitives"][0]["indices"] = json!(null);
    refused(
        builder,
        &["accessor 0: it promises 4000000000 elements, but refers to no buffer view"],
    );
}

#[test]
fn hierarchies_must_be_trees() {
    let nodes = |nodes: Value, roots: Value| {
        let mut builder = Builder::square();
        builder.json["nodes"] = nodes;
        builder.json["scenes"][0]["nodes"] = roots;
        builder
    };
    refused(
        nodes(json!([{"children": [0]}]), json!([0])),
        &["node 0: it is its own descendant"],
    );
    refused(
        nodes(
            json!([{}, {"children": [2]}, {"children": [1]}]),
            json!([0]),
        ),
        &["node 1: it is its own descendant"],
    );
    refused(
        nodes(
            json!([{"children": [2]}, {"children": [2]}, {}]),
            json!([0]),
        ),
        &["node 2: it is a child of node 0 and of node 1"],
    );
    refused(
        nodes(json!([{"children": [1, 1]}, {}]), json!([0])),
        &["node 1: it is a child of node 0 and of node 0"],
    );
    refused(
        nodes(json!([{}]), json!([0, 0])),
        &["node 0: the scene lists it although"],
    );
    refused(
        nodes(json!([{"children": [1]}, {}]), json!([0, 1])),
        &["node 1: the scene lists it although"],
    );
}

#[test]
fn transforms_must_stay_finite() {
    let mut builder = Builder::square();
    builder.json["nodes"] = json!([
        {"scale": [1e200, 1, 1], "children": [1]},
        {"name": "deep", "scale": [1e200, 1, 1]},
    ]);
    refused(builder, &["node 1 \"deep\": its transform is not finite"]);
}

#[test]
fn required_extensions_must_be_supported() {
    let mut builder = Builder::square();
    builder.json["extensionsRequired"] = json!(["KHR_texture_transform", "ACME_mesh_compression"]);
    refused(
        builder,
        &[
            "requires the extension ACME_mesh_compression",
            "not supported",
            "export",
        ],
    );
}
