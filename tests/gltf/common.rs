//! Small glTF files for the loader's tests.

use std::fs;
use std::path::{Path, PathBuf};

use etendue::scene::gltf::{LoadError, LoadOptions, load, load_slice};
use etendue::scene::{Scene, Selector};
use glam::{DVec3, Vec3};
use serde_json::{Value, json};
use tempfile::TempDir;

use crate::pictures::png_rgba8;

pub const I8: u32 = 5120;
pub const U8: u32 = 5121;
pub const I16: u32 = 5122;
pub const U16: u32 = 5123;
pub const U32: u32 = 5125;
pub const F32: u32 = 5126;

/// A glTF file under construction, with one buffer.
#[derive(Debug, Clone)]
pub struct Builder {
    pub json: Value,
    pub bin: Vec<u8>,
}

/// Little-endian bytes of floats.
pub fn floats(values: &[f32]) -> Vec<u8> {
    values
        .iter()
        .flat_map(|value| value.to_le_bytes())
        .collect()
}

/// Little-endian bytes of 16-bit integers.
pub fn shorts(values: &[u16]) -> Vec<u8> {
    values
        .iter()
        .flat_map(|value| value.to_le_bytes())
        .collect()
}

/// Little-endian bytes of 32-bit integers.
pub fn words(values: &[u32]) -> Vec<u8> {
    values
        .iter()
        .flat_map(|value| value.to_le_bytes())
        .collect()
}

/// The corners of the unit square in the plane z = 0, counter-clockwise.
pub const SQUARE: [f32; 12] = [0., 0., 0., 1., 0., 0., 1., 1., 0., 0., 1., 0.];
/// Texture coordinates that show a picture upright on it.
pub const UPRIGHT: [f32; 8] = [0., 1., 1., 1., 1., 0., 0., 0.];

