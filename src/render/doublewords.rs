//! Access to arrays in 64-bit integers, where a device is faster so: half as many gathers, which also compile in half the time.

use super::paged::{LARGE_ARRAYS, by_page, declarations};
use super::wgsl_structs::{fields_of, numbers_in};

/// A field of an entry, or a whole entry that is a vector: its name, empty for the latter, and its type.
type Field<'a> = (&'a str, &'a str);

/// An array's entry that is read in double words.
pub(super) struct Entry<'a> {
    kind: &'a str,
    fields: Vec<Field<'a>>,
    /// Double words that it consists of.
    count: usize,
}

impl<'a> Entry<'a> {
    /// An entry of a type, whose struct is in the text `types`; none if it has no even number of words, or fields that
    /// are not made of words, or are placed by an attribute.
    pub fn new(types: &'a str, kind: &'a str) -> Option<Self> {
        let fields = match numbers_in(kind) {
            Some(_) => vec![("", kind)],
            None => fields_of(types, kind),
        };
        // A name with an attribute has an offset of its own.
        if fields.iter().any(|(name, _)| name.contains('@')) {
            return None;
        }
        let numbers: Option<usize> = fields.iter().map(|(_, kind)| numbers_in(kind)).sum();
        let words = numbers.filter(|words| *words > 0 && words.is_multiple_of(2))?;
        Some(Self {
            kind,
            fields,
            count: words / 2,
        })
    }

    /// Statements that read the double words `q{first}`, ... of an entry; `address` gives where each is.
    fn reads(&self, first: usize, address: impl Fn(usize) -> String) -> String {
        let read = |i| format!("    let q{i} = {};\n", address(i));
        (first..self.count).map(read).collect()
    }

    /// Statements that return the entry that the double words `q0`, `q1`, ... are. Field by field: what a user's struct has
    /// more is for the comparison with the host's to refuse.
    fn assembly(&self) -> String {
        let mut text = format!("    var entry: {};\n", self.kind);
        let mut words = (0..).map(word);
        for (name, kind) in &self.fields {
            let count = numbers_in(kind).unwrap_or_default();
            let words: Vec<_> = words.by_ref().take(count).collect();
            let words = words.join(", ");
            let value = match count {
                1 => format!("bitcast<{kind}>({words})"),
                _ => format!("bitcast<{kind}>(vec{count}u({words}))"),
            };
            let dot = if name.is_empty() { "" } else { "." };
            text += &format!("    entry{dot}{name} = {value};\n");
        }
        text + "    return entry;\n"
    }

    /// The words of an entry called `value`, which is a struct.
    fn words_of(&self, value: &str) -> Vec<String> {
        let words = |(name, kind): &Field<'_>| -> Vec<String> {
            let bits = |part: String| format!("bitcast<u32>({part})");
            match numbers_in(kind).unwrap_or_default() {
                1 => vec![bits(format!("{value}.{name}"))],
                count => "xyzw"[..count]
                    .chars()
                    .map(|component| bits(format!("{value}.{name}.{component}")))
                    .collect(),
            }
        };
        self.fields.iter().flat_map(words).collect()
    }
}

/// One of the words of the double words `q0`, `q1`, ...
fn word(i: usize) -> String {
    let shift = ["", " >> 32u"][i % 2];
    format!("u32(q{}{shift})", i / 2)
}

/// Bindings and accessor of one of the large arrays, in `pages` pages of 2^`page_bits`.
pub(super) fn array_wgsl(
    array: usize,
    entry: &Entry<'_>,
    pages: usize,
    page_bits: u32,
    first_binding: u32,
) -> String {
    let (name, kind, accessor) = LARGE_ARRAYS[array];
    let mut text = declarations(name, "u64", pages, first_binding);
    for page in 0..pages {
        let reads = entry.reads(1, |i| format!("{name}_{page}[first + {i}u]"));
        let value = entry.assembly();
        text +=
            &format!("fn {accessor}_{page}(first: u32, q0: u64) -> {kind} {{\n{reads}{value}}}\n");
    }
    let count = entry.count;
    let start = by_page(pages, page_bits, &|page| {
        format!("{name}_{page}[{count}u * offset]")
    });
    let rest = by_page(pages, page_bits, &|page| {
        format!("{accessor}_{page}({count}u * offset, start)")
    });
    text + &format!(
        "fn {accessor}_start(index: u32) -> u64 {{\n{start}}}\n\
         fn {accessor}_from(index: u32, start: u64) -> {kind} {{\n{rest}}}\n\
         fn {accessor}(index: u32) -> {kind} {{\n    \
         return {accessor}_from(index, {accessor}_start(index));\n}}\n"
    )
}

/// The film's accessors, as [`film_wgsl`](super::paged::film_wgsl) has them.
pub(super) fn film_accessors(pixel: &Entry<'_>) -> String {
    let count = pixel.count;
    let address = |i| format!("film[{count}u * index + {i}u]");
    let write = |(i, words): (usize, &[String])| {
        let (low, high) = (&words[0], &words[1]);
        let address = address(i);
        format!("    {address} = u64({low}) | (u64({high}) << 32u);\n")
    };
    let words = pixel.words_of("pixel");
    let writes: String = words.chunks_exact(2).enumerate().map(write).collect();
    let (reads, value) = (pixel.reads(0, address), pixel.assembly());
    format!(
        "fn load_pixel(index: u32) -> FilmPixel {{\n{reads}{value}}}\n\
         fn store_pixel(index: u32, pixel: FilmPixel) {{\n{writes}}}\n"
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shader::ShaderLibrary;

    #[test]
    fn entries_are_those_of_the_shader_s_text() {
        let library = ShaderLibrary::embedded();
        let types = library.read("types.wgsl").expect("types.wgsl");
        let count = |kind| Entry::new(types, kind).map(|entry| entry.count);
        let counts = ["Element", "vec2f", "vec4f", "LightNode", "FilmPixel"].map(count);
        assert_eq!(counts, [8, 1, 2, 4, 8].map(Some));
        assert_eq!(count("u32"), None, "half a double word");
        assert_eq!(count("NoSuchStruct"), None);
        let odd = "struct Odd {\n    a: vec3f,\n}\nstruct Placed {\n    @size(16) a: vec2f,\n}\nstruct Long {\n    a: vec2<f32>,\n}\n";
        for kind in ["Odd", "Placed", "Long"] {
            assert!(Entry::new(odd, kind).is_none(), "{kind}");
        }
    }
}
