"""A small writer of line plots on logarithmic axes, as SVG."""

import math
from html import escape

WIDTH, HEIGHT, LEFT, BOTTOM, TOP, RIGHT = 360, 260, 64, 44, 30, 14


class Axis:
    """A logarithmic axis over [low, high] that runs from pixel a to pixel b."""

    def __init__(self, values, a, b):
        self.low, self.high = math.log10(min(values)), math.log10(max(values))
        if self.high - self.low < 0.3:
            middle = (self.low + self.high) / 2
            self.low, self.high = middle - 0.15, middle + 0.15
        margin = 0.05 * (self.high - self.low)
        self.low, self.high, self.a, self.b = self.low - margin, self.high + margin, a, b

    def at(self, value):
        return self.a + (math.log10(value) - self.low) / (self.high - self.low) * (self.b - self.a)

    def ticks(self):
        """Powers of ten; where fewer than two of them lie inside, 1, 2 and 5 times them."""
        decades = range(math.floor(self.low), math.ceil(self.high) + 1)
        inside = lambda steps: [
            s * 10.0**d for d in decades for s in steps if self.low <= math.log10(s) + d <= self.high
        ]  # noqa: E731
        tens = inside([1])
        return tens if len(tens) >= 2 else inside([1, 2, 5])


def panel(title, x_label, y_label, series, left, top):
    """series: (name, colour, dashed, points)."""
    points = [point for _, _, _, line in series for point in line]
    x = Axis([p[0] for p in points], left + LEFT, left + WIDTH - RIGHT)
    y = Axis([p[1] for p in points], top + HEIGHT - BOTTOM, top + TOP)
    parts = [text(left + WIDTH / 2, top + 18, title, "middle", 13)]
    parts += [text(left + WIDTH / 2, top + HEIGHT - 6, x_label, "middle", 11)]
    parts += [text(left + LEFT, top + TOP - 4, y_label, "start", 10)]
    parts.append(f'<rect x="{x.a}" y="{y.b}" width="{x.b - x.a}" height="{y.a - y.b}" fill="none" stroke="#999"/>')
    for tick in x.ticks():
        parts += [
            line([(x.at(tick), y.a), (x.at(tick), y.b)], "#ddd"),
            text(x.at(tick), y.a + 14, label(tick), "middle", 10),
        ]
    for tick in y.ticks():
        parts += [
            line([(x.a, y.at(tick)), (x.b, y.at(tick))], "#ddd"),
            text(x.a - 5, y.at(tick) + 4, label(tick), "end", 10),
        ]
    for name, colour, dashed, values in series:
        places = [(x.at(a), y.at(b)) for a, b in values]
        parts.append(line(places, colour, dashed, name))
        if not dashed:
            parts += [f'<circle cx="{a:.1f}" cy="{b:.1f}" r="3" fill="{colour}"/>' for a, b in places]
    return parts


def line(points, colour, dashed=False, name=""):
    path = " ".join(f"{a:.1f},{b:.1f}" for a, b in points)
    dash = ' stroke-dasharray="5 4"' if dashed else ""
    return f'<polyline points="{path}" fill="none" stroke="{colour}"{dash}><title>{escape(name)}</title></polyline>'


def text(x, y, content, anchor, size):
    return f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}" font-size="{size}">{escape(content)}</text>'


def label(value):
    return f"{value:g}" if 1e-3 <= value < 1e4 else f"1e{round(math.log10(value))}"


def page(panels, columns=3):
    """An SVG of panels, each (title, x_label, y_label, series)."""
    width, height = columns * WIDTH, -(-len(panels) // columns) * HEIGHT
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" font-family="sans-serif">',
        '<rect width="100%" height="100%" fill="white"/>',
    ]
    for i, one in enumerate(panels):
        parts += panel(*one, left=i % columns * WIDTH, top=i // columns * HEIGHT)
    return "\n".join([*parts, "</svg>"]) + "\n"
