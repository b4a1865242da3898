//! Access to arrays in 64-bit integers, where a device is faster so: half as many gathers, which also compile in half the time.

use super::paged::{LARGE_ARRAYS, by_page, declarations};

/// What the entries of arrays that are read in double words consist of: in the order of `shaders/types.wgsl` the types of
/// their fields.
const ENTRIES: [(&str, &[&str]); 5] = [
    ("Element", &["vec4u", "vec4u", "vec4u", "vec4u"]),
    ("vec2f", &["f32", "f32"]),
    ("vec4f", &["f32", "f32", "f32", "f32"]),
    ("LightNode", &["vec3f", "u32", "u32", "u32", "f32", "u32"]),
    (
        "FilmPixel",
        &[
            "vec3f", "u32", "vec3f", "u32", "vec3f", "u32", "vec3f", "u32",
        ],
    ),
];

/// The types of an entry's fields, if it is read in double words.
pub(super) fn entry_fields(entry: &str) -> Option<&'static [&'static str]> {
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
fn doublewords(fields: &[&str]) -> usize {
    fields.iter().map(|kind| length(kind)).sum::<usize>() / 2
}

/// One of the words of the double words `q0`, `q1`, ...
fn word(i: usize) -> String {
    let shift = ["", " >> 32u"][i % 2];
    format!("u32(q{}{shift})", i / 2)
}

/// The entry that the double words `q0`, `q1`, ... are.
fn entry_of(entry: &str, fields: &[&str]) -> String {
    let mut next = 0;
    let mut field = |kind: &&str| {
        let words: Vec<_> = (next..next + length(kind)).map(word).collect();
        next += words.len();
        let words = words.join(", ");
        match *kind {
            "u32" => words,
            "f32" => format!("bitcast<f32>({words})"),
            "vec3f" => format!("bitcast<vec3f>(vec3u({words}))"),
            _ => format!("{kind}({words})"),
        }
    };
    let fields: Vec<_> = fields.iter().map(&mut field).collect();
    format!("{entry}(\n        {},\n    )", fields.join(",\n        "))
}

/// Bindings and accessor of an array with entries of such fields, in `pages` pages of 2^`page_bits`.
pub(super) fn array_wgsl(
    array: usize,
    fields: &[&str],
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
        let value = entry_of(entry, fields);
        text += &format!(
            "fn {accessor}_{page}(first: u32, q0: u64) -> {entry} {{\n{reads}    return {value};\n}}\n"
        );
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
    let vectors = ["sum", "sum_low", "square", "square_low"];
    let scalars = ["count", "non_finite", "closest_rays", "any_rays"];
    let write = |i: usize| {
        let (vector, scalar) = (vectors[i / 2], scalars[i / 2]);
        let float = |component| format!("bitcast<u32>(pixel.{vector}.{component})");
        let [low, high] = match i % 2 {
            0 => [float("x"), float("y")],
            _ => [float("z"), format!("pixel.{scalar}")],
        };
        format!("    film[{count}u * index + {i}u] = u64({low}) | (u64({high}) << 32u);\n")
    };
    let writes: String = (0..count).map(write).collect();
    let value = entry_of(entry, fields);
    declaration("u64")
        + &format!(
            "fn load_pixel(index: u32) -> FilmPixel {{\n{reads}    return {value};\n}}\n\
             fn store_pixel(index: u32, pixel: FilmPixel) {{\n{writes}}}\n"
        )
}
