//! Buffers: one `VkBuffer` with memory of its own each, since a render needs few and big ones.

use std::ptr::NonNull;
use std::sync::Arc;

use ash::vk::{self, MemoryPropertyFlags as Flags};

use super::capacity::host_available;
use super::error::{GpuError, check_limit};
use super::info::DeviceKind;
use super::logical::Logical;
use super::queue::Queue;

/// A piece of device memory that shaders read and write, freed when the last handle to it is dropped.
/// A [`BindGroup`](super::BindGroup) holds its buffers, so they may be dropped before it.
pub struct Buffer(pub(super) Arc<RawBuffer>);

impl Buffer {
    /// The name given at creation.
    pub fn label(&self) -> &str {
        &self.0.label
    }

    /// The size in bytes, as asked for (16 where 0 was asked for).
    pub fn bytes(&self) -> u64 {
        self.0.bytes
    }
}

impl std::fmt::Debug for Buffer {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Buffer({:?}, {} bytes)", self.0.label, self.0.bytes)
    }
}

/// What a buffer's memory is for.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Purpose {
    /// Shaders work on it.
    Work,
    /// The host writes into it and reads from it, on the way to and from [`Purpose::Work`].
    Staging,
}

/// A buffer, its memory and the memory's address on the host if it has one.
pub(super) struct RawBuffer {
    logical: Arc<Logical>,
    pub label: String,
    pub raw: vk::Buffer,
    memory: vk::DeviceMemory,
    pub bytes: u64,
    /// Bytes of the memory, which may exceed `bytes`.
    allocated: u64,
    mapped: Option<NonNull<u8>>,
    /// Whether the host reads the memory through its cache; if not, reading it directly is very slow.
    cached: bool,
}

// SAFETY: the mapped address is used only by `write` and `read`, whose callers hold the queue's lock.
unsafe impl Send for RawBuffer {}
// SAFETY: as above: `write` and `read` ask for the locked queue, and the device is idle while it is locked.
unsafe impl Sync for RawBuffer {}

impl RawBuffer {
    /// Makes a buffer. Its content is undefined.
    pub fn new(
        logical: &Arc<Logical>,
        label: &str,
        bytes: u64,
        purpose: Purpose,
    ) -> Result<Self, GpuError> {
        let bytes = if bytes == 0 { 16 } else { bytes };
        check_capacity(logical, label, bytes)?;
        let mut buffer = Self {
            logical: Arc::clone(logical),
            label: label.to_owned(),
            raw: vk::Buffer::null(),
            memory: vk::DeviceMemory::null(),
            bytes,
            allocated: 0,
            mapped: None,
            cached: false,
        };
        buffer.create()?;
        buffer.allocate(purpose)?;
        Ok(buffer)
    }

    /// The size of the `VkBuffer`: filling works on multiples of 4 bytes.
    fn padded(&self) -> u64 {
        self.bytes.next_multiple_of(16)
    }

    fn create(&mut self) -> Result<(), GpuError> {
        use vk::BufferUsageFlags as Usage;
        let info = vk::BufferCreateInfo::default()
            .size(self.padded())
            .usage(
                Usage::STORAGE_BUFFER
                    | Usage::STORAGE_TEXEL_BUFFER
                    | Usage::UNIFORM_BUFFER
                    | Usage::TRANSFER_SRC
                    | Usage::TRANSFER_DST,
            )
            .sharing_mode(vk::SharingMode::EXCLUSIVE);
        // SAFETY: the device is alive, and the size is within its limits.
        let made = unsafe { self.logical.raw.create_buffer(&info, None) };
        self.raw = made.map_err(|e| self.failure("create", e, 0))?;
        Ok(())
    }

