//! What well-formed files mean: each feature of glTF in a file made for it.

mod gltf_common;
mod gltf_seeds;

use etendue::scene::*;
use glam::{DVec3, Vec2, Vec3, Vec4};
use gltf_common::*;
use serde_json::json;

fn warned(scene: &Scene, part: &str) {
    assert!(
        scene.warnings.iter().any(|warning| warning.contains(part)),
        "{part:?} is not in {:?}",
        scene.warnings
    );
}

/// A warning whether or not the scene has it must be absent.
fn silent(scene: &Scene) {
    assert_eq!(scene.warnings, Vec::<String>::new());
}

fn square_positions() -> Vec<Vec3> {
    SQUARE.chunks(3).map(Vec3::from_slice).collect()
}

#[test]
fn both_forms_of_a_file_hold_the_same_scene() {
    let builder = Builder::textured();
    let glb = builder.scene();
    let folder = tempfile::TempDir::new().expect("a temporary folder");
    std::fs::create_dir(folder.path().join("a b")).expect("writable");
    std::fs::write(folder.path().join("a b/data.bin"), &builder.bin).expect("writable");
    let mut external = builder.json.clone();
    external["buffers"] = json!([{"uri": "a%20b/data.bin", "byteLength": builder.bin.len()}]);
    let text = format!("\u{FEFF}  {external}");
    let gltf = load_in(folder.path(), "scene.whatever", text.as_bytes()).expect("the same scene");
    assert_eq!(gltf.meshes[0].positions, glb.meshes[0].positions);
    assert_eq!(gltf.meshes[0].indices, [[0, 1, 2], [0, 2, 3]]);
    assert_eq!(gltf.meshes[0].name, "square");
    assert_eq!(gltf.instances[0].name, "node");
    silent(&gltf);
    // The hash covers the file and what it refers to.
    let mut hasher = blake3::Hasher::new();
    hasher.update(text.as_bytes()).update(&builder.bin);
    assert_eq!(gltf.hash, *hasher.finalize().as_bytes());
}

#[test]
fn data_uris_hold_buffers_and_images() {
    use base64::Engine;
    let mut builder = Builder::textured();
    let encode = |bytes: &[u8]| {
        format!(
            "data:application/gltf-buffer;base64,{}",
            base64::engine::general_purpose::STANDARD.encode(bytes)
        )
    };
    builder.json["images"] = json!([{"uri": encode(&png_rgba8())}]);
    builder.json["buffers"] =
        json!([{"uri": encode(&builder.bin), "byteLength": builder.bin.len()}]);
    let scene = load_bytes(builder.json.to_string().as_bytes()).expect("it is well-formed");
    assert_eq!(scene.triangle_count(), 2);
    assert_eq!((scene.images[0].width, scene.images[0].height), (2, 2));
}

#[test]
fn every_component_type_is_read() {
    for (component, normalized, bytes, expected) in [
        (I8, false, vec![0x80, 0x7F, 1, 0], [-128.0, 127.0, 1.0]),
        (I8, true, vec![0x80, 0x7F, 0, 0], [-1.0, 1.0, 0.0]),
        (U8, false, vec![255, 1, 0, 0], [255.0, 1.0, 0.0]),
        (U8, true, vec![255, 51, 0, 0], [1.0, 0.2, 0.0]),
        (
            I16,
            false,
            shorts(&[0x8000, 0x7FFF, 1, 0]),
            [-32768.0, 32767.0, 1.0],
        ),
        (I16, true, shorts(&[0x8000, 0x7FFF, 0, 0]), [-1.0, 1.0, 0.0]),
        (U16, false, shorts(&[65535, 1, 0, 0]), [65535.0, 1.0, 0.0]),
        (U16, true, shorts(&[65535, 13107, 0, 0]), [1.0, 0.2, 0.0]),
        (
            U32,
            false,
            words(&[1 << 31, 1, 0, 0]),
            [2147483648.0, 1.0, 0.0],
        ),
        (
            F32,
            false,
            floats(&[1.5, -2.5, 1e30, 0.0]),
            [1.5, -2.5, 1e30],
        ),
    ] {
        let mut builder = Builder::square();
        let stride = bytes.len();
        let accessor = builder.accessor(&bytes.repeat(4), component, "VEC3", 4);
        let view = builder.json["accessors"][accessor]["bufferView"]
            .as_u64()
            .expect("a view") as usize;
        builder.json["bufferViews"][view]["byteStride"] = json!(stride);
        builder.json["accessors"][accessor]["normalized"] = json!(normalized);
        builder.attribute("POSITION", accessor);
        let scene = builder.scene();
        assert_eq!(
            scene.meshes[0].positions[1],
            Vec3::from_array(expected),
            "{component} {normalized}"
        );
    }
}

