//! Access to arrays in 64-bit integers, where a device is faster so: half as many gathers, which also compile in half the time.

use super::paged::{LARGE_ARRAYS, by_page, declarations};

/// Double words of an [`Element`](crate::accel::Element) and of a [`FilmPixel`](super::layout::FilmPixel).
const COUNT: usize = 8;

/// Bindings and accessors of an array of elements, in `pages` pages of 2^`page_bits`.
pub(super) fn elements_wgsl(pages: usize, page_bits: u32, first_binding: u32) -> String {
    let (name, _, accessor) = LARGE_ARRAYS[0];
    let mut text = declarations(name, "u64", pages, first_binding);
    for page in 0..pages {
        let reads: String = (1..COUNT)
            .map(|i| format!("    let q{i} = {name}_{page}[first + {i}u];\n"))
            .collect();
        let vector = |i: usize| format!("vec4u({}, {})", words(2 * i), words(2 * i + 1));
        let vectors = [0, 1, 2, 3].map(vector).join(",\n        ");
        text += &format!(
            "fn {accessor}_{page}(first: u32, q0: u64) -> Element {{\n{reads}    \
             return Element(\n        {vectors},\n    );\n}}\n"
        );
    }
    let start = by_page(pages, page_bits, &|page| {
        format!("{name}_{page}[8u * offset]")
    });
    let rest = by_page(pages, page_bits, &|page| {
        format!("{accessor}_{page}(8u * offset, start)")
    });
    text + &format!(
        "alias ElementStart = u64;\n\
         fn {accessor}_start(index: u32) -> ElementStart {{\n{start}}}\n\
         fn {accessor}_from(index: u32, start: ElementStart) -> Element {{\n{rest}}}\n\
         fn {accessor}(index: u32) -> Element {{\n    \
         return {accessor}_from(index, {accessor}_start(index));\n}}\n"
    )
}

/// Both words of double word `q{i}`.
fn words(i: usize) -> String {
    format!("u32(q{i}), u32(q{i} >> 32u)")
}

/// The film's binding and accessors, as [`film_wgsl`](super::paged::film_wgsl) has them.
pub(super) fn film_wgsl(declaration: impl Fn(&str) -> String) -> String {
    let vectors = ["sum", "sum_low", "square", "square_low"];
    let scalars = ["count", "non_finite", "closest_rays", "any_rays"];
    let mut reads = String::new();
    let mut writes = String::new();
    for i in 0..COUNT {
        let (vector, scalar) = (vectors[i / 2], scalars[i / 2]);
        let float = |component| format!("bitcast<u32>(pixel.{vector}.{component})");
        let [low, high] = match i % 2 {
            0 => [float("x"), float("y")],
            _ => [float("z"), format!("pixel.{scalar}")],
        };
        reads += &format!("    let q{i} = film[8u * index + {i}u];\n");
        writes += &format!("    film[8u * index + {i}u] = u64({low}) | (u64({high}) << 32u);\n");
    }
    let part = |i: usize| {
        let (low, high) = (words(2 * i), 2 * i + 1);
        format!("bitcast<vec3f>(vec3u({low}, u32(q{high}))), u32(q{high} >> 32u)")
    };
    let parts = [0, 1, 2, 3].map(part).join(",\n        ");
    declaration("u64")
        + &format!(
            "fn load_pixel(index: u32) -> FilmPixel {{\n{reads}    return FilmPixel(\n        {parts},\n    );\n}}\n\
             fn store_pixel(index: u32, pixel: FilmPixel) {{\n{writes}}}\n"
        )
}
