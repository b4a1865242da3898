"""A stage for sweeps over material parameters: a grid of shapes before a grey backdrop, under two panels."""

import math

from .gltf import about_y
from .shapes import Shape, join, normalize, plain_quad, sphere

RADIUS, STEP = 0.46, 1.1
DISTANCE = 11.5  # of the camera


def build_stage(gltf, columns, rows, key=26, fill=11):
    """Backdrop, panels (radiances key and fill) and a square picture of the grid."""
    half = max(columns, rows) * STEP / 2 + 0.08
    grey = gltf.diffuse("backdrop", [0.3, 0.3, 0.3], doubleSided=True)
    floor = -rows * STEP / 2 - 0.05
    backdrop = join(
        [plain_quad([-9, floor, 7], [18, 0, 0], [0, 0, -9]), plain_quad([-9, floor, -2], [18, 0, 0], [0, 10, 0])]
    )
    gltf.node("backdrop", mesh=gltf.mesh("backdrop", (backdrop, grey)))
    add_panels(gltf, key, fill)
    yfov = 2 * math.degrees(math.atan(half / (DISTANCE - RADIUS)))
    gltf.camera("camera", eye=[0, 0.35, DISTANCE], target=[0, 0, 0], yfov=yfov, aspect=1)


def add_panels(gltf, key, fill):
    """A key light on the left, a slim fill light on the right."""
    panel = plain_quad([-0.5, -0.5, 0], [1, 0, 0], [0, 1, 0])
    key = gltf.mesh("key panel", (panel, gltf.emitter("key light", [1, 0.95, 0.88], key)))
    fill = gltf.mesh("fill panel", (panel, gltf.emitter("fill light", [0.6, 0.75, 1], fill)))
    # A turn of +90° makes the panel's front, +Z, look along +X; the parent of the key light then tips it down.
    left = gltf.node("key stand", translation=[-5, 3.2, 4.2], rotation=about_y(128))
    gltf.node("key panel", left, mesh=key, rotation=[0.258819045, 0, 0, 0.965925826], scale=[3, 2.4, 1])
    gltf.node("fill panel", mesh=fill, translation=[6, 0.8, 4], rotation=about_y(-124), scale=[1.2, 4, 1])


def place(columns, rows, column, row):
    """Where the grid has a shape; row 0 is the top one."""
    return [(column - (columns - 1) / 2) * STEP, ((rows - 1) / 2 - row) * STEP, 0]


class Grid:
    """Shapes that differ in their material alone and share their accessors."""

    def __init__(self, gltf, columns, rows, shape=None):
        self.gltf, self.columns, self.rows = gltf, columns, rows
        self.shape = shape or sphere(3)
        self.primitive = None

    def add(self, name, column, row, material, **more):
        """more: further properties of the primitive."""
        self.primitive = self.primitive or self.gltf.primitive(self.shape, material)
        mesh = self.gltf.mesh(name, {**self.primitive, "material": material, **more})
        at = place(self.columns, self.rows, column, row)
        return self.gltf.node(name, mesh=mesh, translation=at, scale=[RADIUS] * 3)


def globe(slices, stacks):
    """The unit sphere by longitude and latitude, with texture coordinates: u runs eastwards, v down."""
    shape = Shape([], [])
    for j in range(stacks + 1):
        polar = math.pi * j / stacks
        for i in range(slices + 1):
            turn = 2 * math.pi * i / slices
            at = [math.sin(polar) * math.sin(turn), math.cos(polar), math.sin(polar) * math.cos(turn)]
            shape.positions.append(at)
            shape.normals.append(normalize(at))
            shape.uvs.append([i / slices, j / stacks])
            if i < slices and j < stacks:
                a, b = j * (slices + 1) + i, (j + 1) * (slices + 1) + i
                # At the poles one of the two triangles is a line.
                shape.indices += [a, b, b + 1] if j + 1 < stacks else []
                shape.indices += [a, b + 1, a + 1] if j > 0 else []
    return shape
