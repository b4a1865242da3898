//! Fields of materials that nothing in a scene makes use of: all materials have the same there, and it is made of zeros and
//! ones, as most defaults of glTF are. They are literals in the shader, so nothing reads them, and what they do nothing to is
//! not compiled.

use super::layout::{Material, NONE, layouts};
use super::wgsl_structs::fields_of;
use crate::shader::StructLayout;

/// The materials of a scene, where their fields are plain.
pub(super) struct PlainFields<'a> {
    /// The text with the shader's structs.
    types: &'a str,
    /// The host's structs.
    layouts: Vec<StructLayout>,
    /// What no instance shows is all zeros, and not among them.
    used: Vec<&'a Material>,
}

impl<'a> PlainFields<'a> {
    /// Of materials whose struct, and those that it contains, are in the text `types`.
    pub fn new(types: &'a str, materials: &'a [Material]) -> Self {
        let is_used = |m: &&Material| **m != Material::default();
        Self {
            types,
            layouts: layouts(),
            used: materials.iter().filter(is_used).collect(),
        }
    }

    /// The value of a field, of a type, for which `read` stands where it is not plain: a literal, `read` itself, or the
    /// struct of both. None if nothing of it is plain.
    pub fn value(&self, field: &str, kind: &str, read: &str) -> Option<String> {
        let layout = self.layout_of("Material")?;
        let field = layout.fields.iter().find(|f| f.name == field)?;
        self.value_at(field.offset, field.size, kind, read)
    }

    fn value_at(&self, offset: usize, size: usize, kind: &str, read: &str) -> Option<String> {
        match self.layout_of(kind) {
            Some(layout) => self.structure(offset, layout, read),
            None => literal(kind, self.shared_words(offset, size)?),
        }
    }

    /// The words that all materials have somewhere, if they are the same.
    fn shared_words(&self, offset: usize, size: usize) -> Option<&'a [u32]> {
        let words = |m: &'a Material| &bytemuck::bytes_of(m)[offset..offset + size];
        let (first, others) = self.used.split_first()?;
        let same = others.iter().all(|m| words(m) == words(first));
        same.then(|| bytemuck::cast_slice(words(first)))
    }

    fn layout_of(&self, name: &str) -> Option<&StructLayout> {
        self.layouts.iter().find(|layout| layout.name == name)
    }

    fn structure(&self, offset: usize, layout: &StructLayout, read: &str) -> Option<String> {
        let mut plain = false;
        let mut values = Vec::new();
        for (name, kind) in fields_of(self.types, layout.name) {
            let field = layout.fields.iter().find(|f| f.name == name)?;
            let part = format!("{read}.{name}");
            let value = self.value_at(offset + field.offset, field.size, kind, &part);
            plain |= value.is_some();
            values.push(value.unwrap_or(part));
        }
        plain.then(|| format!("{}({})", layout.name, values.join(", ")))
    }
}

/// A value of a type, if it is plain.
fn literal(kind: &str, words: &[u32]) -> Option<String> {
    match (kind, words) {
        ("u32", [0]) => Some("0u".into()),
        ("u32", [NONE]) => Some(format!("{NONE}u")),
        ("f32", [word]) => number(*word).map(str::to_owned),
        ("vec2f" | "vec3f" | "vec4f", _) => {
            let numbers: Option<Vec<_>> = words.iter().map(|word| number(*word)).collect();
            Some(format!("{kind}({})", numbers?.join(", ")))
        }
        _ => None,
    }
}

fn number(bits: u32) -> Option<&'static str> {
    match bits {
        0 => Some("0.0"),
        0x3f80_0000 => Some("1.0"),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::layout::TextureSlot;
    use crate::shader::ShaderLibrary;

    #[test]
    fn what_all_used_materials_have_alike_and_plain_is_a_literal() {
        let slot = TextureSlot {
            matrix: [1.0, 0.0, 0.0, 1.0],
            texture: NONE,
            ..TextureSlot::default()
        };
        let one = Material {
            specular_color: [1.0; 3],
            roughness: 0.5,
            base_color_texture: slot,
            normal_texture: slot,
            ..Material::default()
        };
        let other = Material {
            metallic: 1.0,
            normal_texture: TextureSlot { texture: 3, ..slot },
            ..one
        };
        // The last one is shown by no instance.
        let materials = [one, other, Material::default()];
        let library = ShaderLibrary::embedded();
        let types = library.read("types.wgsl").expect("types.wgsl");
        let plain = PlainFields::new(types, &materials);
        let value = |field, kind| plain.value(field, kind, "read");
        let is = |text: &str| Some(text.to_owned());
        assert_eq!(value("specular_color", "vec3f"), is("vec3f(1.0, 1.0, 1.0)"));
        assert_eq!(value("sheen_roughness", "f32"), is("0.0"));
        assert_eq!(value("flags", "u32"), is("0u"));
        assert_eq!(value("roughness", "f32"), None, "neither zero nor one");
        assert_eq!(value("metallic", "f32"), None, "not alike");
        assert_eq!(value("no_such_field", "f32"), None);
        let matrix = "TextureSlot(vec4f(1.0, 0.0, 0.0, 1.0), vec2f(0.0, 0.0)";
        let none = format!("{matrix}, {NONE}u, 0u)");
        assert_eq!(value("base_color_texture", "TextureSlot"), Some(none));
        let read = format!("{matrix}, read.texture, 0u)");
        assert_eq!(value("normal_texture", "TextureSlot"), Some(read));
        assert_eq!(
            PlainFields::new(types, &[]).value("metallic", "f32", "read"),
            None
        );
    }
}
