//! Values and references that break the rules: each is refused with a sentence that names the object.

use serde_json::json;

use crate::common::*;

#[test]
fn references_must_exist() {
    let cases = [
        (
            "scene",
            json!(7),
            "`scene` refers to scene 7, but the file has 1 scene",
        ),
        (
            "scenes/0/nodes",
            json!([4]),
            "scene 0: `nodes` refers to node 4",
        ),
        (
            "nodes/0/mesh",
            json!(3),
            "node 0 \"node\": `mesh` refers to mesh 3, but the file has 1 mesh",
        ),
        (
            "nodes/0/camera",
            json!(0),
            "`camera` refers to camera 0, but the file has no camera",
        ),
        ("nodes/0/skin", json!(0), "`skin` refers to skin 0"),
        (
            "nodes/0/children",
            json!([9]),
            "`children` refers to node 9",
        ),
        (
            "meshes/0/primitives/0/material",
            json!(1),
            "primitive 0: `material` refers to material 1",
        ),
        (
            "meshes/0/primitives/0/indices",
            json!(99),
            "`indices` refers to accessor 99",
        ),
        (
            "meshes/0/primitives/0/attributes/POSITION",
            json!(99),
            "`POSITION` refers to accessor 99",
        ),
        (
            "meshes/0/primitives/0/attributes/WEIGHTS_0",
            json!(99),
            "`WEIGHTS_0` refers to accessor 99",
        ),
        (
            "accessors/0/bufferView",
            json!(99),
            "accessor 0: `bufferView` refers to buffer view 99",
        ),
        (
            "bufferViews/0/buffer",
            json!(5),
            "buffer view 0: `buffer` refers to buffer 5",
        ),
        (
            "materials/0/pbrMetallicRoughness/baseColorTexture/index",
            json!(2),
            "material 0 \"paint\", pbrMetallicRoughness, baseColorTexture: `index` refers to texture 2",
        ),
        (
            "textures/0/source",
            json!(8),
            "texture 0: `source` refers to image 8",
        ),
        (
            "textures/0/sampler",
            json!(0),
            "texture 0: `sampler` refers to sampler 0",
        ),
        (
            "images/0/bufferView",
            json!(99),
            "image 0 \"checks\": `bufferView` refers to buffer view 99",
        ),
        (
            "nodes/0/extensions",
            json!({"KHR_lights_punctual": {"light": 0}}),
            "`light` refers to light 0",
        ),
    ];
    for (pointer, value, part) in cases {
        refused(with(pointer, value), &[part]);
    }
}

#[test]
fn values_must_have_their_type_and_range() {
    let cases = [
        ("asset/version", json!("1.0"), "the glTF version is \"1.0\""),
        ("asset/minVersion", json!("2.1"), "`minVersion` is \"2.1\""),
        ("asset", json!(null), "`asset` is missing"),
        (
            "nodes",
            json!({}),
            "`nodes` must be an array, found an object",
        ),
        (
            "nodes/0",
            json!(3),
            "node 0: expected a JSON object, found 3",
        ),
        (
            "nodes/0/mesh",
            json!(-1),
            "`mesh` must be a non-negative integer, found -1",
        ),
        (
            "nodes/0/mesh",
            json!(0.5),
            "`mesh` must be a non-negative integer, found 0.5",
        ),
        ("nodes/0/mesh", json!("0"), "found the string \"0\""),
        (
            "nodes/0/matrix",
            json!([1, 2]),
            "`matrix` must be an array of 16 finite numbers, found an array of 2 values",
        ),
        (
            "nodes/0/scale",
            json!([1, 2, "x"]),
            "`scale` must be an array of 3 finite numbers",
        ),
        (
            "accessors/0/componentType",
            json!(5124),
            "`componentType` is 5124",
        ),
        ("accessors/0/type", json!("VEC5"), "`type` must be SCALAR"),
        ("accessors/0/count", json!(0), "`count` is 0"),
        ("accessors/0/count", json!(null), "`count` is missing"),
        (
            "accessors/0/count",
            json!(5),
            "5 elements of 12 bytes, 12 apart, from byte 0 on do not fit in buffer view 0, which has 48 bytes",
        ),
        ("accessors/0/count", json!(u64::MAX), "do not fit"),
        ("accessors/0/byteOffset", json!(u64::MAX), "do not fit"),
        ("accessors/0/byteOffset", json!(4), "do not fit"),
        (
            "accessors/0/type",
            json!("VEC2"),
            "POSITION must be VEC3, found VEC2",
        ),
        (
            "accessors/1/componentType",
            json!(5122),
            "indices must be unsigned integers",
        ),
        ("bufferViews/0/byteStride", json!(8), "overlap"),
        ("bufferViews/0/byteStride", json!(u64::MAX), "do not fit"),
        (
            "bufferViews/0/byteLength",
            json!(1_000_000),
            "1000000 bytes from byte 0 on do not fit in buffer 0",
        ),
        (
            "bufferViews/0/byteOffset",
            json!(u64::MAX),
            "do not fit in buffer 0",
        ),
        (
            "bufferViews/0/byteLength",
            json!(null),
            "`byteLength` is missing",
        ),
        (
            "meshes/0/primitives/0/mode",
            json!(7),
            "`mode` is 7, expected 0 to 6",
        ),
        (
            "materials/0/alphaMode",
            json!("GLASS"),
            "`alphaMode` must be OPAQUE, MASK or BLEND, found \"GLASS\"",
        ),
        (
            "materials/0/extensions",
            json!({"KHR_materials_ior": {"ior": 0.5}}),
            "material 0 \"paint\", KHR_materials_ior: `ior` is 0.5, expected 0 or at least 1",
        ),
        (
            "materials/0/emissiveFactor",
            json!([1e300, 0, 0]),
            "`emissiveFactor` is 1e300, beyond the largest 32-bit float",
        ),
        (
            "materials/0/normalTexture",
            json!({"scale": 1}),
            "normalTexture: `index` is missing",
        ),
        (
            "textures/0/source",
            json!(null),
            "texture 0: it has no image",
        ),
        (
            "images/0/bufferView",
            json!(null),
            "it has neither `uri` nor `bufferView`",
        ),
        ("samplers", json!([{"wrapS": 1}]), "sampler 0: `wrapS` is 1"),
        (
            "samplers",
            json!([{"magFilter": 1}]),
            "sampler 0: `magFilter` is 1",
        ),
        (
            "cameras",
            json!([{"type": "fisheye"}]),
            "camera 0: `type` must be perspective or orthographic",
        ),
        (
            "cameras",
            json!([{"type": "perspective", "perspective": {"yfov": 4}}]),
            "`yfov` is 4",
        ),
        (
            "cameras",
            json!([{"type": "perspective"}]),
            "`perspective` is missing",
        ),
        (
            "cameras",
            json!([{"type": "orthographic", "orthographic": {"xmag": 0, "ymag": 1}}]),
            "`xmag` is 0",
        ),
        (
            "extensions",
            json!({"KHR_lights_punctual": {"lights": [{"type": "area"}]}}),
            "light 0: `type` must be point, spot or directional",
        ),
        (
            "extensionsRequired",
            json!(3),
            "`extensionsRequired` must be an array",
        ),
        (
            "extensionsRequired",
            json!([3]),
            "must be an array of names",
        ),
    ];
    for (pointer, value, part) in cases {
        refused(with(pointer, value), &[part]);
    }
}