impl Builder {
    /// An empty scene.
    pub fn empty() -> Self {
        Self {
            json: json!({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": []}]}),
            bin: Vec::new(),
        }
    }

    /// A scene of one node with one mesh: the unit square, two indexed triangles.
    pub fn square() -> Self {
        let mut builder = Self::empty();
        let positions = builder.accessor(&floats(&SQUARE), F32, "VEC3", 4);
        let indices = builder.accessor(&shorts(&[0, 1, 2, 0, 2, 3]), U16, "SCALAR", 6);
        builder.json["meshes"] = json!([{
            "name": "square",
            "primitives": [{"attributes": {"POSITION": positions}, "indices": indices}],
        }]);
        builder.json["nodes"] = json!([{"name": "node", "mesh": 0}]);
        builder.json["scenes"] = json!([{"nodes": [0]}]);
        builder
    }

    /// The square with texture coordinates, a material and a texture of 2 × 2 pixels.
    pub fn textured() -> Self {
        let mut builder = Self::square();
        let uvs = builder.accessor(&floats(&UPRIGHT), F32, "VEC2", 4);
        builder.json["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] = json!(uvs);
        builder.json["meshes"][0]["primitives"][0]["material"] = json!(0);
        let view = builder.view(&png_rgba8());
        builder.json["images"] =
            json!([{"name": "checks", "bufferView": view, "mimeType": "image/png"}]);
        builder.json["textures"] = json!([{"source": 0}]);
        builder.json["materials"] = json!([{
            "name": "paint",
            "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}},
        }]);
        builder
    }

    /// Append bytes as a buffer view, and return its index.
    pub fn view(&mut self, bytes: &[u8]) -> usize {
        let view = json!({"buffer": 0, "byteOffset": self.bin.len(), "byteLength": bytes.len()});
        self.bin.extend_from_slice(bytes);
        self.push("bufferViews", view)
    }

    /// Append an accessor over its own buffer view, and return its index.
    pub fn accessor(&mut self, bytes: &[u8], component: u32, shape: &str, count: usize) -> usize {
        let view = self.view(bytes);
        self.push(
            "accessors",
            json!({"bufferView": view, "componentType": component, "type": shape, "count": count}),
        )
    }

    /// Append to a list of the file, and return the index.
    pub fn push(&mut self, list: &str, value: Value) -> usize {
        if self.json[list].is_null() {
            self.json[list] = json!([]);
        }
        let list = self.json[list].as_array_mut().expect("a list");
        list.push(value);
        list.len() - 1
    }

    /// Give the square an attribute.
    pub fn attribute(&mut self, name: &str, accessor: usize) {
        self.json["meshes"][0]["primitives"][0]["attributes"][name] = json!(accessor);
    }

    /// The bytes of the .glb file.
    pub fn glb(&self) -> Vec<u8> {
        let mut file = self.json.clone();
        if !self.bin.is_empty() {
            if file["buffers"].is_null() {
                file["buffers"] = json!([{}]);
            }
            file["buffers"][0]["byteLength"] = json!(self.bin.len());
        }
        let mut text = file.to_string().into_bytes();
        text.resize(text.len().next_multiple_of(4), b' ');
        let mut bin = self.bin.clone();
        bin.resize(bin.len().next_multiple_of(4), 0);
        let length = 12 + 8 + text.len() + 8 + bin.len();
        let mut bytes = b"glTF".to_vec();
        bytes.extend(words(&[2, length as u32, text.len() as u32, 0x4E4F_534A]));
        bytes.extend(text);
        bytes.extend(words(&[bin.len() as u32, 0x004E_4942]));
        bytes.extend(bin);
        bytes
    }

    /// Load it as a .glb file.
    pub fn load(&self) -> Result<Scene, LoadError> {
        load_bytes(&self.glb())
    }

    /// Load it as a .glb file that must be right, and whose scene must be valid.
    pub fn scene(&self) -> Scene {
        let scene = self.load().unwrap_or_else(|error| panic!("{error}"));
        scene.validate().unwrap_or_else(|error| panic!("{error}"));
        scene
    }

    /// Load it as a .glb file that must be right, posed by its animation `animation` at a moment.
    pub fn scene_at(&self, animation: usize, seconds: f64) -> Scene {
        let options = LoadOptions {
            animation: Some(Selector::Index(animation)),
            at: Some(seconds),
            ..LoadOptions::default()
        };
        let scene = self.load_with(&options);
        let scene = scene.unwrap_or_else(|error| panic!("{error}"));
        scene.validate().unwrap_or_else(|error| panic!("{error}"));
        scene
    }

    /// Load it as a .glb file in a folder of its own.
    pub fn load_with(&self, options: &LoadOptions) -> Result<Scene, LoadError> {
        load_slice(Path::new("scene.gltf"), &self.glb(), options)
    }

    /// Append floats as an accessor, and return its index.
    pub fn floats(&mut self, values: &[f32], shape: &str) -> usize {
        let components = match shape {
            "SCALAR" => 1,
            "VEC2" => 2,
            "VEC3" => 3,
            "VEC4" => 4,
            _ => 16,
        };
        self.accessor(&floats(values), F32, shape, values.len() / components)
    }

    /// Append an animation of one channel, and return its index.
    pub fn animate(
        &mut self,
        (node, path): (usize, &str),
        interpolation: &str,
        times: &[f32],
        output: usize,
    ) -> usize {
        let input = self.floats(times, "SCALAR");
        self.push(
            "animations",
            json!({
                "samplers": [{"input": input, "output": output, "interpolation": interpolation}],
                "channels": [{"sampler": 0, "target": {"node": node, "path": path}}],
            }),
        )
    }

    /// The sentence with which it is refused when posed by its first animation.
    pub fn pose_error(&self) -> String {
        let options = LoadOptions {
            at: Some(0.5),
            ..LoadOptions::default()
        };
        match self.load_with(&options) {
            Ok(_) => panic!("it loaded, but must not: {}", self.json),
            Err(error) => error.to_string(),
        }
    }

    /// The sentence with which it is refused.
    pub fn error(&self) -> String {
        match self.load() {
            Ok(_) => panic!("it loaded, but must not: {}", self.json),
            Err(error) => error.to_string(),
        }
    }
}

/// Load a file with this content.
pub fn load_bytes(bytes: &[u8]) -> Result<Scene, LoadError> {
    let folder = TempDir::new().expect("a temporary folder");
    load_in(folder.path(), "scene.gltf", bytes)
}

/// Write a file into a folder and load it.
pub fn load_in(folder: &Path, name: &str, bytes: &[u8]) -> Result<Scene, LoadError> {
    let path = folder.join(name);
    fs::write(&path, bytes).expect("the temporary folder can be written");
    load(&path, &LoadOptions::default())
}

/// The folder of things made by others, if present.
pub fn shared(folder: &str) -> Option<PathBuf> {
    let beside = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared");
    let root = std::env::var_os("ETENDUE_SHARED").map_or(beside, PathBuf::from);
    let path = root.join(folder);
    if !path.is_dir() {
        eprintln!("{} is not there; the test passes over it", path.display());
    }
    path.is_dir().then_some(path)
}

/// Change the square at a JSON pointer's parent and expect a sentence with these parts.
pub fn refused(builder: Builder, parts: &[&str]) {
    let sentence = builder.error();
    assert!(sentence.contains("scene.gltf: "), "{sentence}");
    assert!(!sentence.contains('\n'), "{sentence}");
    for part in parts {
        assert!(sentence.contains(part), "{part:?} is not in: {sentence}");
    }
}

/// The textured square with a value set at a JSON pointer.
pub fn with(pointer: &str, value: Value) -> Builder {
    let mut builder = Builder::textured();
    set(&mut builder.json, pointer, value);
    builder
}

pub fn set(json: &mut Value, pointer: &str, value: Value) {
    let mut at = json;
    for key in pointer.split('/') {
        at = match key.parse::<usize>() {
            Ok(index) => &mut at[index],
            Err(_) => &mut at[key],
        };
    }
    *at = value;
}

/// The scene has a warning with this part.
pub fn warned(scene: &Scene, part: &str) {
    assert!(
        scene.warnings.iter().any(|warning| warning.contains(part)),
        "{part:?} is not in {:?}",
        scene.warnings
    );
}

/// The scene has no warning.
pub fn silent(scene: &Scene) {
    assert_eq!(scene.warnings, Vec::<String>::new());
}

/// The corners of the square.
pub fn square_positions() -> Vec<Vec3> {
    SQUARE.chunks(3).map(Vec3::from_slice).collect()
}

/// The positions of an instance's mesh in the world.
pub fn world_positions(scene: &Scene, instance: usize) -> Vec<DVec3> {
    let instance = &scene.instances[instance];
    let positions = scene.meshes[instance.mesh].positions.iter();
    positions
        .map(|p| instance.to_world.transform_point3(p.as_dvec3()))
        .collect()
}

/// All points agree within rounding of f32.
pub fn assert_close(found: &[DVec3], expected: &[[f64; 3]]) {
    assert_eq!(found.len(), expected.len());
    for (found, &expected) in found.iter().zip(expected) {
        assert!(
            found.abs_diff_eq(DVec3::from(expected), 2e-7),
            "{found}, not {expected:?}"
        );
    }
}
