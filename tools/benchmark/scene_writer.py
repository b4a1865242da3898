"""The scenes that are measured, written into the cache as glTF.

All surfaces are flat-shaded, and Lambertian (metallic 0, specularFactor 0), emitters, or, in one scene, metal without
textures; textures are looked up nearest. This much can mean the same to all renderers, so that their means can be
required to agree.
"""

import base64
import hashlib
import json
import os
import pathlib
import shutil
import tempfile

import numpy

from scenes import cornell_box

from . import assets
from .places import TOOLS, cache

SPHERE_TRIANGLES = {"spheres-360k": 360_000, "spheres-2m": 2_000_000, "spheres-8m": 8_000_000}
SPHERES = 10
NAMES = ["cornell", "cornell-lambert", *SPHERE_TRIANGLES, *assets.NAMES]


class Document:
    """A glTF file and its buffer in the making."""

    def __init__(self, source):
        self.json = json.loads(source)
        self.chunks = []
        self.size = 0
        buffer = self.json["buffers"][0]["uri"]
        self.append(numpy.frombuffer(base64.b64decode(buffer.partition(",")[2]), numpy.uint8))

    def append(self, array):
        """Appends an array to the buffer and returns where it starts."""
        data = numpy.ascontiguousarray(array).view(numpy.uint8).ravel()
        start, pad = self.size, -data.size % 4
        self.chunks += [data, numpy.zeros(pad, numpy.uint8)]
        self.size += data.size + pad
        return start

    def accessor(self, array, component, kind):
        start = self.append(array)
        self.json["bufferViews"].append({"buffer": 0, "byteOffset": start, "byteLength": array.nbytes})
        accessor = {"bufferView": len(self.json["bufferViews"]) - 1, "componentType": component, "type": kind}
        accessor["count"] = array.size if kind == "SCALAR" else len(array)
        if kind == "VEC3":
            accessor["min"], accessor["max"] = array.min(axis=0).tolist(), array.max(axis=0).tolist()
        self.json["accessors"].append(accessor)
        return len(self.json["accessors"]) - 1

    def add_mesh(self, name, positions, triangles, material):
        """A node at the root with one mesh."""
        attributes = {"POSITION": self.accessor(positions.astype(numpy.float32), 5126, "VEC3")}
        indices = self.accessor(triangles.astype(numpy.uint32).ravel(), 5125, "SCALAR")
        primitive = {"attributes": attributes, "indices": indices, "material": material}
        self.json["meshes"].append({"name": name, "primitives": [primitive]})
        self.json["nodes"].append({"name": name, "mesh": len(self.json["meshes"]) - 1})
        self.json["scenes"][0]["nodes"].append(len(self.json["nodes"]) - 1)

    def write(self, folder):
        data = numpy.concatenate(self.chunks)
        data.tofile(folder / "scene.bin")
        self.json["buffers"] = [{"uri": "scene.bin", "byteLength": int(data.size)}]
        (folder / "scene.gltf").write_text(json.dumps(self.json), encoding="utf-8")


def room(blocks, metal=False):
    """The Cornell box of scenes/, flat-shaded; with its blocks or empty, the tall one of metal or Lambertian."""
    document = Document(cornell_box.build().to_json())
    for mesh in document.json["meshes"]:
        for primitive in mesh["primitives"]:
            primitive["attributes"].pop("NORMAL", None)
    for material in document.json["materials"]:
        if material["pbrMetallicRoughness"]["metallicFactor"] == 1 and not metal:
            material["pbrMetallicRoughness"] |= {"metallicFactor": 0, "roughnessFactor": 1}
            material["extensions"] = {"KHR_materials_specular": {"specularFactor": 0}}
    if not blocks:
        keep = [i for i, node in enumerate(document.json["nodes"]) if "block" not in node["name"]]
        document.json["scenes"][0]["nodes"] = keep
    return document


def write_cornell(folder):
    room(blocks=True, metal=True).write(folder)


def write_cornell_lambert(folder):
    room(blocks=True).write(folder)


def write_spheres(triangles):
    """A writer of the room with ten bumpy spheres of about so many triangles in all."""

    def write(folder):
        document = room(blocks=False)
        positions, faces = bumpy_spheres(triangles)
        names = [material["name"] for material in document.json["materials"]]
        document.add_mesh("spheres", positions, faces, names.index("white"))
        document.write(folder)

    return write


def write_lamps(side):
    """A writer of the room, its lamp replaced by side × side small ones, of 1/4 of the ceiling's area together."""

    def write(folder):
        document = room(blocks=True)
        keep = [i for i in document.json["scenes"][0]["nodes"] if document.json["nodes"][i]["name"] != "lamp"]
        document.json["scenes"][0]["nodes"] = keep
        names = [material["name"] for material in document.json["materials"]]
        document.add_mesh("lamps", *grid_of_quads(side), names.index("lamp"))
        document.write(folder)

    return write


