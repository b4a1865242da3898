//! Access to tables of a few entries: every entry is read at an address that is the same for all lanes, and the one that
//! a lane asks for is selected. A CPU reads such an address once, where entries of their own are gathered lane by lane.
//! Fields of materials that are plain ([`PlainFields`]) are not read at all.

use std::fmt::Write;

use super::layout::{LIGHT_KIND_SHIFT, LIGHT_TRIANGLE, Material};
use super::material_fields::MaterialFields;
use super::plain_fields::PlainFields;
use super::prepared::Prepared;
use super::reading::Reading;
use super::wgsl_structs::fields_of;
use crate::shader::{ShaderError, ShaderLibrary, VirtualFiles};

/// Entries of a short table.
const SHORT: usize = 8;

/// Pairs of triangles that emit, of which all are read; an element is four times as large as a light.
const SHORT_PAIRS: usize = 4;

/// What is known of a scene's tables: materials, and numbers of entries; nothing and 0 where they are not known.
#[derive(Default)]
struct Known<'a> {
    materials: &'a [Material],
    textures: usize,
    lights: usize,
}

/// Names of the scene's tables of a few entries.
pub(super) fn short_tables(scene: &Prepared) -> Vec<&'static str> {
    let counts = [
        ("materials", scene.materials.len()),
        ("textures", scene.textures.textures.len()),
        ("lights", scene.lights.table.len()),
    ];
    let short = counts.into_iter().filter(|(_, count)| is_short(*count));
    short.map(|(name, _)| name).collect()
}

fn is_short(count: usize) -> bool {
    (1..=SHORT).contains(&count)
}

/// The generated files by which a scene's lights, materials and textures are read.
pub fn table_files(scene: &Prepared, reading: Reading<'_>) -> VirtualFiles {
    let known = Known {
        materials: &scene.materials,
        textures: scene.textures.textures.len(),
        lights: scene.lights.table.len(),
    };
    files(&known, &short_pairs(scene), reading)
}

/// The same for a scene that is not known: no table is short.
///
/// # Errors
/// `types.wgsl` of the library, where the fields of structs are, cannot be read.
pub fn long_tables(library: &ShaderLibrary) -> Result<VirtualFiles, ShaderError> {
    let reading = Reading {
        types: library.read("types.wgsl")?,
        ..Reading::default()
    };
    Ok(files(&Known::default(), &[], reading))
}

/// `material_table.wgsl`, for each field of a material `fn material_FIELD(i: u32)`, and `fn texture_at(i: u32) -> Texture`;
/// `light_table.wgsl`, `fn light_at(i: u32) -> Light`, and `fn light_pair(id: u32) -> Element`, which gives the element of
/// an emissive triangle's pair, one of those of the lights `firsts`, if there are such.
fn files(known: &Known<'_>, firsts: &[usize], reading: Reading<'_>) -> VirtualFiles {
    let types = reading.types;
    let table = |name: &str, kind: &str, count: usize, entry: &dyn Fn(&str) -> String| {
        let body = table_access(types, kind, count, entry);
        format!("fn {name}(i: u32) -> {kind} {{\n{body}}}\n")
    };
    let plain = PlainFields::new(types, known.materials);
    let fields = MaterialFields::new(reading, is_short(known.materials.len()));
    let material = |(field, kind): &(&str, &str)| {
        let entry = |i: &str| fields.entry(field, i);
        let read = |name: &str| {
            fields.accessor(field, kind) + &table(name, kind, known.materials.len(), &entry)
        };
        let Some(value) = plain.value(field, kind, &format!("read_{field}(i)")) else {
            return read(&format!("material_{field}"));
        };
        // What of it is no literal is read.
        read(&format!("read_{field}"))
            + &format!("fn material_{field}(i: u32) -> {kind} {{\n    return {value};\n}}\n")
    };
    let materials: String = fields_of(types, "Material").iter().map(material).collect();
    let texture = |i: &str| format!("load_texture({i})");
    let textures = table("texture_at", "Texture", known.textures, &texture);
    let light = |i: &str| format!("load_light({i})");
    let lights = table("light_at", "Light", known.lights, &light);
    VirtualFiles::from([
        (
            "light_table.wgsl".into(),
            lights + &light_pair(types, firsts),
        ),
        (
            "material_table.wgsl".into(),
            fields.declaration() + &materials + &textures,
        ),
    ])
}

/// The body of a function that gives the entry `i`, of a type, of a table with so many entries.
fn table_access(types: &str, kind: &str, count: usize, entry: impl Fn(&str) -> String) -> String {
    if !is_short(count) {
        return format!("    return {};\n", entry("i"));
    }
    let at = |i: usize| entry(&format!("{i}u"));
    selection(count, &parts_of(types, kind), at, |i| format!("i == {i}u"))
}

/// The fields of a struct, each as `.NAME`; of another type the whole, which is no field.
fn parts_of(types: &str, kind: &str) -> Vec<String> {
    match &fields_of(types, kind)[..] {
        [] => vec![String::new()],
        fields => fields.iter().map(|(name, _)| format!(".{name}")).collect(),
    }
}

/// Of each pair with lights the first entry that is one of its triangles; none if these are not few.
fn short_pairs(scene: &Prepared) -> Vec<usize> {
    let table = &scene.lights.table;
    if scene.bvh.has_instances() || table.len() > SHORT {
        return Vec::new();
    }
    let mut firsts: Vec<(u32, usize)> = Vec::new();
    for (i, light) in table.iter().enumerate() {
        let kind = light.kind_and_index >> LIGHT_KIND_SHIFT;
        let pair = (light.kind_and_index ^ kind << LIGHT_KIND_SHIFT) >> 1;
        let is_triangle = kind == LIGHT_TRIANGLE;
        if is_triangle && firsts.iter().all(|(known, _)| *known != pair) {
            firsts.push((pair, i));
        }
    }
    if firsts.len() > SHORT_PAIRS {
        firsts.clear();
    }
    firsts.into_iter().map(|(_, i)| i).collect()
}

fn light_pair(types: &str, firsts: &[usize]) -> String {
    let mut text = String::from("fn light_pair(id: u32) -> Element {\n");
    if firsts.is_empty() {
        return text + "    return load_element(id >> 1u);\n}\n";
    }
    for (k, i) in firsts.iter().enumerate() {
        let _ = writeln!(
            text,
            "    let pair{k} = (load_light({i}u).kind_and_index & LIGHT_INDEX_MASK) >> 1u;"
        );
    }
    let entry = |k: usize| format!("load_element_uniform(pair{k})");
    let is_it = |k: usize| format!("id >> 1u == pair{k}");
    text + &selection(firsts.len(), &parts_of(types, "Element"), entry, is_it) + "}\n"
}

/// The body of a function that gives the entry for which `is_it` is true, or the first; `parts` are those of which it
/// consists, each selected by itself.
fn selection(
    count: usize,
    parts: &[String],
    entry: impl Fn(usize) -> String,
    is_it: impl Fn(usize) -> String,
) -> String {
    let mut text = format!("    var found = {};\n", entry(0));
    for i in 1..count {
        let _ = writeln!(text, "    let entry{i} = {};", entry(i));
        for part in parts {
            let _ = writeln!(
                text,
                "    found{part} = select(found{part}, entry{i}{part}, {});",
                is_it(i)
            );
        }
    }
    text + "    return found;\n"
}