#[test]
fn unaligned_data_is_read() {
    let mut builder = Builder::square();
    builder.bin.push(7);
    let positions = builder.accessor(&floats(&SQUARE), F32, "VEC3", 4);
    builder.attribute("POSITION", positions);
    assert_eq!(builder.scene().meshes[0].positions, square_positions());
}

#[test]
fn indices_of_every_size_are_read() {
    for (bytes, component) in [
        (vec![0, 1, 2], U8),
        (shorts(&[0, 1, 2]), U16),
        (words(&[0, 1, 2]), U32),
    ] {
        let mut builder = Builder::square();
        let indices = builder.accessor(&bytes, component, "SCALAR", 3);
        builder.json["meshes"][0]["primitives"][0]["indices"] = json!(indices);
        assert_eq!(builder.scene().meshes[0].indices, [[0, 1, 2]]);
    }
}

#[test]
fn quantised_strips_and_sparse_fans_are_squares() {
    let strip = gltf_seeds::quantized_strip().scene();
    assert_eq!(strip.meshes[0].indices, [[0, 1, 2], [1, 3, 2]]);
    assert_eq!(strip.meshes[0].positions[3], Vec3::new(100.0, 100.0, 0.0));
    assert_eq!(strip.meshes[0].normals, [Vec3::Z; 4]);
    silent(&strip);
    let fan = gltf_seeds::sparse_fan().scene();
    assert_eq!(fan.meshes[0].indices, [[1, 2, 0], [2, 3, 0]]);
    assert_eq!(fan.meshes[0].positions, square_positions());
}

#[test]
fn unused_vertices_are_left_out() {
    let mut builder = Builder::square();
    let indices = builder.accessor(&[1, 2, 3], U8, "SCALAR", 3);
    builder.json["meshes"][0]["primitives"][0]["indices"] = json!(indices);
    let scene = builder.scene();
    assert_eq!(scene.meshes[0].positions, square_positions()[1..]);
    assert_eq!(scene.meshes[0].indices, [[0, 1, 2]]);
}

#[test]
fn what_has_no_surface_is_skipped_with_a_warning() {
    for (mode, word) in [(0, "points"), (1, "lines"), (2, "lines"), (3, "lines")] {
        let mut builder = Builder::square();
        builder.json["meshes"][0]["primitives"][0]["mode"] = json!(mode);
        let scene = builder.scene();
        assert_eq!(scene.triangle_count(), 0);
        warned(
            &scene,
            &format!("mesh 0 \"square\", primitive 0: it consists of {word}"),
        );
    }
    let mut builder = Builder::square();
    builder.json["meshes"][0]["primitives"][0]["attributes"] = json!({});
    warned(&builder.scene(), "it has no POSITION; it is skipped");
    let mut builder = Builder::square();
    builder.json["accessors"][1]["count"] = json!(5);
    let scene = builder.scene();
    assert_eq!(scene.triangle_count(), 1);
    warned(
        &scene,
        "5 corners, which is no multiple of 3; the last 2 are skipped",
    );
}

#[test]
fn normals_become_unit_vectors() {
    let mut builder = Builder::square();
    let normals = builder.accessor(
        &floats(&[0., 0., 5., 0., 3e-30, 0., 0., 0., 0., f32::NAN, 0., 0.]),
        F32,
        "VEC3",
        4,
    );
    builder.attribute("NORMAL", normals);
    let scene = builder.scene();
    assert_eq!(
        scene.meshes[0].normals,
        [Vec3::Z, Vec3::Y, Vec3::Z, Vec3::Z]
    );
    warned(&scene, "2 of its normals have no direction");
    assert!(Builder::square().scene().meshes[0].normals.is_empty());
}

#[test]
fn tangents_are_made_where_a_normal_map_needs_them() {
    assert!(Builder::textured().scene().meshes[0].tangents.is_empty());
    let made = gltf_seeds::normal_map().scene();
    assert_eq!(made.meshes[0].tangents, [Vec4::new(1.0, 0.0, 0.0, 1.0); 4]);
    let given = gltf_seeds::given_tangents().scene();
    assert_eq!(
        given.meshes[0].tangents,
        [Vec4::new(1.0, 0.0, 0.0, -1.0); 4]
    );
    silent(&given);
    let mut builder = gltf_seeds::normal_map();
    builder.json["meshes"][0]["primitives"][0]["attributes"] = json!({"POSITION": 0});
    builder.json["materials"][0]["pbrMetallicRoughness"] = json!({});
    let scene = builder.scene();
    assert!(scene.meshes[0].tangents.is_empty() && !Features::of(&scene).normal_texture);
    warned(
        &scene,
        "it has no TEXCOORD_0; the normal map of material 0 \"paint\" is not used",
    );
}

