"""A potted tree behind a curtain: textures, alpha MASK and alpha BLEND."""

import math
import random

from . import png
from .gltf import CLAMP_TO_EDGE, LINEAR, NEAREST, REPEAT, Gltf
from .shapes import Shape, cylinder, join, normalize, plain_quad, quad

LEAVES = 620


def build():
    gltf = Gltf(
        "foliage",
        "Alpha: leaves cut out of squares (MASK, both sides seen, texture in the buffer), a sheer curtain (BLEND, "
        "alpha from a texture times a factor), a checkered ground (texture as a data URI, nearest filter, repeated by "
        "its coordinates), under a sun and a large soft light.",
    )
    add_ground(gltf)
    add_tree(gltf)
    add_curtain(gltf)
    sky = gltf.emitter("soft light", [0.75, 0.87, 1], 4.5)
    gltf.node("soft light", mesh=gltf.mesh("soft light", (plain_quad([-5.5, 6, -3], [5, 0, 0], [0, 0, 6]), sky)))
    gltf.light("sun", "directional", [1, 0.93, 0.8], 4, eye=[3.4, 4.2, 3.6], target=[0, 0, 0])
    gltf.camera("camera", eye=[0.6, 1.75, 6.4], target=[0.1, 1.25, 0], yfov=34, aspect=1)
    return gltf


def add_ground(gltf):
    light, dark = (214, 206, 190), (118, 104, 92)
    rows = [[light if (x + y) % 2 == 0 else dark for x in range(2)] for y in range(2)]
    texture = gltf.texture("checker", png.encode(2, 2, rows, alpha=False), gltf.sampler(NEAREST, REPEAT))
    tiles = gltf.diffuse("tiles", [1, 1, 1], texture=texture, doubleSided=True)
    ground = quad([-6, 0, 6], [12, 0, 0], [0, 0, -9], uv_scale=(10, 7.5))
    wall = gltf.diffuse("plaster", [0.62, 0.58, 0.52], doubleSided=True)
    gltf.node("ground", mesh=gltf.mesh("ground", (ground, tiles)))
    gltf.node("wall", mesh=gltf.mesh("wall", (plain_quad([-6, 0, -3], [12, 0, 0], [0, 5, 0]), wall)))


# --- the tree ---


def add_tree(gltf):
    pot = gltf.material("terracotta", [0.5, 0.2, 0.11], roughness=0.8, doubleSided=True)
    bark = gltf.diffuse("bark", [0.2, 0.13, 0.08])
    texture = gltf.texture("leaf", leaf_png(48), gltf.sampler(LINEAR, CLAMP_TO_EDGE), embed_in_buffer=True)
    leaf = gltf.material(
        "leaf", [1, 1, 1], roughness=0.55, texture=texture, alphaMode="MASK", alphaCutoff=0.5, doubleSided=True
    )
    tree = gltf.node("tree", translation=[-0.35, 0, -0.3])
    gltf.node("pot", tree, mesh=gltf.mesh("pot", (cylinder(0.3, 0.42, 0.6, 32), pot)))
    gltf.node("trunk", tree, mesh=gltf.mesh("trunk", (cylinder(0.075, 0.045, 1.35, 12), bark)), translation=[0, 0.1, 0])
    gltf.node("crown", tree, mesh=gltf.mesh("crown", (crown(), leaf)), translation=[0, 1.85, 0])


def crown():
    """Leaves in the outer part of an ellipsoid, turned about at random but looking more or less outwards."""
    rng = random.Random(11)
    gauss = lambda: normalize([rng.random() + rng.random() + rng.random() - 1.5 for _ in range(3)])  # noqa: E731
    leaves = []
    for _ in range(LEAVES):
        out = gauss()
        r = (0.45 + 0.55 * rng.random()) ** 0.5
        middle = [0.92 * r * out[0], 0.78 * r * out[1], 0.92 * r * out[2]]
        tilt = gauss()
        leaves.append(leaf_square(middle, normalize([o + 0.9 * t for o, t in zip(out, tilt)]), gauss(), rng))
    return join(leaves)


def leaf_square(middle, normal, about, rng):
    size = 0.2 + 0.12 * rng.random()
    along = sum(a * n for a, n in zip(about, normal))
    u = normalize([a - along * n for a, n in zip(about, normal)])
    v = [normal[1] * u[2] - normal[2] * u[1], normal[2] * u[0] - normal[0] * u[2], normal[0] * u[1] - normal[1] * u[0]]
    corner = [m - size / 2 * (a + b) for m, a, b in zip(middle, u, v)]
    return quad(corner, [size * x for x in u], [size * x for x in v])


def leaf_png(size):
    """A pointed leaf along u with a pale midrib and side veins. The colour goes on where alpha is 0."""

    def texel(x, y):
        u, v = (x + 0.5) / size, (y + 0.5) / size * 2 - 1
        half_width = 0.92 * math.sin(math.pi * u**0.8) ** 0.75 if 0.02 < u < 0.98 else 0
        alpha = min(max((half_width - abs(v)) * size / 6 + 0.5, 0), 1)
        vein = math.cos((u - 0.35 * abs(v)) * 44) > 0.93 or abs(v) < 0.05
        shade = 0.82 + 0.18 * math.cos(3 * v) + (0.25 if vein else 0)
        return [int(min(c * shade, 255)) for c in (92, 142, 46)] + [int(255 * alpha + 0.5)]

    return png.encode(size, size, [[texel(x, y) for x in range(size)] for y in range(size)], alpha=True)


# --- the curtain ---


def add_curtain(gltf):
    sampler = gltf.sampler(LINEAR, REPEAT)
    texture = gltf.texture("lace", lace_png(32), sampler)
    sheer = gltf.diffuse("sheer", [0.93, 0.9, 0.96, 0.85], texture=texture, alphaMode="BLEND", doubleSided=True)
    bar = gltf.material("curtain rod", [0.6, 0.6, 0.62], metallic=1, roughness=0.3)
    gltf.node("curtain", mesh=gltf.mesh("curtain", (folds(1.25, 2.35, 72), sheer)), translation=[0.35, 0.12, 1.3])
    lie = [0, 0, -math.sqrt(0.5), math.sqrt(0.5)]
    gltf.node("rod", mesh=gltf.mesh("rod", (cylinder(0.025, 0.025, 1.5, 12), bar)), translation=[0.2, 2.52, 1.3], rotation=lie)


def folds(width, height, columns):
    """A hanging sheet in sine folds, with smooth normals."""
    shape = Shape([], [])
    for i in range(columns + 1):
        s = i / columns
        phase = 2 * math.pi * 7 * s
        z, slope = 0.06 * math.sin(phase), 0.06 * 2 * math.pi * 7 / width * math.cos(phase)
        shape.positions += [[s * width, 0, z], [s * width, height, z]]
        shape.normals += [normalize([-slope, 0, 1])] * 2
        shape.uvs += [[s * 8, 12], [s * 8, 0]]
        if i < columns:
            a = 2 * i
            shape.indices += [a, a + 2, a + 3, a, a + 3, a + 1]
    return shape


def lace_png(size):
    """Rings on a thin cloth: white, alpha 0.25 to 1."""

    def texel(x, y):
        u, v = (x + 0.5) / size * 2 - 1, (y + 0.5) / size * 2 - 1
        r = math.hypot(u, v)
        ring = math.exp(-((r - 0.62) ** 2) / 0.012)
        return [255, 250 - int(12 * ring), 245, int(255 * (0.25 + 0.75 * ring) + 0.5)]

    return png.encode(size, size, [[texel(x, y) for x in range(size)] for y in range(size)], alpha=True)
