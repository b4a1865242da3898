//! Access to arrays in 64-bit integers, where a device is faster so: half as many gathers, which also compile in half the time.

use super::paged::{LARGE_ARRAYS, by_page, declarations};

/// Name and type of a field; of a vector there is one without a name.
type Field = (&'static str, &'static str);

/// What the entries of arrays that are read in double words consist of, as in `shaders/types.wgsl`.
const ENTRIES: [(&str, &[Field]); 5] = [
    (
        "Element",
        &[
            ("a", "vec4u"),
            ("b", "vec4u"),
            ("c", "vec4u"),
            ("d", "vec4u"),
        ],
    ),
    ("vec2f", &[("", "vec2f")]),
    ("vec4f", &[("", "vec4f")]),
    (
        "LightNode",
        &[
            ("center", "vec3f"),
            ("extent", "u32"),
            ("axis", "u32"),
            ("cones", "u32"),
            ("intensity", "f32"),
            ("link", "u32"),
        ],
    ),
    (
        "FilmPixel",
        &[
            ("sum", "vec3f"),
            ("count", "u32"),
            ("sum_low", "vec3f"),
            ("non_finite", "u32"),
            ("square", "vec3f"),
            ("closest_rays", "u32"),
            ("square_low", "vec3f"),
            ("any_rays", "u32"),
        ],
    ),
];

/// The fields of an entry, if it is read in double words.
pub(super) fn entry_fields(entry: &str) -> Option<&'static [Field]> {
    let (_, fields) = ENTRIES.iter().find(|(name, _)| *name == entry)?;
    Some(fields)
}

/// Numbers in a value of a type.
fn length(kind: &str) -> usize {
    match kind.strip_prefix("vec") {
        Some(rest) => usize::from(rest.as_bytes()[0] - b'0'),
        None => 1,
    }
}

/// Double words of an entry with such fields.
fn doublewords(fields: &[Field]) -> usize {
    fields.iter().map(|(_, kind)| length(kind)).sum::<usize>() / 2
}

/// One of the words of the double words `q0`, `q1`, ...
fn word(i: usize) -> String {
    let shift = ["", " >> 32u"][i % 2];
    format!("u32(q{}{shift})", i / 2)
}

/// Statements that return the entry that the double words `q0`, `q1`, ... are. Field by field: what a user's struct has more
/// is for the comparison with the host's to refuse.
fn return_entry(entry: &str, fields: &[Field]) -> String {
    let mut text = format!("    var entry: {entry};\n");
    let mut next = 0;
    for (name, kind) in fields {
        let count = length(kind);
        let words: Vec<_> = (next..next + count).map(word).collect();
        let words = words.join(", ");
        let value = match (*kind, count) {
            ("u32", _) => words,
            ("f32", _) => format!("bitcast<f32>({words})"),
            (_, _) if kind.ends_with('f') => format!("bitcast<{kind}>(vec{count}u({words}))"),
            _ => format!("{kind}({words})"),
        };
        let dot = if name.is_empty() { "" } else { "." };
        text += &format!("    entry{dot}{name} = {value};\n");
        next += count;
    }
    text + "    return entry;\n"
}

/// The words of an entry called `value`.
fn words_of(value: &str, fields: &[Field]) -> Vec<String> {
    let words = |(name, kind): &Field| -> Vec<String> {
        let field = format!("{value}.{name}");
        match *kind {
            "u32" => vec![field],
            _ => "xyzw"[..length(kind)]
                .chars()
                .map(|component| format!("bitcast<u32>({field}.{component})"))
                .collect(),
        }
    };
    fields.iter().flat_map(words).collect()
}

/// Bindings and accessor of an array with entries of such fields, in `pages` pages of 2^`page_bits`.
pub(super) fn array_wgsl(
    array: usize,
    fields: &[Field],
    pages: usize,
    page_bits: u32,
    first_binding: u32,
) -> String {
    let (name, entry, accessor) = LARGE_ARRAYS[array];
    let count = doublewords(fields);
    let mut text = declarations(name, "u64", pages, first_binding);
    for page in 0..pages {
        let reads: String = (1..count)
            .map(|i| format!("    let q{i} = {name}_{page}[first + {i}u];\n"))
            .collect();
        let value = return_entry(entry, fields);
        text +=
            &format!("fn {accessor}_{page}(first: u32, q0: u64) -> {entry} {{\n{reads}{value}}}\n");
    }
    let start = by_page(pages, page_bits, &|page| {
        format!("{name}_{page}[{count}u * offset]")
    });
    let rest = by_page(pages, page_bits, &|page| {
        format!("{accessor}_{page}({count}u * offset, start)")
    });
    text + &format!(
        "fn {accessor}_start(index: u32) -> u64 {{\n{start}}}\n\
         fn {accessor}_from(index: u32, start: u64) -> {entry} {{\n{rest}}}\n\
         fn {accessor}(index: u32) -> {entry} {{\n    \
         return {accessor}_from(index, {accessor}_start(index));\n}}\n"
    )
}

/// The film's binding and accessors, as [`film_wgsl`](super::paged::film_wgsl) has them.
pub(super) fn film_wgsl(declaration: impl Fn(&str) -> String) -> String {
    let (entry, fields) = ENTRIES[4];
    let count = doublewords(fields);
    let reads: String = (0..count)
        .map(|i| format!("    let q{i} = film[{count}u * index + {i}u];\n"))
        .collect();
    let write = |(i, words): (usize, &[String])| {
        let (low, high) = (&words[0], &words[1]);
        format!("    film[{count}u * index + {i}u] = u64({low}) | (u64({high}) << 32u);\n")
    };
    let words = words_of("pixel", fields);
    let writes: String = words.chunks_exact(2).enumerate().map(write).collect();
    let value = return_entry(entry, fields);
    declaration("u64")
        + &format!(
            "fn load_pixel(index: u32) -> FilmPixel {{\n{reads}{value}}}\n\
             fn store_pixel(index: u32, pixel: FilmPixel) {{\n{writes}}}\n"
        )
}
