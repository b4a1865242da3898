"""Triangle shapes. Front faces are counter-clockwise."""

import math
from dataclasses import dataclass, field


@dataclass
class Shape:
    """Vertices and triangles; normals and texture coordinates are empty where there are none."""

    positions: list
    indices: list
    normals: list = field(default_factory=list)
    uvs: list = field(default_factory=list)


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def normalize(v):
    length = math.sqrt(sum(x * x for x in v))
    return [x / length for x in v]


def join(shapes):
    """One shape of several that have the same attributes."""
    joined = Shape([], [])
    for shape in shapes:
        first = len(joined.positions)
        joined.positions += shape.positions
        joined.normals += shape.normals
        joined.uvs += shape.uvs
        joined.indices += [first + i for i in shape.indices]
    return joined


def quad(corner, u, v, uv_scale=(1, 1)):
    """The parallelogram corner, corner + u, corner + u + v, corner + v, seen from the side of u × v.

    Texture coordinates run along u, and against v since glTF's v points down.
    """
    at = lambda s, t: [c + s * a + t * b for c, a, b in zip(corner, u, v)]  # noqa: E731
    su, sv = uv_scale
    return Shape(
        positions=[at(0, 0), at(1, 0), at(1, 1), at(0, 1)],
        normals=[normalize(cross(u, v))] * 4,
        uvs=[[0, sv], [su, sv], [su, 0], [0, 0]],
        indices=[0, 1, 2, 0, 2, 3],
    )


def plain_quad(corner, u, v):
    """A quad without normals and texture coordinates."""
    shape = quad(corner, u, v)
    return Shape(shape.positions, shape.indices)


def frame(corner, u, v, s0, s1, t0, t1):
    """A quad with the hole [s0, s1] × [t0, t1] in units of u and v."""
    part = lambda a, b, c, d: plain_quad(  # noqa: E731
        [p + a * x + c * y for p, x, y in zip(corner, u, v)], [(b - a) * x for x in u], [(d - c) * y for y in v]
    )
    return join([part(0, 1, 0, t0), part(0, 1, t1, 1), part(0, s0, t0, t1), part(s1, 1, t0, t1)])


def box(bottom=True):
    """The box of side 1 that stands on the origin, with flat normals."""
    h = 0.5
    faces = [
        quad([-h, 0, h], [1, 0, 0], [0, 1, 0]),
        quad([h, 0, -h], [-1, 0, 0], [0, 1, 0]),
        quad([h, 0, h], [0, 0, -1], [0, 1, 0]),
        quad([-h, 0, -h], [0, 0, 1], [0, 1, 0]),
        quad([-h, 1, h], [1, 0, 0], [0, 0, -1]),
    ]
    if bottom:
        faces.append(quad([-h, 0, -h], [1, 0, 0], [0, 0, 1]))
    shape = join(faces)
    shape.uvs = []
    return shape


def sphere(subdivisions, smooth=True):
    """The unit sphere: an icosahedron whose triangles are split in four `subdivisions` times."""
    g = (1 + math.sqrt(5)) / 2
    points = [[-1, g, 0], [1, g, 0], [-1, -g, 0], [1, -g, 0], [0, -1, g], [0, 1, g]]
    points += [[0, -1, -g], [0, 1, -g], [g, 0, -1], [g, 0, 1], [-g, 0, -1], [-g, 0, 1]]
    points = [normalize(p) for p in points]
    triangles = [(0, 11, 5), (0, 5, 1), (0, 1, 7), (0, 7, 10), (0, 10, 11), (1, 5, 9), (5, 11, 4)]
    triangles += [(11, 10, 2), (10, 7, 6), (7, 1, 8), (3, 9, 4), (3, 4, 2), (3, 2, 6), (3, 6, 8)]
    triangles += [(3, 8, 9), (4, 9, 5), (2, 4, 11), (6, 2, 10), (8, 6, 7), (9, 8, 1)]
    for _ in range(subdivisions):
        triangles = split_in_four(points, triangles)
    return Shape(points, [i for t in triangles for i in t], normals=points if smooth else [])


def split_in_four(points, triangles):
    """Splits at the edges' midpoints, pushed out to the sphere; appends to points."""
    middles = {}

    def middle(a, b):
        edge = (min(a, b), max(a, b))
        if edge not in middles:
            middles[edge] = len(points)
            points.append(normalize([x + y for x, y in zip(points[a], points[b])]))
        return middles[edge]

    split = []
    for a, b, c in triangles:
        ab, bc, ca = middle(a, b), middle(b, c), middle(c, a)
        split += [(a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca)]
    return split


def cylinder(radius0, radius1, height, sides):
    """A cone frustum along +Y from the origin, without caps, with smooth normals."""
    ring = [(math.cos(2 * math.pi * i / sides), math.sin(2 * math.pi * i / sides)) for i in range(sides)]
    slope = (radius0 - radius1) / height
    shape = Shape([], [])
    for c, s in ring:
        shape.positions += [[radius0 * c, 0, radius0 * s], [radius1 * c, height, radius1 * s]]
        shape.normals += [normalize([c, slope, s])] * 2
    for i in range(sides):
        a, b = 2 * i, 2 * ((i + 1) % sides)
        shape.indices += [a, a + 1, b, b, a + 1, b + 1]
    return shape
