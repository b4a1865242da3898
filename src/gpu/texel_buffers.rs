//! Texel buffers, which WGSL does not have. A shader declares a storage texture of one dimension instead, read-only and of
//! one, two or four 32-bit words a texel; it becomes the buffer here, in the driver's hands.
//!
//! A CPU's driver reads a texel as one piece of memory where it reads a vector in a storage buffer number by number, each
//! behind a branch for the lanes that are off ([`Loads`](super::Loads)).

use std::sync::Arc;

use ash::vk;

use super::error::GpuError;
use super::logical::Logical;
use super::memory::Buffer;

/// SPIR-V specification: words before the first instruction; `OpCapability` and `OpTypeImage`, whose operands are result,
/// type of a texel's numbers, dimension, ...; capabilities (3.31) and dimensions (3.8).
const HEADER_WORDS: usize = 5;
const OP_CAPABILITY: u32 = 17;
const OP_TYPE_IMAGE: u32 = 25;
const IMAGE_1D: u32 = 44;
const IMAGE_BUFFER: u32 = 47;
const SAMPLED_1D: u32 = 43;
const SAMPLED_BUFFER: u32 = 46;
const DIMENSION_1D: u32 = 0;
const DIMENSION_BUFFER: u32 = 5;

/// The module with a buffer for every image of one dimension. How both are read is the same.
pub(super) fn images_to_buffers(spirv: &[u32]) -> Vec<u32> {
    let mut words = spirv.to_vec();
    let mut at = HEADER_WORDS;
    while let Some(first) = words.get(at).copied() {
        let length = (first >> 16).max(1) as usize;
        match (first & 0xffff, words.get_mut(at + 1..at + length)) {
            (OP_CAPABILITY, Some([which @ IMAGE_1D])) => *which = IMAGE_BUFFER,
            (OP_CAPABILITY, Some([which @ SAMPLED_1D])) => *which = SAMPLED_BUFFER,
            (OP_TYPE_IMAGE, Some([_, _, dimension @ DIMENSION_1D, ..])) => {
                *dimension = DIMENSION_BUFFER;
            }
            _ => {}
        }
        at += length;
    }
    words
}

/// A buffer as a shader sees its texels.
pub(super) struct TexelView {
    logical: Arc<Logical>,
    pub raw: vk::BufferView,
}

impl TexelView {
    /// A view of a range of a buffer, which fits the device's limits.
    pub fn new(
        logical: &Arc<Logical>,
        buffer: &Buffer,
        (offset, bytes): (u64, u64),
        words: u8,
    ) -> Result<Self, GpuError> {
        let info = vk::BufferViewCreateInfo::default()
            .buffer(buffer.0.raw)
            .format(format(words))
            .offset(offset)
            .range(bytes);
        // SAFETY: the buffer was made by this device for this use, the range lies inside it, and every device has the
        // formats for storage texel buffers.
        let made = unsafe { logical.raw.create_buffer_view(&info, None) };
        let raw =
            made.map_err(|e| GpuError::vulkan(format!("view buffer '{}'", buffer.label()), e))?;
        let logical = Arc::clone(logical);
        Ok(Self { logical, raw })
    }
}

impl Drop for TexelView {
    fn drop(&mut self) {
        // SAFETY: every dispatch that used it was waited for.
        unsafe { self.logical.raw.destroy_buffer_view(self.raw, None) };
    }
}

fn format(words: u8) -> vk::Format {
    match words {
        1 => vk::Format::R32_UINT,
        2 => vk::Format::R32G32_UINT,
        _ => vk::Format::R32G32B32A32_UINT,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn images_of_one_dimension_become_buffers_and_others_stay() {
        let image = |dimension| [9 << 16 | OP_TYPE_IMAGE, 7, 6, dimension, 2, 0, 0, 2, 33];
        let capability = |which| [2 << 16 | OP_CAPABILITY, which];
        let module = |first: u32, dimension: u32| {
            let mut words = vec![0x0723_0203, 0x0001_0300, 0, 9, 0];
            words.extend(capability(1));
            words.extend(capability(first));
            words.extend(image(dimension));
            words.extend(image(1));
            words
        };
        let changed = images_to_buffers(&module(IMAGE_1D, DIMENSION_1D));
        assert_eq!(changed, module(IMAGE_BUFFER, DIMENSION_BUFFER));
        let plain = module(11, 2);
        assert_eq!(images_to_buffers(&plain), plain);
    }
}
