//! How shaders read large arrays in pieces of more than a word, where a device is faster so: fewer gathers, which also
//! compile in less time.

use super::reading::{Array, by_page};
use super::wgsl_structs::{fields_of, numbers_in};
use crate::gpu::Loads;

/// A field of an entry, or a whole entry that is a vector: its name, empty for the latter, and its type.
type Field<'a> = (&'a str, &'a str);

/// What is read at once.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Piece {
    /// A 64-bit integer.
    DoubleWord,
    /// A texel of so many words: 1, 2 or 4.
    Texel(usize),
}

impl Piece {
    fn words(self) -> usize {
        match self {
            Self::DoubleWord => 2,
            Self::Texel(words) => words,
        }
    }

    /// The type of a variable that holds one.
    pub fn kind(self) -> &'static str {
        match self {
            Self::DoubleWord => "u64",
            Self::Texel(_) => "vec4u",
        }
    }

    /// The declaration of an array of them.
    pub fn declaration(self, name: &str, binding: u32) -> String {
        let at = format!("@group(0) @binding({binding})");
        match self {
            Self::DoubleWord => format!("{at} var<storage, read> {name}: array<u64>;\n"),
            Self::Texel(words) => {
                let format = ["r32uint", "rg32uint", "rgba32uint"][words.ilog2() as usize];
                format!("{at} var {name}: texture_storage_1d<{format}, read>;\n")
            }
        }
    }

    /// The piece of an array at a place.
    fn read(self, array: &str, place: &str) -> String {
        match self {
            Self::DoubleWord => format!("{array}[{place}]"),
            Self::Texel(_) => format!("textureLoad({array}, {place})"),
        }
    }

    /// One of the words of the pieces `q0`, `q1`, ...
    fn word(self, i: usize) -> String {
        let (piece, part) = (i / self.words(), i % self.words());
        match self {
            Self::DoubleWord => format!("u32(q{piece}{})", ["", " >> 32u"][part]),
            Self::Texel(_) => format!("q{piece}.{}", ["x", "y", "z", "w"][part]),
        }
    }
}

/// An array's entry that is read in pieces.
pub(super) struct Entry<'a> {
    kind: &'a str,
    fields: Vec<Field<'a>>,
    piece: Piece,
    /// Pieces in which it lies.
    count: usize,
    /// Words before it in the first of them.
    skipped: usize,
}

impl<'a> Entry<'a> {
    /// An entry of a type, whose struct is in the text `types`; none if nothing is faster than words, it does not consist of
    /// such pieces, or it has fields that are not made of words, or are placed by an attribute.
    pub fn new(types: &'a str, kind: &'a str, loads: Loads) -> Option<Self> {
        let fields = match numbers_in(kind) {
            Some(_) => vec![("", kind)],
            None => fields_of(types, kind),
        };
        // A name with an attribute has an offset of its own.
        if fields.iter().any(|(name, _)| name.contains('@')) {
            return None;
        }
        let numbers: Option<usize> = fields.iter().map(|(_, kind)| numbers_in(kind)).sum();
        let words = numbers.filter(|words| *words > 0)?;
        let pieces = [4, 2, 1].map(Piece::Texel);
        let texel = pieces.into_iter().filter(|_| loads.texels);
        let doubleword = loads.doublewords.then_some(Piece::DoubleWord);
        let piece = texel
            .chain(doubleword)
            .find(|piece| words.is_multiple_of(piece.words()))?;
        Some(Self {
            kind,
            fields,
            piece,
            count: words / piece.words(),
            skipped: 0,
        })
    }

    /// The part of a larger entry that begins so many words after that, in texels of four words; none if its type has fields
    /// that are not made of words.
    pub fn part(types: &'a str, kind: &'a str, first_word: usize) -> Option<Self> {
        let texels = Loads {
            doublewords: false,
            texels: true,
        };
        let entry = Self::new(types, kind, texels)?;
        let (words, skipped) = (entry.count * entry.piece.words(), first_word % 4);
        Some(Self {
            piece: Piece::Texel(4),
            count: (skipped + words).div_ceil(4),
            skipped,
            ..entry
        })
    }

    /// A function that returns it, reading an array from the piece `first` on.
    pub fn accessor(&self, name: &str, array: &str, first: &str) -> String {
        let reads = self.reads(0, array, |i| format!("{first} + {i}u"));
        let (kind, value) = (self.kind, self.assembly());
        format!("fn {name}(i: u32) -> {kind} {{\n{reads}{value}}}\n")
    }

    /// The same of entry `i` of an array of nothing else.
    fn indexed_accessor(&self, name: &str, array: &str) -> String {
        self.accessor(name, array, &format!("{}u * i", self.count))
    }

    /// What it is read in.
    pub fn piece(&self) -> Piece {
        self.piece
    }

    /// Statements that read the pieces `q{first}`, ... of an entry of an array; `place` gives where each is.
    fn reads(&self, first: usize, array: &str, place: impl Fn(usize) -> String) -> String {
        let read = |i| format!("    let q{i} = {};\n", self.piece.read(array, &place(i)));
        (first..self.count).map(read).collect()
    }

