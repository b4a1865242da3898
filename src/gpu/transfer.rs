//! Between the host's memory and a buffer's: directly where the memory is mapped, else through the staging buffer.

use ash::vk;

use super::error::GpuError;
use super::memory::RawBuffer;
use super::queue::{Queue, STAGING_BYTES};

/// Fills a buffer with zeros.
pub(super) fn clear(queue: &mut Queue, buffer: &RawBuffer) -> Result<(), GpuError> {
    if buffer.is_writable() {
        buffer.clear(queue);
        return Ok(());
    }
    let doing = format!("clear buffer '{}'", buffer.label);
    let timing = queue.run(&doing, |device, commands| {
        // SAFETY: called while recording; the whole buffer, whose size is a multiple of 4, is filled.
        unsafe { device.cmd_fill_buffer(commands, buffer.raw, 0, vk::WHOLE_SIZE, 0) };
    });
    timing.map(|_| ())
}

/// Writes `data` into a buffer, from byte `offset` on.
pub(super) fn upload(
    queue: &mut Queue,
    buffer: &RawBuffer,
    offset: u64,
    data: &[u8],
) -> Result<(), GpuError> {
    buffer.check_range(offset, data.len() as u64)?;
    if buffer.is_writable() {
        buffer.write(queue, offset, data);
        return Ok(());
    }
    let doing = format!("upload to buffer '{}'", buffer.label);
    queue.with_staging(|queue, staging| {
        let mut at = offset;
        for chunk in data.chunks(STAGING_BYTES as usize) {
            staging.write(queue, 0, chunk);
            copy(
                queue,
                &doing,
                (staging, 0),
                (buffer, at),
                chunk.len() as u64,
            )?;
            at += chunk.len() as u64;
        }
        Ok(())
    })
}

/// Fills `out` from a buffer, from byte `offset` on.
pub(super) fn download(
    queue: &mut Queue,
    buffer: &RawBuffer,
    offset: u64,
    out: &mut [u8],
) -> Result<(), GpuError> {
    buffer.check_range(offset, out.len() as u64)?;
    if buffer.is_readable() {
        buffer.read(queue, offset, out);
        return Ok(());
    }
    let doing = format!("download from buffer '{}'", buffer.label);
    queue.with_staging(|queue, staging| {
        let mut at = offset;
        for chunk in out.chunks_mut(STAGING_BYTES as usize) {
            copy(
                queue,
                &doing,
                (buffer, at),
                (staging, 0),
                chunk.len() as u64,
            )?;
            staging.read(queue, 0, chunk);
            at += chunk.len() as u64;
        }
        Ok(())
    })
}

/// Copies `bytes` bytes on the device; the caller has checked both ranges.
fn copy(
    queue: &mut Queue,
    doing: &str,
    (source, from): (&RawBuffer, u64),
    (target, to): (&RawBuffer, u64),
    bytes: u64,
) -> Result<(), GpuError> {
    let region = vk::BufferCopy {
        src_offset: from,
        dst_offset: to,
        size: bytes,
    };
    let timing = queue.run(doing, |device, commands| {
        // SAFETY: called while recording; both ranges lie inside their buffers, which the callers keep alive.
        unsafe { device.cmd_copy_buffer(commands, source.raw, target.raw, &[region]) };
    });
    timing.map(|_| ())
}
