//! Large arrays on the device: split over several buffers where one binding may not hold them.

use bytemuck::Pod;

use super::reading::{LARGE_ARRAYS, Reading};
use crate::gpu::{Buffer, Device, GpuError};

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

    /// The text that declares the pages from `first_binding` on, and the accessor.
    pub fn wgsl(&self, first_binding: u32, reading: Reading<'_>) -> String {
        let array = LARGE_ARRAYS[self.array];
        reading.array(array, self.pages.len(), self.page_bits, first_binding)
    }
}
