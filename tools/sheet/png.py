"""PNG files of 8 bits a channel, colour with or without alpha, not interlaced (ISO/IEC 15948)."""

import struct
import zlib

SIGNATURE = b"\x89PNG\r\n\x1a\n"


def chunks(data):
    at = len(SIGNATURE)
    while at < len(data):
        (length,) = struct.unpack_from(">I", data, at)
        yield data[at + 4 : at + 8], data[at + 8 : at + 8 + length]
        at += 12 + length


def decode(data):
    """(width, height, rows): each row the bytes R, G, B of its pixels."""
    parts = list(chunks(data))
    width, height, bits, kind, _, _, interlaced = struct.unpack(">IIBBBBB", dict(parts)[b"IHDR"])
    if (bits, interlaced) != (8, 0) or kind not in (2, 6):
        raise ValueError(f"expected a PNG of 8-bit colour, not interlaced, found {bits} bits, colour type {kind}")
    channels = 3 if kind == 2 else 4
    raw = zlib.decompress(b"".join(body for name, body in parts if name == b"IDAT"))
    rows, above, stride = [], bytes(width * channels), width * channels + 1
    for y in range(height):
        line = raw[y * stride : (y + 1) * stride]
        above = unfilter(line[0], bytearray(line[1:]), above, channels)
        rows.append(bytes(above) if channels == 3 else without_alpha(above))
    return width, height, rows


def without_alpha(row):
    rgb = bytearray(len(row) // 4 * 3)
    for channel in range(3):
        rgb[channel::3] = row[channel::4]
    return bytes(rgb)


def unfilter(kind, row, above, step):
    """Adds to each byte what its neighbours foretell (section 9)."""
    for i in range(len(row)):
        left, corner = (row[i - step], above[i - step]) if i >= step else (0, 0)
        guess = (0, left, above[i], (left + above[i]) // 2, paeth(left, above[i], corner))[kind]
        row[i] = (row[i] + guess) & 255
    return row


def paeth(a, b, c):
    p = a + b - c
    return min((abs(p - a), 0, a), (abs(p - b), 1, b), (abs(p - c), 2, c))[2]


def encode(width, height, rows):
    """rows: the bytes R, G, B of each row's pixels, from the top."""
    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    body = zlib.compress(b"".join(b"\0" + row for row in rows))
    return SIGNATURE + chunk(b"IHDR", header) + chunk(b"IDAT", body) + chunk(b"IEND", b"")


def chunk(kind, data):
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