def grid_of_quads(side):
    """side × side quads that face down, a little below the ceiling."""
    cell, h = 2.4 / side, cornell_box.H
    centre = -1.2 + cell * (numpy.arange(side) + 0.5)
    x, z = (grid.ravel() for grid in numpy.meshgrid(centre, centre, indexing="ij"))
    r, y = cell / 4, numpy.full(side * side, 2 * h - 0.01)
    corners = [numpy.stack([x + a * r, y, z + b * r], axis=1) for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    first = numpy.arange(side * side)[:, None] * 4
    faces = numpy.concatenate([first + [0, 1, 2], first + [0, 2, 3]])
    return numpy.stack(corners, axis=1).reshape(-1, 3), faces


def bumpy_spheres(triangles):
    """Ten spheres, each a cube of 6 n² quads pushed out, with bumps of two sizes. The shape is the same for all n."""
    side = max(1, round((triangles / SPHERES / 12) ** 0.5))
    points, faces = cube_sphere(side)
    bump = 0.08 * numpy.sin(7 * points).prod(axis=1) + 0.02 * numpy.sin(29 * points + 1).prod(axis=1)
    points = points * (1 + bump)[:, None]
    places = sphere_places()
    positions = numpy.concatenate([points * radius + centre for centre, radius in places])
    all_faces = numpy.concatenate([faces + i * len(points) for i in range(len(places))])
    return positions.astype(numpy.float32), all_faces


def sphere_places():
    """(centre, radius): three rows of three on the floor, and one on top."""
    places = [((x, 0.36, z), 0.33) for x in (-0.8, 0.0, 0.8) for z in (-0.8, 0.0, 0.8)]
    return [*places, ((0.0, 1.2, 0.0), 0.42)]


def cube_sphere(side):
    """Unit vectors and triangles, counter-clockwise seen from outside; vertices are shared within a cube face."""
    t = numpy.tan(numpy.linspace(-numpy.pi / 4, numpy.pi / 4, side + 1))
    a, b = (grid.ravel() for grid in numpy.meshgrid(t, t, indexing="ij"))
    one = numpy.ones_like(a)
    corners = numpy.arange((side + 1) ** 2).reshape(side + 1, side + 1)
    p, q, r, s = corners[:-1, :-1].ravel(), corners[1:, :-1].ravel(), corners[1:, 1:].ravel(), corners[:-1, 1:].ravel()
    quad = numpy.concatenate([numpy.stack([p, q, r], axis=1), numpy.stack([p, r, s], axis=1)])
    sheets = [(a, b, one), (one, a, b), (b, one, a)]
    points, faces = [], []
    for sign in (1, -1):
        for sheet in sheets:
            faces.append((quad if sign == 1 else quad[:, ::-1]) + len(faces) * len(a))
            points.append(sign * numpy.stack(sheet, axis=1))
    points = numpy.concatenate(points)
    return points / numpy.linalg.norm(points, axis=1, keepdims=True), numpy.concatenate(faces)


CORNELL = {"cornell": write_cornell, "cornell-lambert": write_cornell_lambert}


def writer_of(name):
    if name in CORNELL:
        return CORNELL[name]
    if name in SPHERE_TRIANGLES:
        return write_spheres(SPHERE_TRIANGLES[name])
    return assets.writer_of(name)


def path_of(name):
    """The scene's file in the cache; written if it is not there. The key covers the code that writes it."""
    return write_once(name, writer_of(name))


def write_once(name, writer, *more_sources):
    """A scene in the cache, made by writer(folder) all at once."""
    sources = [pathlib.Path(__file__), pathlib.Path(assets.__file__), *sorted((TOOLS / "scenes").glob("*.py"))]
    sources += map(pathlib.Path, more_sources)
    key = hashlib.sha256(b"".join(path.read_bytes() for path in sources)).hexdigest()[:12]
    folder = cache() / "scenes" / f"{name}-{key}"
    if not (folder / "scene.gltf").exists():
        folder.parent.mkdir(parents=True, exist_ok=True)
        work = pathlib.Path(tempfile.mkdtemp(dir=folder.parent))
        writer(work)
        shutil.rmtree(folder, ignore_errors=True)
        os.rename(work, folder)
    return folder / "scene.gltf"


def hash_of(path):
    """Of all files of a scene."""
    digest = hashlib.sha256()
    for part in sorted(path.parent.iterdir()):
        digest.update(part.name.encode())
        digest.update(part.read_bytes())
    return digest.hexdigest()
