//! Large arrays on the device: split over several buffers where one binding may not hold them.

use bytemuck::Pod;

use super::doublewords::{Entry, array_wgsl, film_accessors};
use crate::gpu::{Buffer, Device, GpuError};

/// First binding of the large arrays; those below are in `shaders/bindings.wgsl`.
pub const FIRST_PAGED_BINDING: u32 = 16;

/// Name, WGSL element type and accessor of each large array, in the order of their bindings.
pub const LARGE_ARRAYS: [(&str, &str, &str); 7] = [
    ("elements", "Element", "load_element"),
    ("indices", "u32", "load_index"),
    ("vertex_words", "vec2f", "load_vertex_pair"),
    ("texel_words", "u32", "load_texel_word"),
    ("environment_texels", "vec4f", "load_environment_texel"),
    ("environment_cdf", "u32", "load_environment_cdf"),
    ("light_nodes", "LightNode", "load_light_node"),
];

/// The `buffers.wgsl` of a scene whose large arrays have `pages` pages each: for compiling without
/// a scene.
pub fn large_arrays_wgsl(pages: usize) -> String {
    let paged = |(i, (name, element, accessor)): (usize, (&str, &str, &str))| {
        let binding = FIRST_PAGED_BINDING + (i * pages) as u32;
        paged_wgsl(name, element, accessor, pages, 20, binding)
    };
    let arrays: String = LARGE_ARRAYS.into_iter().enumerate().map(paged).collect();
    arrays + &film_wgsl(None)
}

/// The film's binding and accessors: `load_pixel(index)` and `store_pixel(index, pixel)`. In double words where the text
/// with the shader's structs is given.
pub fn film_wgsl(types: Option<&str>) -> String {
    let pixel = types.and_then(|types| Entry::new(types, "FilmPixel"));
    let (kind, accessors) = match pixel {
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

/// An array that shaders read through `accessor(index)`.
pub struct PagedBuffer {
    /// Index into [`LARGE_ARRAYS`].
    array: usize,
    pages: Vec<Buffer>,
    /// A page holds 2^this elements.
    page_bits: u32,
    bytes: u64,
}

impl PagedBuffer {
    /// Uploads the data of one of [`LARGE_ARRAYS`]; `T` has the size of its element type.
    pub fn upload<T: Pod>(device: &Device, array: usize, data: &[T]) -> Result<Self, GpuError> {
        let (name, _, _) = LARGE_ARRAYS[array];
        let stride = size_of::<T>() as u64;
        let limit = device.info().max_storage_buffer_range;
        let page_bits = (limit / stride).max(1).ilog2().min(31);
        let pages = data
            .chunks(1 << page_bits)
            .enumerate()
            .map(|(i, page)| device.buffer_with(&format!("{name} (page {i})"), page))
            .collect::<Result<Vec<_>, _>>()?;
        let pages = if pages.is_empty() {
            vec![device.buffer(name, stride)?]
        } else {
            pages
        };
        Ok(Self {
            array,
            pages,
            page_bits,
            bytes: stride * data.len() as u64,
        })
    }

    /// The pages, in order.
    pub fn pages(&self) -> &[Buffer] {
        &self.pages
    }

    /// Bytes of data.
    pub fn bytes(&self) -> u64 {
        self.bytes
    }

    /// The text that declares the pages from `first_binding` on, and the accessor. Where the text with the shader's structs
    /// is given, what has an even number of words is read in double words.
    pub fn wgsl(&self, first_binding: u32, types: Option<&str>) -> String {
        let (name, kind, accessor) = LARGE_ARRAYS[self.array];
        let (pages, bits) = (self.pages.len(), self.page_bits);
        let Some(entry) = types.and_then(|types| Entry::new(types, kind)) else {
            return paged_wgsl(name, kind, accessor, pages, bits, first_binding);
        };
        let start = if self.array == 0 {
            "alias ElementStart = u64;\n"
        } else {
            ""
        };
        start.to_owned() + &array_wgsl(self.array, &entry, pages, bits, first_binding)
    }
}

/// Bindings and accessor of an array of `pages` pages. Elements of the acceleration structure have two more accessors,
/// that of their first words and one that takes these (`shaders/accel/bvh.wgsl`).
fn paged_wgsl(
    name: &str,
    element: &str,
    accessor: &str,
    pages: usize,
    page_bits: u32,
    first_binding: u32,
) -> String {
    let mut text = declarations(name, element, pages, first_binding);
    let by_page = |read: &dyn Fn(usize) -> String| by_page(pages, page_bits, read);
    let whole = by_page(&|page| format!("{name}_{page}[offset]"));
    text += &format!("fn {accessor}(index: u32) -> {element} {{\n{whole}}}\n");
    if name == LARGE_ARRAYS[0].0 {
        // Where words are read one by one, reading ahead costs more than it brings.
        text += &format!(
            "alias ElementStart = u32;\n\
             fn {accessor}_start(index: u32) -> ElementStart {{\n    return index;\n}}\n\
             fn {accessor}_from(index: u32, start: ElementStart) -> Element {{\n    \
             return {accessor}(index);\n}}\n"
        );
    }
    text
}

pub(super) fn declarations(name: &str, element: &str, pages: usize, first_binding: u32) -> String {
    let declare = |page| {
        let binding = first_binding + page as u32;
        format!(
            "@group(0) @binding({binding}) var<storage, read> {name}_{page}: array<{element}>;\n"
        )
    };
    (0..pages).map(declare).collect()
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
