//! Reading the elements of accessors, whatever their component type.

use std::ops::Range;

use rayon::prelude::*;

use super::accessor::{Accessor, Block, Component, Shape};
use super::buffer::Data;
use super::error::LoadError;

/// Fewest elements that are worth a thread of their own.
pub(super) const PARALLEL: usize = 1 << 15;

impl Accessor<'_> {
    /// Refuse an accessor of another shape; `role` says what it is used for.
    pub fn expect_shape(&self, role: &str, shapes: &[Shape]) -> Result<(), LoadError> {
        if shapes.contains(&self.shape) {
            return Ok(());
        }
        let names: Vec<&str> = shapes.iter().map(|shape| shape.name()).collect();
        Err(self.item.fault(format!(
            "{role} must be {}, found {}",
            names.join(" or "),
            self.shape.name()
        )))
    }

    /// The elements in `range` as floats, normalised where the accessor says so (section 3.11,
    /// "Quantized data").
    ///
    /// `N` is the number of components, and `range` ends at most at `count`.
    pub fn floats<const N: usize>(
        &self,
        data: &Data,
        range: Range<usize>,
    ) -> Result<Vec<[f32; N]>, LoadError> {
        use Component::{F32, I8, I16, U8, U16, U32};
        match (self.component, self.normalized) {
            (F32, _) => self.gather(data, range, f32::from_le_bytes),
            (I8, false) => self.gather(data, range, |b| f32::from(i8::from_le_bytes(b))),
            (U8, false) => self.gather(data, range, |[b]| f32::from(b)),
            (I16, false) => self.gather(data, range, |b| f32::from(i16::from_le_bytes(b))),
            (U16, false) => self.gather(data, range, |b| f32::from(u16::from_le_bytes(b))),
            (U32, false) => self.gather(data, range, |b| u32::from_le_bytes(b) as f32),
            (I8, true) => self.gather(data, range, |b| {
                (f32::from(i8::from_le_bytes(b)) / 127.0).max(-1.0)
            }),
            (U8, true) => self.gather(data, range, |[b]| f32::from(b) / 255.0),
            (I16, true) => self.gather(data, range, |b| {
                (f32::from(i16::from_le_bytes(b)) / 32767.0).max(-1.0)
            }),
            (U16, true) => self.gather(data, range, |b| f32::from(u16::from_le_bytes(b)) / 65535.0),
            (U32, true) => self.gather(data, range, |b| {
                (f64::from(u32::from_le_bytes(b)) / f64::from(u32::MAX)) as f32
            }),
        }
    }

    /// All elements of an accessor of vertex indices.
    pub fn indices(&self, data: &Data) -> Result<Vec<[u32; 1]>, LoadError> {
        self.expect_shape("indices", &[Shape::Scalar])?;
        let all = 0..self.count;
        match self.component {
            Component::U8 => self.gather(data, all, |[b]| u32::from(b)),
            Component::U16 => self.gather(data, all, |b| u32::from(u16::from_le_bytes(b))),
            Component::U32 => self.gather(data, all, u32::from_le_bytes),
            _ => Err(self
                .item
                .fault("indices must be unsigned integers (`componentType` 5121, 5123 or 5125)")),
        }
    }

    /// The elements of an accessor of vertex indices, three at a time and without a copy in between: none where
    /// they do not lie one after the other, or are no multiple of three.
    pub fn index_triples(&self, data: &Data) -> Result<Option<Vec<[u32; 3]>>, LoadError> {
        let size = self.component.size();
        let tight = self.stored(data)?.filter(|stored| stored.stride == size);
        let plain = self.sparse.is_none() && self.count.is_multiple_of(3);
        let (Some(stored), true, Shape::Scalar) = (tight, plain, self.shape) else {
            return Ok(None);
        };
        let triples = match self.component {
            Component::U8 => self.triples(data, stored, |[b]| u32::from(b)),
            Component::U16 => self.triples(data, stored, |b| u32::from(u16::from_le_bytes(b))),
            Component::U32 => self.triples(data, stored, u32::from_le_bytes),
            _ => return Ok(None),
        };
        triples.map(Some)
    }

    fn triples<const SIZE: usize>(
        &self,
        data: &Data,
        stored: Stored,
        decode: impl Fn([u8; SIZE]) -> u32 + Sync,
    ) -> Result<Vec<[u32; 3]>, LoadError> {
        let count = self.count / 3;
        self.claim::<u32, 3>(data, count)?;
        let triple = |index: usize| decode_element(stored.bytes, 3 * SIZE * index, &decode);
        let all = (0..count).into_par_iter().with_min_len(PARALLEL);
        Ok(all.map(triple).collect())
    }

    /// The bytes of the elements; none where they are zero.
    fn stored<'b>(&'b self, data: &'b Data) -> Result<Option<Stored<'b>>, LoadError> {
        if let Some(bytes) = &self.decoded {
            let stride = self.shape.size(self.component);
            return Ok(Some(Stored { bytes, stride }));
        }
        let Some(block) = self.block else {
            return Ok(None);
        };
        let bytes = &data.view(block.view)?[block.offset..];
        let stride = block.stride;
        Ok(Some(Stored { bytes, stride }))
    }

    fn gather<T: Copy + Default + Send + Sync, const N: usize, const SIZE: usize>(
        &self,
        data: &Data,
        range: Range<usize>,
        decode: impl Fn([u8; SIZE]) -> T + Sync,
    ) -> Result<Vec<[T; N]>, LoadError> {
        self.claim::<T, N>(data, range.len())?;
        let mut elements = match self.stored(data)? {
            Some(stored) => {
                let element = |index| decode_element(stored.bytes, index * stored.stride, &decode);
                range
                    .clone()
                    .into_par_iter()
                    .with_min_len(PARALLEL)
                    .map(element)
                    .collect()
            }
            None => vec![[T::default(); N]; range.len()],
        };
        if let Some(sparse) = &self.sparse {
            let values = &data.view(sparse.values.view)?[sparse.values.offset..];
            for position in 0..sparse.count {
                let index =
                    self.sparse_index(data, sparse.indices, sparse.index_component, position)?;
                if range.contains(&index) {
                    let value = decode_element(values, position * sparse.values.stride, &decode);
                    elements[index - range.start] = value;
                }
            }
        }
        Ok(elements)
    }

    /// Refuse an accessor that promises more zeros than a file of this size may ask for.
    pub fn check_zeros(&self, data: &Data) -> Result<(), LoadError> {
        if self.block.is_some() || self.decoded.is_some() || self.count as u64 <= data.zero_limit()
        {
            return Ok(());
        }
        Err(self.item.fault(format!(
            "it promises {} elements, but refers to no buffer view that holds them",
            self.count
        )))
    }

    /// Check that the result may be allocated.
    fn claim<T, const N: usize>(&self, data: &Data, count: usize) -> Result<(), LoadError> {
        self.check_zeros(data)?;
        let replaced = self.sparse.as_ref().map_or(0, |sparse| sparse.count);
        let elements = count as u64 + replaced as u64;
        if data.charge(elements.saturating_mul(size_of::<[T; N]>() as u64)) {
            return Ok(());
        }
        Err(self.item.fault(
            "the scene's primitives read the same bytes so many times that memory would run out; \
             use instances of one mesh instead",
        ))
    }

    fn sparse_index(
        &self,
        data: &Data,
        block: Block,
        component: Component,
        position: usize,
    ) -> Result<usize, LoadError> {
        let bytes = &data.view(block.view)?[block.offset + position * block.stride..];
        let index = match component {
            Component::U8 => usize::from(bytes[0]),
            Component::U16 => usize::from(u16::from_le_bytes([bytes[0], bytes[1]])),
            _ => u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]) as usize,
        };
        if index < self.count {
            return Ok(index);
        }
        Err(self.item.fault(format!(
            "sparse index {position} is {index}, but the accessor has {} elements",
            self.count
        )))
    }
}

/// Where elements begin, and the bytes from one to the next.
#[derive(Clone, Copy)]
struct Stored<'b> {
    bytes: &'b [u8],
    stride: usize,
}

/// `N` components of `SIZE` bytes from byte `at` on, which the accessor's checks have proved to be there.
fn decode_element<T, const N: usize, const SIZE: usize>(
    bytes: &[u8],
    at: usize,
    decode: &impl Fn([u8; SIZE]) -> T,
) -> [T; N] {
    let bytes = &bytes[at..at + N * SIZE];
    std::array::from_fn(|component| {
        let mut raw = [0; SIZE];
        raw.copy_from_slice(&bytes[component * SIZE..(component + 1) * SIZE]);
        decode(raw)
    })
}
