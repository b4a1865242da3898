//! Small files that together hold every feature of the loader.

use serde_json::json;

use crate::common::*;
use crate::pictures::*;
use crate::{codecs, image_light};
use crate::{draco, materials_extensions, meshopt_data};

/// All of them, by name.
pub fn all() -> Vec<(&'static str, Builder)> {
    vec![
        ("square", Builder::square()),
        ("textured", textured()),
        ("layers", materials_extensions::layered()),
        ("normal map", normal_map()),
        ("given tangents", given_tangents()),
        ("quantised strip", quantized_strip()),
        ("sparse fan", sparse_fan()),
        ("nodes", nodes()),
        ("skin", skin()),
        ("KTX2", picture("etc1s_rgba.ktx2", "KHR_texture_basisu")),
        ("WebP", picture("lossy_alpha.webp", "EXT_texture_webp")),
        (
            "image-based light",
            image_light::lit(&image_light::colored()),
        ),
        ("spline", spline()),
        ("instances", instances()),
        ("Draco edgebreaker", draco::edgebreaker()),
        ("Draco sequential", draco::sequential()),
        (
            "meshopt 0",
            meshopt_data::square("EXT_meshopt_compression", 0),
        ),
        (
            "meshopt 1",
            meshopt_data::square("KHR_meshopt_compression", 1),
        ),
    ]
}

fn picture(name: &str, extension: &str) -> Builder {
    let mut builder = codecs::with_image(&codecs::file(name), extension);
    builder.json["textures"][0]["source"] = json!(0);
    builder
}

/// Every texture slot of the core model, with index of refraction, specular layer and emissive strength.
pub fn textured() -> Builder {
    let mut builder = Builder::textured();
    let uvs = builder.accessor(&[0, 255, 255, 255, 255, 0, 0, 0], U8, "VEC2", 4);
    builder.json["accessors"][uvs]["normalized"] = json!(true);
    builder.attribute("TEXCOORD_1", uvs);
    let colors = builder.accessor(&[255; 16], U8, "VEC4", 4);
    builder.json["accessors"][colors]["normalized"] = json!(true);
    builder.attribute("COLOR_0", colors);
    let jpeg = builder.view(&jpeg_gray());
    builder.push("images", json!({"bufferView": jpeg}));
    builder.json["samplers"] = json!([{"wrapS": 33071, "wrapT": 33648, "magFilter": 9728}]);
    builder.push("textures", json!({"source": 1, "sampler": 0}));
    let jpeg = builder.view(&jpeg_rgb());
    builder.push("images", json!({"bufferView": jpeg}));
    builder.push("textures", json!({"source": 2, "sampler": 0}));
    let moved = json!({"KHR_texture_transform": {"offset": [0.5, 0], "rotation": 1, "scale": [2, 3], "texCoord": 1}});
    builder.json["materials"][0] = json!({
        "pbrMetallicRoughness": {
            "baseColorFactor": [0.5, 0.5, 0.5, 0.9],
            "baseColorTexture": {"index": 0, "extensions": moved},
            "metallicFactor": 0.5,
            "roughnessFactor": 0.5,
            "metallicRoughnessTexture": {"index": 1, "texCoord": 1},
        },
        "emissiveFactor": [1, 0.5, 0],
        "emissiveTexture": {"index": 1},
        "occlusionTexture": {"index": 1},
        "normalTexture": {"index": 2},
        "alphaMode": "MASK",
        "alphaCutoff": 0.4,
        "doubleSided": true,
        "extensions": {
            "KHR_materials_emissive_strength": {"emissiveStrength": 7},
            "KHR_materials_ior": {"ior": 1.3},
            "KHR_materials_specular": {
                "specularFactor": 0.5,
                "specularTexture": {"index": 0},
                "specularColorFactor": [1, 2, 0.5],
                "specularColorTexture": {"index": 1},
            },
        },
    });
    builder
}

/// A normal map without normals and tangents.
pub fn normal_map() -> Builder {
    let mut builder = Builder::textured();
    builder.json["materials"][0]["normalTexture"] = json!({"index": 0, "scale": 0.5});
    builder
}

