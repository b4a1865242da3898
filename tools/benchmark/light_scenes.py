"""Scenes of many small emissive triangles, whose power together does not depend on their number."""

import math

import numpy

from scenes.gltf import Gltf
from scenes.shapes import box, plain_quad

from .scene_writer import Document, write_once

HALF = 12.0  # half a side of the floor, m
AREA = 1.0  # of all lamps together, m²
# Radiances of the lamps of an uneven scene, before they are brought to the same power.
CLASSES = 10.0 ** numpy.linspace(0, 3, 7)


def ceiling(count, random):
    """Evenly spread at 6 m, facing down: all of them matter everywhere."""
    places = spread(count, random, height=(6.0, 6.0))
    return places, facing_down(count), numpy.zeros(count, int)


def street(count, random):
    """Evenly spread at 0.25 to 0.35 m, facing down: few of them matter at a point."""
    places = spread(count, random, height=(0.25, 0.35))
    return places, facing_down(count), numpy.zeros(count, int)


def clusters(count, random):
    """In clusters of 0.2 to 2 m, facing all ways up to 70° from down, of radiances that span a factor of 1000. The camera
    looks down on them and sees none: what is seen directly is noise that no choice of a light changes."""
    centres = random.uniform((-HALF, 0.5, -HALF), (HALF, 2.5, HALF), (16, 3))
    sizes = 0.2 * 10 ** random.uniform(0, 1, 16)
    which = random.integers(16, size=count)
    places = centres[which] + sizes[which, None] * random.normal(size=(count, 3))
    places[:, 1] = numpy.abs(places[:, 1]) + 0.05
    down, turn = random.uniform(math.cos(math.radians(70)), 1, count), random.uniform(0, 2 * math.pi, count)
    across = numpy.sqrt(1 - down**2)
    normals = numpy.stack([across * numpy.cos(turn), -down, across * numpy.sin(turn)], axis=1)
    return places, normals, random.integers(len(CLASSES), size=count)


SCENES = {"ceiling": ceiling, "street": street, "clusters": clusters}


def spread(count, random, height):
    """One point in each of `count` cells of a grid, or in that many of a few more."""
    side = math.ceil(math.sqrt(count))
    cells = random.permutation(side * side)[:count]
    corner = numpy.stack([cells // side, cells % side], axis=1)
    flat = ((corner + random.uniform(size=(count, 2))) / side * 2 - 1) * HALF
    if count == 1:
        flat *= 0
    return numpy.stack([flat[:, 0], random.uniform(*height, count), flat[:, 1]], axis=1)


def facing_down(count):
    return numpy.tile([0.0, -1.0, 0.0], (count, 1))


def writer(name, count):
    """Writes scene `name` with `count` emissive triangles."""

    def write(folder):
        random = numpy.random.default_rng(1)
        places, normals, classes = SCENES[name](count, random)
        document = Document(hall(name, classes).to_json())
        materials = [material["name"] for material in document.json["materials"]]
        for k in numpy.unique(classes):
            positions = triangles(places[classes == k], normals[classes == k], AREA / count)
            faces = numpy.arange(len(positions)).reshape(-1, 3)
            document.add_mesh(f"lamps {k}", positions, faces, materials.index(f"lamp {k}"))
        document.write(folder)

    return write


def path_of(name, count):
    """The scene's file in the cache."""
    return write_once(f"lights-{name}-{count}", writer(name, count), __file__)


def hall(name, classes):
    """A floor with blocks, and the materials of the lamps, whose mean radiance is the same for all scenes."""
    gltf = Gltf(name, "Emissive triangles, from one to many.")
    grey = gltf.diffuse("grey", [0.6, 0.6, 0.6], doubleSided=True)
    floor = plain_quad([-HALF, 0, HALF], [2 * HALF, 0, 0], [0, 0, -2 * HALF])
    gltf.node("floor", mesh=gltf.mesh("floor", (floor, grey)))
    block = gltf.mesh("block", (box(bottom=False), grey))
    for i in range(64):
        x, z = (i % 8 - 3.5) * 3 + 0.7, (i // 8 - 3.5) * 3 + 0.4
        gltf.node(f"block {i}", mesh=block, translation=[x, 0, z], scale=[1, 0.4 + 0.2 * (i * 5 % 8), 1])
    radiance = CLASSES[classes]
    for k in numpy.unique(classes):
        gltf.emitter(f"lamp {k}", [1, 0.9, 0.8], 600 * float(CLASSES[k] / radiance.mean()))
    if name == "clusters":
        gltf.camera("camera", eye=[0, 60, 0], target=[0, 0, -0.001], yfov=23, aspect=1)
    else:
        gltf.camera("camera", eye=[0, 9, 17], target=[0, 0, 1], yfov=50, aspect=1)
    return gltf


def triangles(places, normals, area):
    """Equilateral triangles around points; fronts towards the normals."""
    helper = numpy.where(numpy.abs(normals[:, 1:2]) < 0.9, [[0.0, 1.0, 0.0]], [[1.0, 0.0, 0.0]])
    u = numpy.cross(helper, normals)
    u /= numpy.linalg.norm(u, axis=1, keepdims=True)
    v = numpy.cross(normals, u)
    # Of an equilateral triangle in a circle of radius r the area is 3√3/4 r².
    radius = math.sqrt(area / (0.75 * math.sqrt(3)))
    corners = [places + radius * (math.cos(a) * u + math.sin(a) * v) for a in (0, 2 * math.pi / 3, 4 * math.pi / 3)]
    return numpy.stack(corners, axis=1).reshape(-1, 3)
