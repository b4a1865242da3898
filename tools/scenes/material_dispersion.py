"""Prisms over their dispersion, before a bright slit."""

import math

from .gltf import Gltf
from .shapes import join, plain_quad, quad

DISPERSION = [0, 0.36, 1, 2.5]
IOR, APEX = 1.5, math.radians(60)
# Of the ray that goes through symmetrically: sin((apex + deviation) / 2) = n sin(apex / 2).
DEVIATION = 2 * math.asin(IOR * math.sin(APEX / 2)) - APEX
EYE, SLIT = 4, 6  # distances from the prisms


def build():
    gltf = Gltf(
        "dispersion",
        "KHR_materials_dispersion: glass prisms of index 1.5 and an apex of 60 degrees, dispersion 0, 0.36 (flint "
        "glass, Abbe number 56), 1 and 2.5 from top to bottom. Behind them, beyond the picture's right edge, stands "
        "a bright white slit where a prism shows it at the least deviation, 37.2 degrees. Without dispersion its "
        "image is white; with it, it is a spectrum whose width grows in proportion, from violet, deviated most and "
        "shown nearest to the apex, on the left, to red. The narrow white images at the right edge were reflected "
        "totally inside, which undoes the dispersion.",
    )
    dark = gltf.diffuse("dark wall", [0.25, 0.25, 0.25], doubleSided=True)
    gltf.node("wall", mesh=gltf.mesh("wall", (plain_quad([-12, -4, -9], [24, 0, 0], [0, 8, 0]), dark)))
    for i, dispersion in enumerate(DISPERSION):
        extensions = {
            **gltf.use("KHR_materials_transmission", {"transmissionFactor": 1}),
            **gltf.use("KHR_materials_volume", {"thicknessFactor": 1}),
            **gltf.use("KHR_materials_dispersion", {"dispersion": dispersion}),
        }
        glass = gltf.material(f"dispersion {dispersion}", [1, 1, 1], roughness=0, extensions=extensions)
        gltf.node(f"prism {dispersion}", mesh=gltf.mesh("prism", (prism(), glass)), translation=[0, 0.39 - 0.26 * i, 0])
    add_lights(gltf)
    gltf.camera("camera", eye=[0, 0, EYE], target=[0, 0, 0], yfov=16, aspect=1)
    return gltf


def add_lights(gltf):
    """The slit, turned to the prisms, and a dim lamp that lets their front faces be seen."""
    middle = [SLIT * math.sin(DEVIATION), 0, -SLIT * math.cos(DEVIATION)]
    along = [0.06 * math.cos(DEVIATION), 0, 0.06 * math.sin(DEVIATION)]
    corner = [m - a / 2 - h for m, a, h in zip(middle, along, [0, 3, 0])]
    slit = plain_quad(corner, along, [0, 6, 0])
    gltf.node("slit", mesh=gltf.mesh("slit", (slit, gltf.emitter("slit", [1, 1, 1], 5))))
    gltf.light("lamp", "point", [1, 1, 1], 40, eye=[-3, 3, 3])


def prism():
    """Of height 0.2, its edge of 60 degrees where a ray along -Z goes through symmetrically, bent towards +X."""
    half = DEVIATION / 2
    inside, apex = [math.sin(half), -math.cos(half)], [-math.cos(half), -math.sin(half)]
    r = 0.5
    corners = [
        [r * apex[0], r * apex[1]],
        [-r / 2 * apex[0] - r * math.sqrt(0.75) * inside[0], -r / 2 * apex[1] - r * math.sqrt(0.75) * inside[1]],
        [-r / 2 * apex[0] + r * math.sqrt(0.75) * inside[0], -r / 2 * apex[1] + r * math.sqrt(0.75) * inside[1]],
    ]
    sides = [
        quad([a[0], -0.1, a[1]], [b[0] - a[0], 0, b[1] - a[1]], [0, 0.2, 0])
        for a, b in zip(corners, corners[1:] + corners[:1])
    ]
    shape = join(sides)
    for y, turn in [(0.1, (0, 1, 2)), (-0.1, (0, 2, 1))]:
        first = len(shape.positions)
        shape.positions += [[corners[i][0], y, corners[i][1]] for i in turn]
        shape.normals += [[0, 1 if y > 0 else -1, 0]] * 3
        shape.indices += [first, first + 1, first + 2]
    shape.uvs = []
    return shape
