"""Reads the glTF files of this benchmark for the peers. Anything without an exact counterpart is an error.

Runs under each peer's own Python: needs numpy alone.
"""

import base64
import json
import pathlib
from dataclasses import dataclass, field

import numpy

from . import camera as cameras
from .places import NotComparable

COMPONENTS = {5121: numpy.uint8, 5123: numpy.uint16, 5125: numpy.uint32, 5126: numpy.float32}
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}


@dataclass
class Material:
    """Lambertian, or an emitter that reflects nothing, or rough metal (GGX, Schlick)."""

    name: str
    color: list
    texture: pathlib.Path | None = None
    radiance: list | None = None
    double_sided: bool = False
    # GGX alpha of a metal whose reflectance at normal incidence is `color`; None: Lambertian.
    alpha: float | None = None


@dataclass
class Mesh:
    """World-space triangles of one material, flat-shaded. positions (n, 3), triangles (m, 3), uvs (n, 2) or None."""

    material: Material
    positions: numpy.ndarray
    triangles: numpy.ndarray
    uvs: numpy.ndarray | None


@dataclass
class Scene:
    """What a peer needs. camera: camera-to-world, row-major; yfov in radians."""

    meshes: list = field(default_factory=list)
    camera: list = None
    yfov: float = 0.0
    # An equirectangular EXR in étendue's orientation.
    environment: pathlib.Path | None = None


class Reader:
    """One file."""

    def __init__(self, path):
        self.folder = path.parent
        self.json = json.loads(path.read_text(encoding="utf-8"))
        self.buffers = [self.read_buffer(buffer["uri"]) for buffer in self.json["buffers"]]

    def read_buffer(self, uri):
        if uri.startswith("data:"):
            return numpy.frombuffer(base64.b64decode(uri.partition(",")[2]), numpy.uint8)
        return numpy.fromfile(self.folder / uri, numpy.uint8)

    def accessor(self, index):
        accessor = self.json["accessors"][index]
        view = self.json["bufferViews"][accessor["bufferView"]]
        if "byteStride" in view or "sparse" in accessor:
            raise NotComparable("the benchmark's reader knows neither strides nor sparse accessors")
        dtype, width = numpy.dtype(COMPONENTS[accessor["componentType"]]), WIDTHS[accessor["type"]]
        start = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
        data = self.buffers[view["buffer"]][start : start + accessor["count"] * width * dtype.itemsize].view(dtype)
        return data.reshape(-1, width) if width > 1 else data

    def material(self, index):
        source = self.json["materials"][index]
        pbr, extensions = source.get("pbrMetallicRoughness", {}), source.get("extensions", {})
        material = Material(source["name"], pbr.get("baseColorFactor", [1, 1, 1, 1])[:3])
        material.double_sided = source.get("doubleSided", False)
        if "baseColorTexture" in pbr:
            texture = self.json["textures"][pbr["baseColorTexture"]["index"]]
            material.texture = self.folder / self.json["images"][texture["source"]]["uri"]
        if any(source.get("emissiveFactor", [0, 0, 0])):
            strength = extensions.get("KHR_materials_emissive_strength", {}).get("emissiveStrength", 1)
            material.radiance = [strength * x for x in source["emissiveFactor"]]
        self.check(source, material, pbr, extensions)
        return material

    def check(self, source, material, pbr, extensions):
        known = {"KHR_materials_specular", "KHR_materials_emissive_strength"}
        if (
            set(extensions) - known
            or {"normalTexture", "emissiveTexture"} & set(source)
            or "metallicRoughnessTexture" in pbr
        ):
            raise NotComparable(f"material {source['name']!r} has maps or extensions without exact counterparts")
        specular = extensions.get("KHR_materials_specular", {}).get("specularFactor", 1)
        metallic = pbr.get("metallicFactor", 1)
        if metallic == 1 and material.texture is None:
            material.alpha = pbr.get("roughnessFactor", 1) ** 2
        elif metallic != 0 or specular != 0:
            raise NotComparable(f"material {source['name']!r} is neither Lambertian nor a plain metal")

    def visit(self, scene, index, parent):
        node = self.json["nodes"][index]
        matrix = cameras.multiply(parent, cameras.of_node(node))
        if "mesh" in node:
            for primitive in self.json["meshes"][node["mesh"]]["primitives"]:
                scene.meshes.append(self.mesh(primitive, numpy.array(matrix)))
        if "camera" in node and scene.camera is None:
            scene.camera = matrix
            scene.yfov = self.json["cameras"][node["camera"]]["perspective"]["yfov"]
        for child in node.get("children", []):
            self.visit(scene, child, matrix)

    def mesh(self, primitive, matrix):
        attributes = primitive["attributes"]
        if "NORMAL" in attributes:
            raise NotComparable("renderers treat interpolated normals differently; the benchmark's meshes are flat")
        positions = self.accessor(attributes["POSITION"])
        if not numpy.array_equal(matrix, numpy.eye(4)):
            positions = (positions.astype(numpy.float64) @ matrix[:3, :3].T + matrix[:3, 3]).astype(numpy.float32)
        triangles = self.accessor(primitive["indices"]).reshape(-1, 3).astype(numpy.uint32)
        uvs = self.accessor(attributes["TEXCOORD_0"]) if "TEXCOORD_0" in attributes else None
        return Mesh(self.material(primitive["material"]), positions, triangles, uvs)


def merge(meshes):
    """One mesh for each material: what suits the peers best."""
    groups = {}
    for mesh in meshes:
        groups.setdefault((mesh.material.name, mesh.uvs is None), []).append(mesh)
    return [join(group) for group in groups.values()]


def join(group):
    firsts = numpy.cumsum([0] + [len(mesh.positions) for mesh in group[:-1]])
    triangles = numpy.concatenate([mesh.triangles + numpy.uint32(first) for mesh, first in zip(group, firsts)])
    positions = numpy.concatenate([mesh.positions for mesh in group])
    uvs = None if group[0].uvs is None else numpy.concatenate([mesh.uvs for mesh in group])
    return Mesh(group[0].material, positions, triangles, uvs)


def read(path):
    """The scene of a file written by scene_writer.py."""
    reader = Reader(pathlib.Path(path))
    scene = Scene()
    for root in reader.json["scenes"][0]["nodes"]:
        reader.visit(scene, root, numpy.eye(4).tolist())
    scene.meshes = merge(scene.meshes)
    environment = reader.folder / "environment.exr"
    scene.environment = environment if environment.exists() else None
    return scene