/// A normal map with normals and tangents in one interleaved view.
pub fn given_tangents() -> Builder {
    let mut builder = normal_map();
    let vertex = floats(&[0., 0., 1., 1., 0., 0., -1.]);
    let view = builder.view(&vertex.repeat(4));
    builder.json["bufferViews"][view]["byteStride"] = json!(28);
    for (name, offset, shape) in [("NORMAL", 0, "VEC3"), ("TANGENT", 12, "VEC4")] {
        let accessor = json!({"bufferView": view, "byteOffset": offset, "componentType": F32, "type": shape, "count": 4});
        let accessor = builder.push("accessors", accessor);
        builder.attribute(name, accessor);
    }
    builder
}

/// 16-bit positions, 8-bit normals with padding, a strip without indices.
pub fn quantized_strip() -> Builder {
    let mut builder = Builder::square();
    let positions = shorts(&[0, 0, 0, 0, 100, 0, 0, 0, 0, 100, 0, 0, 100, 100, 0, 0]);
    let positions = builder.accessor(&positions, I16, "VEC3", 4);
    let normals = builder.accessor(&[0, 0, 127, 0].repeat(4), I8, "VEC3", 4);
    builder.json["accessors"][normals]["normalized"] = json!(true);
    for accessor in [positions, normals] {
        let view = builder.json["accessors"][accessor]["bufferView"]
            .as_u64()
            .unwrap_or(0) as usize;
        let stride = if accessor == positions { 8 } else { 4 };
        builder.json["bufferViews"][view]["byteStride"] = json!(stride);
    }
    builder.json["meshes"][0]["primitives"][0] = json!({
        "attributes": {"POSITION": positions, "NORMAL": normals},
        "mode": 5,
    });
    builder.json["extensionsUsed"] = json!(["KHR_mesh_quantization"]);
    builder.json["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
    builder
}

/// A fan of which one corner is moved by a sparse accessor over zeros.
pub fn sparse_fan() -> Builder {
    let mut builder = Builder::square();
    let indices = builder.view(&shorts(&[1, 2, 3]));
    let values = builder.view(&floats(&[1., 0., 0., 1., 1., 0., 0., 1., 0.]));
    builder.json["accessors"][0] = json!({
        "componentType": F32, "type": "VEC3", "count": 4,
        "sparse": {
            "count": 3,
            "indices": {"bufferView": indices, "componentType": U16},
            "values": {"bufferView": values},
        },
    });
    builder.json["meshes"][0]["primitives"][0] = json!({"attributes": {"POSITION": 0}, "mode": 6});
    builder
}

/// A hierarchy with cameras and lights.
pub fn nodes() -> Builder {
    let mut builder = Builder::square();
    builder.json["nodes"] = json!([
        {"name": "root", "translation": [1, 2, 3], "rotation": [0, 0.6, 0, 0.8], "scale": [1, -2, 3], "children": [1, 2]},
        {"name": "leaf", "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 5, 0, 0, 1], "mesh": 0, "camera": 0},
        {"children": [3, 4], "camera": 1, "extensions": {"KHR_lights_punctual": {"light": 0}}},
        {"mesh": 0, "extensions": {"KHR_lights_punctual": {"light": 1}}},
        {"name": "sun", "extensions": {"KHR_lights_punctual": {"light": 2}}},
    ]);
    builder.json["cameras"] = json!([
        {"name": "eye", "type": "perspective", "perspective": {"yfov": 0.8, "aspectRatio": 1.5, "znear": 0.1}},
        {"type": "orthographic", "orthographic": {"xmag": 2, "ymag": 1, "znear": 0, "zfar": 10}},
    ]);
    builder.json["extensionsUsed"] = json!(["KHR_lights_punctual"]);
    builder.json["extensions"] = json!({"KHR_lights_punctual": {"lights": [
        {"type": "point", "intensity": 10, "color": [1, 0.5, 0.25], "range": 20},
        {"type": "spot", "spot": {"innerConeAngle": 0.1, "outerConeAngle": 0.3}},
        {"type": "directional", "name": "sky"},
    ]}});
    builder
}

/// A skinned, morphed and animated mesh: the second joint turns, and a target bends the square.
pub fn skin() -> Builder {
    let mut builder = normal_map();
    let identity = [
        1., 0., 0., 0., 0., 1., 0., 0., 0., 0., 1., 0., 0., 0., 0., 1.,
    ];
    let bind = builder.accessor(&floats(&identity.repeat(2)), F32, "MAT4", 2);
    let joints = builder.accessor(&[0, 1, 0, 0].repeat(4), U8, "VEC4", 4);
    let weights = builder.floats(&[0.25, 0.75, 0., 0.].repeat(4), "VEC4");
    let normals = builder.floats(&[0., 0., 1.].repeat(4), "VEC3");
    builder.attribute("JOINTS_0", joints);
    builder.attribute("WEIGHTS_0", weights);
    builder.attribute("NORMAL", normals);
    let bent = builder.floats(&[0., 0., 0., 0., 0., 0., 0., 0., 1., 0., 0., 1.], "VEC3");
    let turned = builder.floats(&[0.5, 0., 0.].repeat(4), "VEC3");
    builder.json["meshes"][0]["primitives"][0]["targets"] =
        json!([{"POSITION": bent, "NORMAL": turned}, {"POSITION": bent}]);
    builder.json["meshes"][0]["weights"] = json!([0, 0.5]);
    builder.json["nodes"] = json!([
        {"mesh": 0, "skin": 0, "scale": [9, 9, 9]},
        {"translation": [0, 0, 4], "children": [2]},
        {"name": "elbow"},
    ]);
    builder.json["scenes"][0]["nodes"] = json!([0, 1]);
    builder.json["skins"] = json!([{"joints": [1, 2], "inverseBindMatrices": bind}]);
    let times = builder.floats(&[0., 1.], "SCALAR");
    let turns = builder.accessor(&shorts(&[0, 0, 0, 0x7FFF, 0, 0, 0x7FFF, 0]), I16, "VEC4", 2);
    builder.json["accessors"][turns]["normalized"] = json!(true);
    let morphs = builder.floats(&[0., 0., 1., 0.5], "SCALAR");
    builder.json["animations"] = json!([{
        "name": "wave",
        "samplers": [{"input": times, "output": turns}, {"input": times, "output": morphs}],
        "channels": [
            {"sampler": 0, "target": {"node": 2, "path": "rotation"}},
            {"sampler": 1, "target": {"node": 0, "path": "weights"}},
        ],
    }]);
    builder
}

/// A node that moves along a cubic and grows in steps.
pub fn spline() -> Builder {
    let mut builder = Builder::square();
    let times = builder.floats(&[0., 2.], "SCALAR");
    // In-tangent, value, out-tangent of each key: the curve (t³, 1, 0) exactly.
    let path = [
        0., 0., 0., 0., 1., 0., 0., 0., 0., 12., 0., 0., 8., 1., 0., 12., 0., 0.,
    ];
    let path = builder.floats(&path, "VEC3");
    let sizes = builder.floats(&[1., 1., 1., 2., 3., 4.], "VEC3");
    builder.json["animations"] = json!([{
        "samplers": [
            {"input": times, "output": path, "interpolation": "CUBICSPLINE"},
            {"input": times, "output": sizes, "interpolation": "STEP"},
        ],
        "channels": [
            {"sampler": 0, "target": {"node": 0, "path": "translation"}},
            {"sampler": 1, "target": {"node": 0, "path": "scale"}},
        ],
    }]);
    builder
}

/// Three squares by one node: moved, turned by a quarter about +Z, made larger.
pub fn instances() -> Builder {
    let mut builder = Builder::square();
    let moved = builder.floats(&[0., 0., 0., 5., 0., 0., 0., 5., 0.], "VEC3");
    let quarter = (0.5_f32.sqrt() * 32767.0).round() as u16;
    let turns = [0, 0, 0, 0x7FFF, 0, 0, quarter, quarter, 0, 0, 0, 0x7FFF];
    let turns = builder.accessor(&shorts(&turns), I16, "VEC4", 3);
    builder.json["accessors"][turns]["normalized"] = json!(true);
    let sizes = builder.floats(&[1., 1., 1., 1., 1., 1., 2., 3., 4.], "VEC3");
    builder.json["nodes"][0]["translation"] = json!([0, 0, 1]);
    builder.json["nodes"][0]["extensions"] = json!({"EXT_mesh_gpu_instancing": {
        "attributes": {"TRANSLATION": moved, "ROTATION": turns, "SCALE": sizes, "_ID": 0},
    }});
    builder.json["extensionsUsed"] = json!(["EXT_mesh_gpu_instancing"]);
    builder
}