    fn allocate(&mut self, purpose: Purpose) -> Result<(), GpuError> {
        let device = &self.logical.raw;
        // SAFETY: the buffer was just made by this device.
        let needs = unsafe { device.get_buffer_memory_requirements(self.raw) };
        let kind = choose_type(&self.logical, needs.memory_type_bits, purpose);
        let kind = kind.ok_or_else(|| GpuError::misuse(&self.label, "no memory type fits it"))?;
        let (flags, heap) = self.memory_type(kind);
        let info = vk::MemoryAllocateInfo::default()
            .allocation_size(needs.size)
            .memory_type_index(kind);
        // SAFETY: the type is one of the device's, and fits the buffer.
        let memory = unsafe { device.allocate_memory(&info, None) };
        self.memory = memory.map_err(|e| self.failure("allocate", e, heap))?;
        self.allocated = needs.size;
        self.logical.add_use(needs.size);
        // SAFETY: both were just made by this device and are not bound yet; offset 0 suits any alignment.
        let bound = unsafe { device.bind_buffer_memory(self.raw, self.memory, 0) };
        bound.map_err(|e| self.failure("bind", e, heap))?;
        self.cached = flags.contains(Flags::HOST_CACHED);
        let wanted = purpose == Purpose::Staging || self.logical.mapped;
        if wanted && flags.contains(Flags::HOST_VISIBLE | Flags::HOST_COHERENT) {
            self.map(heap)?;
        }
        Ok(())
    }

    fn map(&mut self, heap: u64) -> Result<(), GpuError> {
        let (device, whole) = (&self.logical.raw, vk::WHOLE_SIZE);
        // SAFETY: the memory is host-visible and not mapped yet; freeing it unmaps it.
        let address =
            unsafe { device.map_memory(self.memory, 0, whole, vk::MemoryMapFlags::empty()) };
        let address = address.map_err(|e| self.failure("map", e, heap))?;
        self.mapped = NonNull::new(address.cast());
        Ok(())
    }

    /// The properties of a memory type, and the bytes of its heap.
    fn memory_type(&self, index: u32) -> (Flags, u64) {
        let kind = self.logical.memory.memory_types[index as usize];
        let heap = self.logical.memory.memory_heaps[kind.heap_index as usize];
        (kind.property_flags, heap.size)
    }

    fn failure(&self, doing: &str, result: vk::Result, heap: u64) -> GpuError {
        use vk::Result as R;
        match result {
            R::ERROR_OUT_OF_DEVICE_MEMORY | R::ERROR_OUT_OF_HOST_MEMORY => {
                out_of_memory(&self.logical, &self.label, self.bytes, heap)
            }
            other => GpuError::vulkan(format!("{doing} buffer '{}'", self.label), other),
        }
    }

    /// Whether the host may write into the buffer directly.
    pub fn is_writable(&self) -> bool {
        self.mapped.is_some()
    }

    /// Whether the host may read from the buffer directly, at a fair speed.
    pub fn is_readable(&self) -> bool {
        self.mapped.is_some() && (self.cached || self.logical.info.kind == DeviceKind::Cpu)
    }

    /// Fills a writable buffer with zeros. `_lock` proves that the device is idle.
    pub fn clear(&self, _lock: &mut Queue) {
        if let Some(address) = self.mapped {
            // SAFETY: `padded()` bytes are mapped, and nobody else uses them while the queue is locked.
            unsafe { address.as_ptr().write_bytes(0, self.padded() as usize) };
        }
    }

    /// Writes into a writable buffer; the caller has checked the range. `_lock` proves that the device is idle.
    pub fn write(&self, _lock: &mut Queue, offset: u64, data: &[u8]) {
        let Some(address) = self
            .mapped
            .filter(|_| self.contains(offset, data.len() as u64))
        else {
            return debug_assert!(false, "write outside a mapped buffer");
        };
        // SAFETY: the range lies inside the mapped memory, and nobody else uses it while the queue is locked;
        // `data` cannot overlap it, since no reference into mapped memory is ever handed out.
        unsafe {
            let target = address.as_ptr().add(offset as usize);
            target.copy_from_nonoverlapping(data.as_ptr(), data.len());
        }
    }

