//! Large arrays on the device: split over several buffers where one binding may not hold them.

use bytemuck::Pod;

use crate::gpu::{Buffer, Device, GpuError};

/// An array that shaders read through `accessor(index)`.
pub struct PagedBuffer {
    name: &'static str,
    element: &'static str,
    accessor: &'static str,
    pages: Vec<Buffer>,
    /// A page holds 2^this elements.
    page_bits: u32,
    bytes: u64,
}

impl PagedBuffer {
    /// Uploads `data`; elements of the WGSL type `element`, of the same size as `T`.
    pub fn upload<T: Pod>(
        device: &Device,
        name: &'static str,
        element: &'static str,
        accessor: &'static str,
        data: &[T],
    ) -> Result<Self, GpuError> {
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
            name,
            element,
            accessor,
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

    /// The text that declares the pages from `first_binding` on, and the accessor.
    pub fn wgsl(&self, first_binding: u32) -> String {
        paged_wgsl(
            self.name,
            self.element,
            self.accessor,
            self.pages.len(),
            self.page_bits,
            first_binding,
        )
    }
}

/// Bindings and accessor of an array of `pages` pages.
pub fn paged_wgsl(
    name: &str,
    element: &str,
    accessor: &str,
    pages: usize,
    page_bits: u32,
    first_binding: u32,
) -> String {
    let mut text = String::new();
    for page in 0..pages {
        let binding = first_binding + page as u32;
        text += &format!(
            "@group(0) @binding({binding}) var<storage, read> {name}_{page}: array<{element}>;\n"
        );
    }
    text += &format!("fn {accessor}(index: u32) -> {element} {{\n");
    if pages == 1 {
        text += &format!("    return {name}_0[index];\n");
    } else {
        let mask = (1_u64 << page_bits) - 1;
        text +=
            &format!("    let offset = index & {mask}u;\n    switch (index >> {page_bits}u) {{\n");
        for page in 1..pages {
            text += &format!("        case {page}u: {{ return {name}_{page}[offset]; }}\n");
        }
        text += &format!("        default: {{ return {name}_0[offset]; }}\n    }}\n");
    }
    text + "}\n"
}