#[test]
fn missing_texture_coordinates_are_zero() {
    let mut builder = Builder::textured();
    builder.json["meshes"][0]["primitives"][0]["attributes"] = json!({"POSITION": 0});
    let scene = builder.scene();
    assert_eq!(scene.meshes[0].tex_coords[0], [Vec2::ZERO; 4]);
    warned(
        &scene,
        "it has no TEXCOORD_0; the textures of material 0 \"paint\" show a single texel",
    );
}

#[test]
fn higher_sets_of_texture_coordinates_take_the_place_of_unused_ones() {
    let mut builder = Builder::textured();
    let uvs = builder.accessor(&floats(&[0.5; 8]), F32, "VEC2", 4);
    builder.attribute("TEXCOORD_3", uvs);
    builder.json["materials"][0]["emissiveTexture"] = json!({"index": 0, "texCoord": 3});
    builder.json["materials"][0]["emissiveFactor"] = json!([1, 1, 1]);
    let scene = builder.scene();
    assert_eq!(scene.meshes[0].tex_coords[1], [Vec2::splat(0.5); 4]);
    assert_eq!(
        scene.materials[0]
            .emissive_texture
            .map(|slot| slot.tex_coord),
        Some(1)
    );
}

#[test]
fn vertex_colours_of_every_type_are_read() {
    let half = Vec4::new(0.5, 0.25, 1.0, 1.0);
    for (component, shape, bytes) in [
        (F32, "VEC3", floats(&[0.5, 0.25, 1.0])),
        (F32, "VEC4", floats(&[0.5, 0.25, 1.0, 1.0])),
        (U8, "VEC4", vec![128, 64, 255, 255]),
        (U16, "VEC3", shorts(&[32768, 16384, 65535])),
    ] {
        let mut builder = Builder::square();
        let colors = builder.accessor(&bytes.repeat(4), component, shape, 4);
        builder.json["accessors"][colors]["normalized"] = json!(component != F32);
        builder.attribute("COLOR_0", colors);
        let scene = builder.scene();
        assert!(
            scene.meshes[0]
                .colors
                .iter()
                .all(|c| c.abs_diff_eq(half, 3e-3)),
            "{:?}",
            scene.meshes[0].colors
        );
        silent(&scene);
    }
}

