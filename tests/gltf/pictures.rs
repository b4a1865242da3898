//! Small encoded pictures for the tests.

/// Encode pixels as PNG.
pub fn png(width: u32, height: u32, color: image::ExtendedColorType, pixels: &[u8]) -> Vec<u8> {
    use image::ImageEncoder;
    let mut bytes = Vec::new();
    image::codecs::png::PngEncoder::new(&mut bytes)
        .write_image(pixels, width, height, color)
        .expect("pixels that fit");
    bytes
}

/// Red, green; blue, half-transparent white.
pub fn png_rgba8() -> Vec<u8> {
    let pixels = [
        255, 0, 0, 255, 0, 255, 0, 255, 0, 0, 255, 255, 255, 255, 255, 128,
    ];
    png(2, 2, image::ExtendedColorType::Rgba8, &pixels)
}

/// A grey JPEG of 8 × 8 pixels.
pub fn jpeg_gray() -> Vec<u8> {
    use image::ImageEncoder;
    let mut bytes = Vec::new();
    image::codecs::jpeg::JpegEncoder::new_with_quality(&mut bytes, 95)
        .write_image(&[100; 64], 8, 8, image::ExtendedColorType::L8)
        .expect("pixels that fit");
    bytes
}

/// CRC-32 as PNG has it.
pub fn crc32(bytes: &[u8]) -> u32 {
    let step = |crc: u32, _| {
        if crc & 1 == 1 {
            crc >> 1 ^ 0xEDB8_8320
        } else {
            crc >> 1
        }
    };
    !bytes
        .iter()
        .fold(!0, |crc, &byte| (0..8).fold(crc ^ u32::from(byte), step))
}

/// A colourful JPEG of 16 × 16 pixels.
pub fn jpeg_rgb() -> Vec<u8> {
    use image::ImageEncoder;
    let pixels: Vec<u8> = (0..16 * 16 * 3)
        .map(|i: u32| (i * i / 7 % 256) as u8)
        .collect();
    let mut bytes = Vec::new();
    image::codecs::jpeg::JpegEncoder::new_with_quality(&mut bytes, 90)
        .write_image(&pixels, 16, 16, image::ExtendedColorType::Rgb8)
        .expect("pixels that fit");
    bytes
}

/// A PNG from the fields of its header and its filtered rows, for forms that the encoder does not write.
pub fn raw_png(
    size: [u32; 2],
    form: [u8; 3],
    chunks: &[(&[u8; 4], &[u8])],
    rows: &[u8],
) -> Vec<u8> {
    let [bits, color, interlace] = form;
    let mut header: Vec<u8> = size.iter().flat_map(|side| side.to_be_bytes()).collect();
    header.extend([bits, color, 0, 0, interlace]);
    let mut bytes = b"\x89PNG\r\n\x1A\n".to_vec();
    let mut chunk = |kind: &[u8], content: &[u8]| {
        bytes.extend((content.len() as u32).to_be_bytes());
        let checked = [kind, content].concat();
        bytes.extend(&checked);
        bytes.extend(crc32(&checked).to_be_bytes());
    };
    chunk(b"IHDR", &header);
    for (kind, content) in chunks {
        chunk(*kind, content);
    }
    chunk(b"IDAT", &stored_zlib(rows));
    chunk(b"IEND", &[]);
    bytes
}

/// A zlib stream of one stored block.
fn stored_zlib(data: &[u8]) -> Vec<u8> {
    let length = data.len() as u16;
    let mut bytes = vec![0x78, 0x01, 1];
    bytes.extend(length.to_le_bytes());
    bytes.extend((!length).to_le_bytes());
    bytes.extend(data);
    let (a, b) = data.iter().fold((1, 0), |(a, b): (u32, u32), &byte| {
        let a = (a + u32::from(byte)) % 65521;
        (a, (b + a) % 65521)
    });
    bytes.extend((b << 16 | a).to_be_bytes());
    bytes
}
