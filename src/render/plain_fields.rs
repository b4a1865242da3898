//! Fields of materials that nothing in a scene makes use of: all materials have the same there, and it is made of zeros and
//! ones, as most defaults of glTF are. They are literals in the shader, so nothing reads them, and what they do nothing to is
//! not compiled.

use super::layout::{Material, NONE, layouts};
use super::short_tables::fields_of;
use crate::shader::StructLayout;

/// The literal for a field of `Material`, of a type in the text `types`, if the field is plain in all materials that are used.
pub(super) fn plain_literal(
    types: &str,
    materials: &[Material],
    field: &str,
    kind: &str,
) -> Option<String> {
    let layout = layout_of("Material")?;
    let field = layout.fields.iter().find(|f| f.name == field)?;
    // What no instance shows is all zeros.
    let mut used = materials.iter().filter(|m| **m != Material::default());
    let bytes = |m| &bytemuck::bytes_of::<Material>(m)[field.offset..field.offset + field.size];
    let first = bytes(used.next()?);
    let same = used.all(|m| bytes(m) == first);
    same.then(|| literal(types, kind, bytemuck::cast_slice(first)))?
}

fn layout_of(name: &str) -> Option<StructLayout> {
    layouts().into_iter().find(|layout| layout.name == name)
}

/// A value of a type, if it is plain.
fn literal(types: &str, kind: &str, words: &[u32]) -> Option<String> {
    let list = |words: &[u32]| -> Option<String> {
        let numbers = words.iter().map(|word| number(*word));
        Some(numbers.collect::<Option<Vec<_>>>()?.join(", "))
    };
    match (kind, words) {
        ("u32", [0]) => Some("0u".into()),
        ("u32", [NONE]) => Some(format!("{NONE}u")),
        ("f32", [word]) => number(*word).map(str::to_owned),
        ("vec2f", [_, _]) | ("vec3f", [_, _, _]) | ("vec4f", [_, _, _, _]) => {
            Some(format!("{kind}({})", list(words)?))
        }
        _ => structure(types, kind, words),
    }
}

fn number(bits: u32) -> Option<&'static str> {
    match bits {
        0 => Some("0.0"),
        0x3f80_0000 => Some("1.0"),
        _ => None,
    }
}

fn structure(types: &str, name: &str, words: &[u32]) -> Option<String> {
    let layout = layout_of(name)?;
    let kinds = fields_of(types, name);
    let field = |f: &crate::shader::FieldLayout| {
        let (_, kind) = kinds.iter().find(|(name, _)| *name == f.name)?;
        literal(types, kind, &words[f.offset / 4..(f.offset + f.size) / 4])
    };
    let fields: Option<Vec<_>> = layout.fields.iter().map(field).collect();
    Some(format!("{name}({})", fields?.join(", ")))
}
