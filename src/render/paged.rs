//! Large arrays on the device: split over several bindings where one may not hold them.

use bytemuck::Pod;

use super::reading::{LARGE_ARRAYS, Reading};
use crate::gpu::{Buffer, Device, GpuError, Loads};

/// A page: a buffer, and the range (offset, bytes) of it; `None` is the whole.
pub type Page<'a> = (&'a Buffer, Option<(u64, u64)>);

/// An array that shaders read through `accessor(index)`.
pub struct PagedBuffer {
    /// Index into [`LARGE_ARRAYS`].
    array: usize,
    /// All but the last hold 2^`buffer_bits` elements.
    buffers: Vec<Buffer>,
    buffer_bits: u32,
    /// The same of pages in storage buffers and in texel buffers.
    storage_bits: u32,
    texel_bits: u32,
    /// Bytes of an element.
    stride: u64,
    bytes: u64,
}

impl PagedBuffer {
    /// Uploads the data of one of [`LARGE_ARRAYS`]; `T` has the size of its element type.
    pub fn upload<T: Pod>(device: &Device, array: usize, data: &[T]) -> Result<Self, GpuError> {
        let (name, _, _) = LARGE_ARRAYS[array];
        let (info, stride) = (device.info(), size_of::<T>() as u64);
        let bits = |limit: u64| (limit / stride).max(1).ilog2().min(31);
        let buffer_bits = bits(info.max_buffer_size);
        // The largest texels of which an element consists.
        let texel_bytes = 1 << stride.trailing_zeros().min(4);
        let mut buffers = data
            .chunks(1 << buffer_bits)
            .map(|part| device.buffer_with(name, part))
            .collect::<Result<Vec<_>, _>>()?;
        if buffers.is_empty() {
            buffers.push(device.buffer(name, stride)?);
        }
        Ok(Self {
            array,
            buffers,
            buffer_bits,
            storage_bits: bits(info.max_storage_buffer_range).min(buffer_bits),
            texel_bits: bits(info.max_texels.saturating_mul(texel_bytes)).min(buffer_bits),
            stride,
            bytes: stride * data.len() as u64,
        })
    }

    fn page_bits(&self, loads: Loads) -> u32 {
        match loads.texels {
            true => self.texel_bits,
            false => self.storage_bits,
        }
    }

    /// The pages, in order.
    pub fn pages(&self, loads: Loads) -> Vec<Page<'_>> {
        let bits = self.page_bits(loads);
        if bits == self.buffer_bits {
            return self.buffers.iter().map(|buffer| (buffer, None)).collect();
        }
        let page = self.stride << bits;
        let of_buffer = |buffer| {
            let bytes = Buffer::bytes(buffer);
            let at = move |i| (buffer, Some((i * page, page.min(bytes - i * page))));
            (0..bytes.div_ceil(page)).map(at)
        };
        self.buffers.iter().flat_map(of_buffer).collect()
    }

    /// Bytes of data.
    pub fn bytes(&self) -> u64 {
        self.bytes
    }

    /// The text that declares the pages from `first_binding` on, and the accessor.
    pub fn wgsl(&self, first_binding: u32, reading: Reading<'_>) -> String {
        let (array, loads) = (LARGE_ARRAYS[self.array], reading.loads);
        let (pages, bits) = (self.pages(loads).len(), self.page_bits(loads));
        reading.array(array, pages, bits, first_binding)
    }
}
