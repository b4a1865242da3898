"""A room with 200 lamps."""

import colorsys
import math
import random

from .gltf import Gltf, about_y
from .shapes import Shape, box, cylinder, frame, join, plain_quad, sphere

X, Y, Z = 4, 3, 3  # the room is [-X, X] × [0, Y] × [-Z, Z]
MATERIALS, LAMPS_EACH = 40, 5


def build():
    gltf = Gltf(
        "many lights",
        "Choosing among lights: 200 small one-sided triangles and squares of 40 colours whose radiances span a factor "
        "of 300, two point lights, a spot light, and a sun that enters by a window.",
    )
    add_room(gltf)
    add_things(gltf)
    add_lamps(gltf)
    gltf.light("warm bulb", "point", [1, 0.7, 0.4], 1.6, eye=[2.6, 1.5, -2.1])
    gltf.light("blue bulb", "point", [0.3, 0.5, 1], 1.2, eye=[-2.9, 0.7, -1.2], range=6)
    cone = {"innerConeAngle": 0.15, "outerConeAngle": 0.42}
    gltf.light("spot", "spot", [1, 0.95, 0.9], 9, eye=[0.3, 2.9, 1.2], target=[0.1, 0, -0.9], spot=cone)
    gltf.light("sun", "directional", [1, 0.93, 0.82], 8, eye=[-7, 4.8, 1.5], target=[0, 0, -0.6])
    gltf.camera("camera", eye=[3.5, 1.75, 2.6], target=[-1.1, 1.0, -1.1], yfov=52, aspect=1.5)
    return gltf


def add_room(gltf):
    wall = gltf.diffuse("wall", [0.72, 0.7, 0.66], doubleSided=True)
    floor = gltf.material("floor", [0.32, 0.2, 0.12], roughness=0.4, doubleSided=True)
    walls = [
        plain_quad([-X, Y, -Z], [2 * X, 0, 0], [0, 0, 2 * Z]),
        plain_quad([-X, 0, -Z], [2 * X, 0, 0], [0, Y, 0]),
        plain_quad([X, 0, Z], [-2 * X, 0, 0], [0, Y, 0]),
        plain_quad([X, 0, -Z], [0, 0, 2 * Z], [0, Y, 0]),
        frame([-X, 0, Z], [0, 0, -2 * Z], [0, Y, 0], 0.3, 0.6, 0.35, 0.8),  # the window
    ]
    gltf.node("walls", mesh=gltf.mesh("walls", (join(walls), wall)))
    gltf.node("floor", mesh=gltf.mesh("floor", (plain_quad([-X, 0, Z], [2 * X, 0, 0], [0, 0, -2 * Z]), floor)))


def add_things(gltf):
    """What the lights shine on and throw shadows of."""
    stone = gltf.diffuse("stone", [0.55, 0.53, 0.5])
    paint = gltf.material("blue paint", [0.08, 0.16, 0.42], roughness=0.3)
    brass = gltf.material("brass", [0.89, 0.72, 0.36], metallic=1, roughness=0.25)
    column = gltf.mesh("column", (cylinder(0.22, 0.18, Y, 24), stone))
    for name, x, z in [("left column", -1.9, -1.9), ("right column", 1.3, -1.9)]:
        gltf.node(name, mesh=column, translation=[x, 0, z])
    block = box(bottom=False)
    table = gltf.node("table", mesh=gltf.mesh("plinth", (block, stone)), translation=[0.1, 0, -0.9], scale=[1.1, 0.5, 1.1])
    crate = gltf.mesh("crate", (block, paint))
    gltf.node("crate", mesh=crate, translation=[-2.5, 0, 0.5], rotation=about_y(28), scale=[0.8, 0.9, 0.8])
    ball = gltf.mesh("ball", (sphere(3), brass))
    size = 0.36
    gltf.node("ball", table, mesh=ball, translation=[0, 1 + size / 0.5, 0], scale=[size / 1.1, size / 0.5, size / 1.1])
    gltf.node("small ball", mesh=ball, translation=[1.5, 0.25, 0.1], scale=[0.25] * 3)


def add_lamps(gltf):
    """One mesh, a primitive for each material."""
    rng = random.Random(7)
    parts = []
    for i in range(MATERIALS):
        rgb = colorsys.hsv_to_rgb(i * 0.618034 % 1, 0.25 + 0.6 * rng.random(), 1)
        radiance = 3 * 300 ** rng.random()
        # Each lamp is at a distance of its own from the wall, so that no two are in one plane.
        gaps = [0.02 + 0.0005 * (i * LAMPS_EACH + k) for k in range(LAMPS_EACH)]
        lamps = [lamp(rng, radiance, gap) for gap in gaps]
        parts.append((join(lamps), gltf.emitter(f"lamp {i}", [round(c, 3) for c in rgb], round(radiance, 3))))
    gltf.node("lamps", mesh=gltf.mesh("lamps", *parts))


def lamp(rng, radiance, gap):
    """A triangle or square at the distance gap from the ceiling or a wall, facing the room; the brighter the smaller."""
    size = min(0.16, 0.5 / math.sqrt(radiance)) * (0.6 + 0.8 * rng.random())
    along, up = rng.random() * 1.8 - 0.9, 0.1 + 0.85 * rng.random()
    place = rng.choice(["ceiling", "ceiling", "back", "left", "right", "skirting"])
    if place == "ceiling":
        corner, u, v = [along * X, Y - gap, (2 * up - 1) * 0.9 * Z], [1, 0, 0], [0, 0, 1]
    elif place == "back":
        corner, u, v = [along * X, up * (Y - 0.3), -Z + gap], [1, 0, 0], [0, 1, 0]
    elif place == "left":
        corner, u, v = [-X + gap, up * (Y - 0.3), -(0.25 + 0.7 * abs(along)) * Z], [0, 0, -1], [0, 1, 0]
    elif place == "right":
        corner, u, v = [X - gap, up * (Y - 0.3), along * Z * 0.9], [0, 0, 1], [0, 1, 0]
    else:
        corner, u, v = [along * X, 0.05, -Z + gap], [1, 0, 0], [0, 1, 0]
    shape = plain_quad(corner, [size * x for x in u], [size * x for x in v])
    return shape if rng.random() < 0.5 else Shape(shape.positions[:3], [0, 1, 2])
