//! How the fields of materials are read: as a struct's, or from texels.

use super::array_wgsl::{Entry, Piece};
use super::layout::{Material, layouts};
use super::reading::Reading;
use super::wgsl_structs::fields_of;
use crate::shader::StructLayout;

const BINDING: u32 = 4;
/// Words of a texel.
const WORDS: usize = 4;

/// How the table of materials is declared and read.
pub(super) struct MaterialFields<'a> {
    types: &'a str,
    /// The host's struct, by which a field is found among the texels, if they are read.
    texels: Option<StructLayout>,
}

impl<'a> MaterialFields<'a> {
    /// Of a few materials all lanes read all, in a storage buffer.
    pub fn new(reading: Reading<'a>, is_short: bool) -> Self {
        let fields = fields_of(reading.types, "Material");
        // Where a user's struct has others, the comparison with the host's is to refuse it.
        let is_known = |layout: &StructLayout| {
            let has = |name: &str| layout.fields.iter().any(|f| f.name == name);
            layout.name == "Material" && fields.iter().all(|(name, _)| has(name))
        };
        let in_texels = reading.loads.texels && !is_short;
        let layout = || layouts().into_iter().find(is_known);
        Self {
            types: reading.types,
            texels: in_texels.then(layout).flatten(),
        }
    }

    /// The binding.
    pub fn declaration(&self) -> String {
        match self.texels {
            Some(_) => Piece::Texel(WORDS).declaration("materials", BINDING),
            None => format!(
                "@group(0) @binding({BINDING}) var<storage, read> materials: array<Material>;\n"
            ),
        }
    }

    /// What [`MaterialFields::entry`] calls.
    pub fn accessor(&self, field: &str, kind: &str) -> String {
        let entry = self.word_of(field).and_then(|word| {
            let texels = size_of::<Material>() / (4 * WORDS);
            let first = format!("{texels}u * i + {}u", word / WORDS);
            let entry = Entry::part(self.types, kind, word)?;
            Some(entry.accessor(&format!("texels_{field}"), "materials", &first))
        });
        entry.unwrap_or_default()
    }

    /// The field of material `i`.
    pub fn entry(&self, field: &str, i: &str) -> String {
        match self.word_of(field) {
            Some(_) => format!("texels_{field}({i})"),
            None => format!("materials[{i}].{field}"),
        }
    }

    /// Where a field begins in a material's texels.
    fn word_of(&self, field: &str) -> Option<usize> {
        let fields = &self.texels.as_ref()?.fields;
        let field = fields.iter().find(|f| f.name == field)?;
        Some(field.offset / 4)
    }
}