    /// Reads from a readable buffer; the caller has checked the range. `_lock` proves that the device is idle.
    pub fn read(&self, _lock: &mut Queue, offset: u64, out: &mut [u8]) {
        let Some(address) = self
            .mapped
            .filter(|_| self.contains(offset, out.len() as u64))
        else {
            return debug_assert!(false, "read outside a mapped buffer");
        };
        // SAFETY: as in `write`; the driver owns the memory, so any content of it is a valid byte.
        unsafe {
            let source = address.as_ptr().add(offset as usize);
            out.as_mut_ptr().copy_from_nonoverlapping(source, out.len());
        }
    }

    /// Whether a range lies inside the buffer.
    pub fn contains(&self, offset: u64, bytes: u64) -> bool {
        offset
            .checked_add(bytes)
            .is_some_and(|end| end <= self.bytes)
    }

    /// Fails unless the range lies inside the buffer.
    pub fn check_range(&self, offset: u64, bytes: u64) -> Result<(), GpuError> {
        if self.contains(offset, bytes) {
            return Ok(());
        }
        let (label, size) = (self.label.clone(), self.bytes);
        Err(GpuError::OutOfRange {
            label,
            offset,
            bytes,
            size,
        })
    }

    /// Whether the buffer was made by this device.
    pub fn belongs_to(&self, logical: &Arc<Logical>) -> bool {
        Arc::ptr_eq(&self.logical, logical)
    }
}

impl Drop for RawBuffer {
    fn drop(&mut self) {
        // SAFETY: no work that uses the buffer is pending, since each submission is waited for; null is ignored.
        unsafe {
            self.logical.raw.destroy_buffer(self.raw, None);
            self.logical.raw.free_memory(self.memory, None);
        }
        self.logical.remove_use(self.allocated);
    }
}

fn out_of_memory(logical: &Logical, label: &str, bytes: u64, heap: u64) -> GpuError {
    GpuError::OutOfMemory {
        label: label.to_owned(),
        bytes,
        in_use: logical.in_use(),
        heap,
    }
}

/// Fails when the memory in use and `bytes` more exceed what there is, or one buffer may not be so large.
fn check_capacity(logical: &Logical, label: &str, bytes: u64) -> Result<(), GpuError> {
    let (in_use, heap) = (logical.in_use(), capacity(logical));
    if in_use.saturating_add(bytes) > heap {
        return Err(out_of_memory(logical, label, bytes, heap));
    }
    let what = "bytes in one buffer (maxMemoryAllocationSize, maxBufferSize)";
    check_limit(label, what, bytes, logical.info.max_buffer_size)
}

/// Bytes that the buffers of this device may have in all.
fn capacity(logical: &Logical) -> u64 {
    if logical.info.kind != DeviceKind::Cpu {
        return logical.info.memory;
    }
    let available = host_available().map(|left| left.saturating_add(logical.in_use()));
    available.unwrap_or(logical.info.memory)
}

/// The memory type that suits the purpose best among those in the bit set `allowed`.
fn choose_type(logical: &Logical, allowed: u32, purpose: Purpose) -> Option<u32> {
    let visible = Flags::HOST_VISIBLE | Flags::HOST_COHERENT;
    let wishes: &[Flags] = match purpose {
        Purpose::Staging => &[visible | Flags::HOST_CACHED, visible],
        Purpose::Work if logical.mapped => &[
            Flags::DEVICE_LOCAL | visible | Flags::HOST_CACHED,
            Flags::DEVICE_LOCAL | visible,
            Flags::DEVICE_LOCAL,
            Flags::empty(),
        ],
        Purpose::Work => &[Flags::DEVICE_LOCAL, Flags::empty()],
    };
    let types = logical.memory.memory_types_as_slice();
    let fits = |index: usize, wish: Flags| {
        allowed >> index & 1 == 1 && types[index].property_flags.contains(wish)
    };
    let find = |wish: &Flags| (0..types.len()).find(|&index| fits(index, *wish));
    wishes.iter().find_map(find).map(|index| index as u32)
}
