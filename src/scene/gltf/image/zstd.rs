//! Zstandard, as KTX 2.0 uses it: one frame that inflates to a known length.

use std::io::Read;

/// A window that every decoder has to support (RFC 8878, section 3.1.1.1.2).
const USUAL_WINDOW: u64 = 8 << 20;

/// Refuse a frame whose window is larger than what it is to inflate to requires: a decoder makes room
/// for the whole window first.
pub(super) fn check_window(frame: &[u8], length: u64) -> Result<(), String> {
    let window = window(frame).ok_or("it is no Zstandard frame")?;
    match window <= USUAL_WINDOW.max(2 * length) {
        true => Ok(()),
        false => Err(format!(
            "its Zstandard frame asks for a window of {window} bytes to inflate {length}"
        )),
    }
}

/// Size of the window that a frame asks for, in bytes; none if it is no frame.
fn window(frame: &[u8]) -> Option<u64> {
    let (magic, rest) = frame.split_at_checked(4)?;
    if magic != [0x28, 0xB5, 0x2F, 0xFD] {
        return None;
    }
    let (&descriptor, rest) = rest.split_first()?;
    let is_single_segment = descriptor & 0x20 != 0;
    if !is_single_segment {
        let byte = u64::from(*rest.first()?);
        let base = 1 << (10 + (byte >> 3));
        return Some(base + base / 8 * (byte & 7));
    }
    // The window is the content: its length follows the dictionary's id.
    let id = [0, 1, 2, 4][usize::from(descriptor & 3)];
    let size = [1, 2, 4, 8][usize::from(descriptor >> 6)];
    let mut word = [0; 8];
    word[..size].copy_from_slice(rest.get(id..id + size)?);
    let length = u64::from_le_bytes(word);
    Some(if size == 2 { length + 256 } else { length })
}

/// Inflate a frame to exactly `length` bytes, for which there must be room.
pub(super) fn inflate(frame: &[u8], length: usize) -> Result<Vec<u8>, String> {
    check_window(frame, length as u64)?;
    let damaged = |error: &dyn std::fmt::Display| {
        let reason = error.to_string().replace(['\n', '\r'], " ");
        format!("its Zstandard frame cannot be inflated ({reason})")
    };
    let mut decoder = ruzstd::StreamingDecoder::new(frame).map_err(|error| damaged(&error))?;
    let mut bytes = vec![0; length];
    decoder
        .read_exact(&mut bytes)
        .map_err(|error| damaged(&error))?;
    match decoder.read(&mut [0]) {
        Ok(0) => Ok(bytes),
        Ok(_) => Err(format!(
            "its Zstandard frame inflates to more than the {length} bytes that its header promises"
        )),
        Err(error) => Err(damaged(&error)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn windows_are_read() {
        let frame = |rest: &[u8]| [&[0x28, 0xB5, 0x2F, 0xFD], rest].concat();
        assert_eq!(window(&frame(&[0x00, 0x00])), Some(1024));
        assert_eq!(window(&frame(&[0x00, 0x0F])), Some(2048 + 7 * 256));
        assert_eq!(window(&frame(&[0x20, 9])), Some(9));
        assert_eq!(window(&frame(&[0x61, 0, 1, 0])), Some(257));
        assert_eq!(window(&frame(&[0xE0, 1, 2, 0, 0, 0, 0, 0, 0])), Some(513));
        assert_eq!(window(&frame(&[0xE0, 1])), None);
        assert_eq!(window(b"PNG!...."), None);
        assert!(check_window(&frame(&[0x00, 0xFF]), 100).is_err());
    }
}
