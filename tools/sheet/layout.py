"""Labelled tiles in rows."""

from .font import HEIGHT, WIDTH, line

GAP = 6
BACKGROUND, INK, MISSING = b"\x18\x18\x18", b"\xe0\xe0\xe0", b"\x60\x00\x30"


def sheet(tiles, width, height, columns):
    """tiles: (label, picture or None), pictures as png.decode gives them. Gives width, height and rows."""
    columns = min(columns, len(tiles))
    rows = []
    for first in range(0, len(tiles), columns):
        row = [cell(label, picture, width, height) for label, picture in tiles[first : first + columns]]
        blank = [BACKGROUND * width] * len(row[0])
        row += [blank] * (columns - len(row))
        rows += [beside(lines) for lines in zip(*row)]
    total = columns * (width + GAP) + GAP
    rows += [BACKGROUND * total] * GAP
    return total, len(rows), rows


def beside(lines):
    gap = BACKGROUND * GAP
    return gap + gap.join(lines) + gap


def cell(label, picture, width, height):
    """A tile's rows: a gap, the picture in the middle of its place, the label below."""
    rows = [BACKGROUND * width] * GAP + fitted(picture, width, height) + [BACKGROUND * width] * 3
    most = width // WIDTH
    text = label if len(label) <= most else "..." + label[len(label) - most + 3 :]
    for y in range(HEIGHT):
        ink = b"".join(INK if dot else BACKGROUND for dot in line(text, y))
        rows.append((ink + BACKGROUND * width)[: 3 * width])
    return rows


def fitted(picture, width, height):
    if picture is None:
        return [MISSING * width] * height
    w, h, rows = picture
    w, left, top = min(w, width), max(0, width - w) // 2, max(0, height - h) // 2
    filled = [BACKGROUND * left + row[: 3 * w] + BACKGROUND * (width - w - left) for row in rows[:height]]
    empty = BACKGROUND * width
    return [empty] * top + filled + [empty] * (height - top - len(filled))
