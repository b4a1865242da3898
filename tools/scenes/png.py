"""PNG, uncompressed: the same bytes whatever zlib there is."""

import struct
import zlib


def encode(width, height, rows, alpha):
    """rows: iterable of rows from the top, each a list of (r, g, b) or (r, g, b, a) in 0..255."""
    raw = b"".join(b"\0" + bytes(x for texel in row for x in texel) for row in rows)
    header = struct.pack(">IIBBBBB", width, height, 8, 6 if alpha else 2, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", stored(raw)) + chunk(b"IEND", b"")


def chunk(kind, data):
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def stored(raw):
    """A zlib stream of stored blocks (RFC 1950, RFC 1951 section 3.2.4)."""
    stream = b"\x78\x01"
    for start in range(0, len(raw), 65535):
        block = raw[start : start + 65535]
        last = start + 65535 >= len(raw)
        stream += struct.pack("<BHH", last, len(block), len(block) ^ 0xFFFF) + block
    return stream + struct.pack(">I", zlib.adler32(raw))