    /// Statements that return the entry that the pieces `q0`, `q1`, ... are. Field by field: what a user's struct has more is
    /// for the comparison with the host's to refuse.
    fn assembly(&self) -> String {
        let mut text = format!("    var entry: {};\n", self.kind);
        let mut words = (self.skipped..).map(|i| self.piece.word(i));
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

/// The accessor of an array, which is declared in `pages` pages of 2^`page_bits`.
pub(super) fn in_pieces(
    (name, kind, accessor): Array<'_>,
    entry: &Entry<'_>,
    pages: usize,
    page_bits: u32,
) -> String {
    // No function that only calls another: each takes time to compile, wherever it is called.
    if pages == 1 {
        return entry.indexed_accessor(accessor, &format!("{name}_0"));
    }
    let of_page =
        |page| entry.indexed_accessor(&format!("{accessor}_{page}"), &format!("{name}_{page}"));
    let by_page = by_page(pages, page_bits, &|page| {
        format!("{accessor}_{page}(offset)")
    });
    let of_pages: String = (0..pages).map(of_page).collect();
    of_pages + &format!("fn {accessor}(index: u32) -> {kind} {{\n{by_page}}}\n")
}

/// The same, and two more: of an entry's first piece, and of the rest after that.
pub(super) fn in_pieces_ahead(
    (name, kind, accessor): Array<'_>,
    entry: &Entry<'_>,
    pages: usize,
    page_bits: u32,
) -> String {
    let (count, first_kind) = (entry.count, entry.piece.kind());
    let mut text = String::new();
    for page in 0..pages {
        let reads = entry.reads(1, &format!("{name}_{page}"), |i| format!("first + {i}u"));
        let value = entry.assembly();
        text += &format!(
            "fn {accessor}_{page}(first: u32, q0: {first_kind}) -> {kind} {{\n{reads}{value}}}\n"
        );
    }
    let start = by_page(pages, page_bits, &|page| {
        let first = format!("{count}u * offset");
        entry.piece.read(&format!("{name}_{page}"), &first)
    });
    let rest = by_page(pages, page_bits, &|page| {
        format!("{accessor}_{page}({count}u * offset, start)")
    });
    text + &format!(
        "fn {accessor}_start(index: u32) -> {first_kind} {{\n{start}}}\n\
         fn {accessor}_from(index: u32, start: {first_kind}) -> {kind} {{\n{rest}}}\n\
         fn {accessor}(index: u32) -> {kind} {{\n    \
         return {accessor}_from(index, {accessor}_start(index));\n}}\n"
    )
}

/// The film's accessors in double words, as [`Reading::film`](super::reading::Reading::film) has them.
pub(super) fn film_accessors(pixel: &Entry<'_>) -> String {
    let count = pixel.count;
    let place = |i| format!("{count}u * index + {i}u");
    let write = |(i, words): (usize, &[String])| {
        let (low, high) = (&words[0], &words[1]);
        let place = place(i);
        format!("    film[{place}] = u64({low}) | (u64({high}) << 32u);\n")
    };
    let words = pixel.words_of("pixel");
    let writes: String = words.chunks_exact(2).enumerate().map(write).collect();
    let load = pixel.indexed_accessor("load_pixel", "film");
    format!(
        "{load}\
         fn store_pixel(index: u32, pixel: FilmPixel) {{\n{writes}}}\n"
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shader::ShaderLibrary;

    const DOUBLE_WORDS: Loads = Loads {
        doublewords: true,
        texels: false,
    };
    const TEXELS: Loads = Loads {
        doublewords: false,
        texels: true,
    };
    const ENTRIES: [&str; 6] = ["Element", "vec2f", "vec4f", "LightNode", "FilmPixel", "u32"];

    #[test]
    fn entries_are_those_of_the_shader_s_text() {
        let library = ShaderLibrary::embedded();
        let types = library.read("types.wgsl").expect("types.wgsl");
        let count = |kind| Entry::new(types, kind, DOUBLE_WORDS).map(|entry| entry.count);
        let counts = ENTRIES.map(count);
        assert_eq!(
            counts,
            [Some(8), Some(1), Some(2), Some(4), Some(8), None],
            "a u32 is half a double word"
        );
        assert_eq!(count("NoSuchStruct"), None);
        let odd = "struct Odd {\n    a: vec3f,\n}\nstruct Placed {\n    @size(16) a: vec2f,\n}\nstruct Long {\n    a: vec2<f32>,\n}\n";
        for kind in ["Odd", "Placed", "Long"] {
            assert!(Entry::new(odd, kind, DOUBLE_WORDS).is_none(), "{kind}");
        }
        assert!(Entry::new(types, "Element", Loads::default()).is_none());
    }

    #[test]
    fn texels_are_as_large_as_an_entry_allows() {
        let library = ShaderLibrary::embedded();
        let types = library.read("types.wgsl").expect("types.wgsl");
        let texels = ENTRIES.map(|kind| {
            let entry = Entry::new(types, kind, TEXELS).expect("any words");
            (entry.count, entry.piece.words())
        });
        assert_eq!(texels, [(4, 4), (1, 2), (1, 4), (2, 4), (4, 4), (1, 1)]);
    }
}
