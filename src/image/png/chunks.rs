//! PNG chunks that the encoder does not write: *PNG Specification*, third edition (W3C, 2025).

/// Signature (8) and the header chunk IHDR (4 + 4 + 13 + 4): further chunks follow it.
const AFTER_HEADER: usize = 33;

/// Puts chunks behind the header of an encoded PNG.
pub(super) fn insert(png: &mut Vec<u8>, chunks: &[u8]) {
    let at = AFTER_HEADER.min(png.len());
    png.splice(at..at, chunks.iter().copied());
}

/// Says that the samples are sRGB, perceptual intent (section 11.3.2.5).
pub(super) fn srgb() -> Vec<u8> {
    chunk(*b"sRGB", &[0])
}

/// An uncompressed text in UTF-8 without a language (section 11.3.3.4).
pub(super) fn text(key: &str, value: &str) -> Result<Vec<u8>, &'static str> {
    let is_printable = |b: u8| (32..=126).contains(&b);
    if !(1..=79).contains(&key.len()) || !key.bytes().all(is_printable) {
        return Err("a name has 1 to 79 printable ASCII characters");
    }
    if key.trim() != key || key.contains("  ") {
        return Err("a name neither begins nor ends with a space, nor holds two in a row");
    }
    if value.contains('\0') || value.len() > i32::MAX as usize - 128 {
        return Err("a value holds no NUL and fits in 2 GiB");
    }
    // Name, NUL; not compressed, method 0; no language, NUL; no translated name, NUL.
    let mut data = key.as_bytes().to_vec();
    data.extend([0; 5]);
    data.extend(value.as_bytes());
    Ok(chunk(*b"iTXt", &data))
}

/// Length, kind, data and their checksum (section 5.3).
fn chunk(kind: [u8; 4], data: &[u8]) -> Vec<u8> {
    let mut bytes = (data.len() as u32).to_be_bytes().to_vec();
    bytes.extend(kind);
    bytes.extend(data);
    let checksum = crc32(&bytes[4..]);
    bytes.extend(checksum.to_be_bytes());
    bytes
}

/// CRC-32 of ISO 3309, reflected polynomial 0xEDB88320 (PNG annex D). Bit by bit: the data is short.
fn crc32(bytes: &[u8]) -> u32 {
    let step = |crc: u32, _| (crc >> 1) ^ (0xEDB8_8320 * (crc & 1));
    !bytes
        .iter()
        .fold(!0, |crc, &byte| (0..8).fold(crc ^ u32::from(byte), step))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_checksum_is_the_standards() {
        assert_eq!(crc32(b"123456789"), 0xCBF4_3926);
        // The checksum that ends every PNG.
        assert_eq!(crc32(b"IEND"), 0xAE42_6082);
    }

    #[test]
    fn names_that_png_cannot_hold_are_refused() {
        for key in ["", " a", "a  b", "é", &"x".repeat(80)] {
            assert!(text(key, "").is_err(), "{key}");
        }
        assert!(text("a", "\0").is_err());
    }
}
