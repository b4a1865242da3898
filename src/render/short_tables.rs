//! Access to tables of a few entries: every entry is read at an address that is the same for all lanes, and the one that
//! a lane asks for is selected. A CPU reads such an address once, where entries of their own are gathered lane by lane.

use std::fmt::{Display, Write};

use super::layout::{LIGHT_KIND_SHIFT, LIGHT_TRIANGLE, Light};
use super::prepared::Prepared;
use crate::shader::{ShaderError, ShaderLibrary, VirtualFiles};

/// Entries of a short table.
const SHORT: usize = 8;

/// Pairs of triangles that emit, of which all are read; an element is four times as large as a light.
const SHORT_PAIRS: usize = 4;

/// The generated files by which a scene's lights, materials and textures are read.
///
/// # Errors
/// `types.wgsl` of the library, where the fields of structs are, cannot be read.
pub fn table_files(library: &ShaderLibrary, scene: &Prepared) -> Result<VirtualFiles, ShaderError> {
    let (materials, textures) = (scene.materials.len(), scene.textures.textures.len());
    let of_materials = material_table_wgsl(library, materials, textures)?;
    Ok(VirtualFiles::from([
        ("light_table.wgsl".into(), light_table_wgsl(scene)),
        ("material_table.wgsl".into(), of_materials),
    ]))
}

/// The `light_table.wgsl` of a scene: `fn light_at(i: u32) -> Light`, and `fn light_pair(id: u32) -> Element`, which
/// gives the element of an emissive triangle's pair.
fn light_table_wgsl(scene: &Prepared) -> String {
    let table = &scene.lights.table;
    if !(1..=SHORT).contains(&table.len()) {
        return long_light_table();
    }
    let pairs = first_of_pairs(table);
    let is_short = !scene.bvh.has_instances() && pairs.len() <= SHORT_PAIRS;
    let pairs = if is_short { &pairs[..] } else { &[] };
    light_at(table.len()) + &light_pair(pairs)
}

/// The same for a scene that is not known: no table is short.
///
/// # Errors
/// As [`table_files`].
pub fn long_tables(library: &ShaderLibrary) -> Result<VirtualFiles, ShaderError> {
    Ok(VirtualFiles::from([
        ("light_table.wgsl".into(), long_light_table()),
        (
            "material_table.wgsl".into(),
            material_table_wgsl(library, 0, 0)?,
        ),
    ]))
}

fn long_light_table() -> String {
    light_at(0) + &light_pair(&[])
}

/// The `material_table.wgsl` of a scene with so many materials and textures, 0 if that is not known: for each field of a
/// material `fn material_FIELD(i: u32)`, and `fn texture_at(i: u32) -> Texture`.
fn material_table_wgsl(
    library: &ShaderLibrary,
    materials: usize,
    textures: usize,
) -> Result<String, ShaderError> {
    let types = library.read("types.wgsl")?;
    let accessor = |(field, kind): &(&str, &str)| {
        let entry = |i: &str| format!("materials[{i}].{field}");
        let body = table_access(types, kind, materials, entry);
        format!("fn material_{field}(i: u32) -> {kind} {{\n{body}}}\n")
    };
    let of_materials: String = fields_of(types, "Material").iter().map(accessor).collect();
    let texture = table_access(types, "Texture", textures, |i| format!("textures[{i}]"));
    Ok(of_materials + &format!("fn texture_at(i: u32) -> Texture {{\n{texture}}}\n"))
}

/// The body of a function that gives the entry `i`, of a type, of a table with so many entries.
fn table_access(types: &str, kind: &str, count: usize, entry: impl Fn(&str) -> String) -> String {
    if !(1..=SHORT).contains(&count) {
        return format!("    return {};\n", entry("i"));
    }
    let parts: Vec<String> = match &fields_of(types, kind)[..] {
        [] => vec![String::new()],
        parts => parts.iter().map(|(name, _)| format!(".{name}")).collect(),
    };
    let at = |i: usize| entry(&format!("{i}u"));
    selection(count, &parts, at, |i| format!("i == {i}u"))
}

/// Names and types of the fields of a struct in a text; none if it has no such struct.
fn fields_of<'a>(text: &'a str, name: &str) -> Vec<(&'a str, &'a str)> {
    let mut lines = text.lines();
    if !lines.any(|line| line.trim() == format!("struct {name} {{")) {
        return Vec::new();
    }
    let inside = lines.take_while(|line| line.trim() != "}");
    let field = |line: &'a str| {
        let (name, kind) = line.split("//").next()?.split_once(':')?;
        Some((name.trim(), kind.trim().trim_end_matches(',')))
    };
    inside.filter_map(field).collect()
}

/// Of each pair with lights the first entry that is one of its triangles.
fn first_of_pairs(table: &[Light]) -> Vec<usize> {
    let mut firsts: Vec<(u32, usize)> = Vec::new();
    for (i, light) in table.iter().enumerate() {
        let kind = light.kind_and_index >> LIGHT_KIND_SHIFT;
        let pair = (light.kind_and_index ^ kind << LIGHT_KIND_SHIFT) >> 1;
        let is_triangle = kind == LIGHT_TRIANGLE;
        if is_triangle && firsts.iter().all(|(known, _)| *known != pair) {
            firsts.push((pair, i));
        }
    }
    firsts.into_iter().map(|(_, i)| i).collect()
}

fn light_at(count: usize) -> String {
    if count == 0 {
        return "fn light_at(i: u32) -> Light {\n    return lights[i];\n}\n".into();
    }
    let fields = [
        ".threshold",
        ".alias_index",
        ".probability",
        ".kind_and_index",
    ];
    let entry = |i: usize| format!("lights[{i}]");
    let is_it = |i: usize| format!("i == {i}u");
    let body = selection(count, &fields, entry, is_it);
    format!("fn light_at(i: u32) -> Light {{\n{body}}}\n")
}

fn light_pair(firsts: &[usize]) -> String {
    if firsts.is_empty() {
        return "fn light_pair(id: u32) -> Element {\n    return load_element(id >> 1u);\n}\n"
            .into();
    }
    let mut text = String::from("fn light_pair(id: u32) -> Element {\n");
    for (k, i) in firsts.iter().enumerate() {
        let _ = writeln!(
            text,
            "    let pair{k} = (lights[{i}].kind_and_index & LIGHT_INDEX_MASK) >> 1u;"
        );
    }
    let entry = |k: usize| format!("load_element(pair{k})");
    let is_it = |k: usize| format!("id >> 1u == pair{k}");
    text + &selection(firsts.len(), &[".a", ".b", ".c", ".d"], entry, is_it) + "}\n"
}

/// The body of a function that gives the entry for which `is_it` is true, or the first; `parts` are those of which it
/// consists, each selected by itself.
fn selection(
    count: usize,
    parts: &[impl Display],
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