#[test]
fn transforms_are_composed_in_double_precision() {
    let scene = gltf_seeds::nodes().scene();
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
    let scene = gltf_seeds::nodes().scene();
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
    let scene = gltf_seeds::nodes().scene();
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
fn materials_have_all_their_properties() {
    let scene = gltf_seeds::textured().scene();
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
    assert_eq!(m.texture_slots().count(), 5);
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
    let scene = gltf_seeds::textured().scene();
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
    builder.json["materials"][0]["extensions"] =
        json!({"KHR_materials_ior": {"ior": 0}, "KHR_materials_unlit": {}});
    let scene = builder.scene();
    let m = &scene.materials[0];
    assert_eq!(
        (m.roughness, m.metallic, m.emissive.x, m.ior, m.unlit),
        (1.0, 0.0, 3.0, 0.0, true)
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
fn images_of_every_kind_are_decoded() {
    use image::ExtendedColorType as Color;
    let decode = |bytes: &[u8]| {
        let mut builder = Builder::textured();
        let view = builder.view(bytes);
        builder.json["images"][0]["bufferView"] = json!(view);
        builder.scene().images.remove(0)
    };
    let eight = |bytes: &[u8]| match decode(bytes).texels {
        Texels::Rgba8(texels) => texels,
        Texels::Rgba16(_) => panic!("8 bits were expected"),
    };
    let sixteen = |bytes: &[u8]| match decode(bytes).texels {
        Texels::Rgba16(texels) => texels,
        Texels::Rgba8(_) => panic!("16 bits were expected"),
    };
    assert_eq!(eight(&png(1, 1, Color::L8, &[7])), [[7, 7, 7, 255]]);
    assert_eq!(eight(&png(1, 1, Color::La8, &[7, 9])), [[7, 7, 7, 9]]);
    assert_eq!(eight(&png(1, 1, Color::Rgb8, &[1, 2, 3])), [[1, 2, 3, 255]]);
    assert_eq!(eight(&png_rgba8())[3], [255, 255, 255, 128]);
    let wide = |values: &[u16]| {
        values
            .iter()
            .flat_map(|v| v.to_ne_bytes())
            .collect::<Vec<u8>>()
    };
    assert_eq!(
        sixteen(&png(1, 1, Color::L16, &wide(&[777]))),
        [[777, 777, 777, 65535]]
    );
    assert_eq!(
        sixteen(&png(1, 1, Color::Rgb16, &wide(&[1, 2, 3]))),
        [[1, 2, 3, 65535]]
    );
    assert_eq!(
        sixteen(&png(1, 1, Color::Rgba16, &wide(&[1, 2, 3, 4]))),
        [[1, 2, 3, 4]]
    );
    let jpeg = eight(&jpeg_gray());
    assert!(
        jpeg.len() == 64 && jpeg.iter().all(|t| t[0].abs_diff(100) <= 1 && t[3] == 255),
        "{jpeg:?}"
    );
}

#[test]
fn an_image_used_twice_is_decoded_once() {
    let mut builder = Builder::textured();
    builder.push("textures", json!({"source": 0, "sampler": 0}));
    builder.json["samplers"] = json!([{}]);
    let again = builder.json["images"][0].clone();
    builder.push("images", again);
    builder.push("textures", json!({"source": 1}));
    builder.json["materials"][0]["emissiveFactor"] = json!([1, 1, 1]);
    builder.json["materials"][0]["emissiveTexture"] = json!({"index": 1});
    builder.json["materials"][0]["pbrMetallicRoughness"]["metallicRoughnessTexture"] =
        json!({"index": 2});
    let scene = builder.scene();
    assert_eq!((scene.textures.len(), scene.images.len()), (3, 1));
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
fn skins_morphs_and_animations_show_their_rest_pose() {
    let scene = gltf_seeds::skin().scene();
    for part in [
        "node 0: its skin is not posed",
        "mesh 0 \"square\": its morph targets",
        "its animation is not played",
    ] {
        warned(&scene, part);
        assert!(
            scene
                .warnings
                .iter()
                .all(|warning| warning.contains("rest pose"))
        );
    }
    // The skinned mesh follows its joint and not its node.
    assert_eq!(
        scene.instances[0].to_world.transform_point3(DVec3::ZERO),
        DVec3::new(0.0, 0.0, 4.0)
    );
    assert_eq!(scene.instances[0].to_world.determinant(), 1.0);
}

#[test]
fn flattened_geometry_is_allowed() {
    let mut builder = Builder::square();
    builder.json["nodes"][0]["scale"] = json!([1, 0, 1]);
    assert_eq!(builder.scene().instances[0].to_world.determinant(), 0.0);
}

#[test]
fn extensions_that_are_only_used_are_warnings() {
    let mut builder = Builder::textured();
    builder.json["extensionsUsed"] = json!(["KHR_materials_clearcoat", "ACME_secret"]);
    builder.json["materials"][0]["extensions"] = json!({"KHR_materials_sheen": {}});
    builder.json["extras"] = json!({"extensions": {"NOT_one": {}}});
    let scene = builder.scene();
    let names: Vec<&str> = scene
        .extensions
        .iter()
        .map(|extension| extension.name.as_str())
        .collect();
    assert_eq!(
        names,
        [
            "ACME_secret",
            "KHR_materials_clearcoat",
            "KHR_materials_sheen"
        ]
    );
    warned(
        &scene,
        "KHR_materials_clearcoat is not supported: the picture does not show clear coats",
    );
    warned(&scene, "KHR_materials_sheen is not supported");
}

#[test]
fn positions_that_are_not_finite_are_kept_and_told() {
    let mut builder = Builder::square();
    let mut positions = SQUARE;
    positions[3] = f32::INFINITY;
    let positions = builder.accessor(&floats(&positions), F32, "VEC3", 4);
    builder.attribute("POSITION", positions);
    let scene = builder.scene();
    warned(&scene, "1 of its positions are not finite");
    assert_eq!(
        scene.bounds(),
        Some((DVec3::ZERO, DVec3::new(1.0, 1.0, 0.0)))
    );
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
    let scene = gltf_seeds::textured().scene();
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
    let lights = Features::of(&gltf_seeds::nodes().scene());
    assert!(
        lights.point_light && lights.spot_light && lights.directional_light && lights.light_range
    );
    assert!(Features::all().flags().iter().all(|flag| flag.1));
}

#[test]
fn summaries_count_instances() {
    let summary = Summary::of(&gltf_seeds::nodes().scene());
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
