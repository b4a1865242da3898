//! How a kernel reads arrays: the generated `buffers.wgsl`.

use super::array_wgsl::{Entry, film_accessors, in_pieces, in_pieces_ahead};
use crate::gpu::Loads;

/// First binding of the large arrays; those below are in `shaders/bindings.wgsl`.
pub const FIRST_PAGED_BINDING: u32 = 17;

/// Name, WGSL element type and accessor of an array.
pub(super) type Array<'a> = (&'a str, &'a str, &'a str);

/// The large arrays, in the order of their bindings.
pub const LARGE_ARRAYS: [Array<'_>; 7] = [
    ("elements", "Element", "load_element"),
    ("indices", "u32", "load_index"),
    ("vertex_words", "vec2f", "load_vertex_pair"),
    ("texel_words", "u32", "load_texel_word"),
    ("environment_texels", "vec4f", "load_environment_texel"),
    ("environment_cdf", "u32", "load_environment_cdf"),
    ("light_nodes", "LightNode", "load_light_node"),
];

/// Tables that are not split, with their bindings; materials are read field by field
/// ([`table_files`](super::short_tables::table_files)).
const TABLES: [(Array<'_>, u32); 6] = [
    (("textures", "Texture", "load_texture"), 5),
    (("lights", "Light", "load_light"), 6),
    (
        ("punctual_lights", "PunctualLight", "load_punctual_light"),
        7,
    ),
    (("srgb_to_linear", "f32", "load_srgb_to_linear"), 8),
    (("bsdf_tables", "f32", "load_bsdf_number"), 10),
    (("guide", "u32", "load_guide_word"), 11),
];

/// The `buffers.wgsl` of a scene whose large arrays have `pages` pages each: for compiling without
/// a scene.
pub fn large_arrays_wgsl(pages: usize) -> String {
    let words = Reading::default();
    let paged = |(i, array): (usize, Array<'_>)| {
        let binding = FIRST_PAGED_BINDING + (i * pages) as u32;
        words.array(array, pages, 20, binding)
    };
    let arrays: String = LARGE_ARRAYS.into_iter().enumerate().map(paged).collect();
    arrays + &words.uniform_elements(None) + &words.tables(&[]) + &words.film()
}

/// How a kernel reads large arrays and the film; by default in words.
#[derive(Debug, Clone, Copy, Default)]
pub struct Reading<'a> {
    /// The text with the shader's structs.
    pub types: &'a str,
    /// What is faster than words.
    pub loads: Loads,
}

impl Reading<'_> {
    /// The film's binding and accessors: `load_pixel(index)` and `store_pixel(index, pixel)`.
    pub fn film(self) -> String {
        let loads = self.loads.without_texels();
        let (kind, accessors) = match Entry::new(self.types, "FilmPixel", loads) {
            Some(pixel) => ("u64", film_accessors(&pixel)),
            None => (
                "FilmPixel",
                "fn load_pixel(index: u32) -> FilmPixel {\n    return film[index];\n}\n\
                 fn store_pixel(index: u32, pixel: FilmPixel) {\n    film[index] = pixel;\n}\n"
                    .to_owned(),
            ),
        };
        format!("@group(0) @binding(2) var<storage, read_write> film: array<{kind}>;\n{accessors}")
    }

    /// Bindings and accessors of the tables; of `short` ones all lanes read all entries, as they are.
    pub fn tables(self, short: &[&str]) -> String {
        let table = |(array, binding): (Array<'_>, u32)| {
            let is_short = short.contains(&array.0);
            let reading = if is_short { Self::default() } else { self };
            reading.array(array, 1, 31, binding)
        };
        TABLES.into_iter().map(table).collect()
    }

    /// Bindings and accessor of an array of `pages` pages. Elements of the acceleration structure have two more accessors,
    /// that of their first piece and one that takes it (`shaders/accel/bvh.wgsl`).
    pub fn array(
        self,
        array: Array<'_>,
        pages: usize,
        page_bits: u32,
        first_binding: u32,
    ) -> String {
        let (name, kind, accessor) = array;
        let entry = Entry::new(self.types, kind, self.loads);
        let declare = |page| {
            let binding = first_binding + page as u32;
            match &entry {
                Some(entry) => entry
                    .piece()
                    .declaration(&format!("{name}_{page}"), binding),
                None => format!(
                    "@group(0) @binding({binding}) var<storage, read> {name}_{page}: array<{kind}>;\n"
                ),
            }
        };
        let declarations: String = (0..pages).map(declare).collect();
        let is_elements = accessor == LARGE_ARRAYS[0].2;
        declarations
            + &match entry {
                Some(entry) if is_elements => {
                    let alias = format!("alias ElementStart = {};\n", entry.piece().kind());
                    alias + &in_pieces_ahead(array, &entry, pages, page_bits)
                }
                Some(entry) => in_pieces(array, &entry, pages, page_bits),
                None => in_words(array, pages, page_bits, is_elements),
            }
    }

    /// `load_element_uniform`, for an index that is the same for all lanes: a CPU reads it once in a storage buffer. Where
    /// `load_element` reads texels that has a binding of its own, if all fits one.
    pub fn uniform_elements(self, binding: Option<u32>) -> String {
        let accessor = "load_element_uniform";
        match binding {
            Some(binding) => {
                let loads = self.loads.without_texels();
                let array = ("uniform_elements", "Element", accessor);
                Reading { loads, ..self }.array(array, 1, 31, binding)
            }
            None => format!(
                "fn {accessor}(index: u32) -> Element {{\n    return load_element(index);\n}}\n"
            ),
        }
    }
}

/// An accessor that reads whole entries of the arrays' own type.
fn in_words(
    (name, kind, accessor): Array<'_>,
    pages: usize,
    page_bits: u32,
    is_elements: bool,
) -> String {
    let whole = by_page(pages, page_bits, &|page| format!("{name}_{page}[offset]"));
    let text = format!("fn {accessor}(index: u32) -> {kind} {{\n{whole}}}\n");
    if !is_elements {
        return text;
    }
    // Where words are read one by one, reading ahead costs more than it brings.
    text + &format!(
        "alias ElementStart = u32;\n\
         fn {accessor}_start(index: u32) -> ElementStart {{\n    return index;\n}}\n\
         fn {accessor}_from(index: u32, start: ElementStart) -> {kind} {{\n    \
         return {accessor}(index);\n}}\n"
    )
}

/// The body of a function that returns what `read` gives for the page of `index`, at `offset` in it.
pub(super) fn by_page(pages: usize, page_bits: u32, read: &dyn Fn(usize) -> String) -> String {
    if pages == 1 {
        return format!("    let offset = index;\n    return {};\n", read(0));
    }
    let mask = (1_u64 << page_bits) - 1;
    let case = |page| format!("        case {page}u: {{ return {}; }}\n", read(page));
    let cases: String = (1..pages).map(case).collect();
    format!(
        "    let offset = index & {mask}u;\n    switch (index >> {page_bits}u) {{\n{cases}        \
         default: {{ return {}; }}\n    }}\n",
        read(0)
    )
}
