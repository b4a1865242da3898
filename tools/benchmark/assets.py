"""Lambertian, flat-shaded variants of others' assets, under an environment map of theirs.

Base colour factors and textures stay; metal, roughness, normal maps, emission, transmission and opacity go, for no
peer has exact counterparts of them. Textures become 8-bit RGB PNG files, which everyone decodes alike.
"""

import json
import struct

import numpy

from . import camera
from .places import BenchError, shared_assets
from .scene_reader import COMPONENTS, WIDTHS

NAMES = {
    "flight-helmet": ("FlightHelmet/FlightHelmet.gltf", "brown_photostudio_02_1k.hdr"),
    "barn-lamp": ("AnisotropyBarnLamp/AnisotropyBarnLamp.gltf", "noon_grass_1k.hdr"),
    "roughness-test": ("TransmissionRoughnessTest.glb", "autoshop_01_1k.hdr"),
}


def writer_of(name):
    """A writer of that variant."""
    folder = shared_assets()
    if folder is None:
        raise BenchError(f"scene {name} needs a folder of assets; set ETENDUE_SHARED to the folder that holds assets/")
    model, environment = NAMES[name]
    return lambda target: write(folder / "models" / model, folder / "hdri" / environment, target)


def write(model, environment, target):
    """Writes scene.gltf, scene.bin, the textures and environment.exr."""
    source, buffers, images = load(model)
    Variant(source, buffers, images, target).write()
    write_environment(environment, target / "environment.exr")


def load(path):
    """(JSON, buffers, a function that reads an image's bytes) of a .gltf or .glb file."""
    data = path.read_bytes()
    chunk = None
    if data[:4] == b"glTF":
        length = struct.unpack_from("<I", data, 12)[0]
        chunk, data = data[28 + length :], data[20 : 20 + length]
    source = json.loads(data)
    read = lambda buffer: (path.parent / buffer["uri"]).read_bytes() if "uri" in buffer else chunk  # noqa: E731
    buffers = [read(buffer) for buffer in source["buffers"]]

    def image(index):
        entry = source["images"][index]
        if "uri" in entry:
            return (path.parent / entry["uri"]).read_bytes()
        view = source["bufferViews"][entry["bufferView"]]
        start = view.get("byteOffset", 0)
        return buffers[view["buffer"]][start : start + view["byteLength"]]

    return source, buffers, image


class Variant:
    """A new document with the old geometry and base colours."""

    def __init__(self, source, buffers, image, target):
        self.source, self.buffers, self.image, self.target = source, buffers, image, target
        self.data, self.json = bytearray(), {"asset": {"version": "2.0"}, "scene": 0}
        self.box = [numpy.full(3, numpy.inf), numpy.full(3, -numpy.inf)]

    def add(self, kind, item):
        self.json.setdefault(kind, []).append(item)
        return len(self.json[kind]) - 1

    def array(self, index):
        accessor = self.source["accessors"][index]
        view = self.source["bufferViews"][accessor["bufferView"]]
        dtype, width = numpy.dtype(COMPONENTS[accessor["componentType"]]), WIDTHS[accessor["type"]]
        start = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
        size = width * dtype.itemsize
        stride = view.get("byteStride", size)
        shape, strides = (accessor["count"], width), (stride, dtype.itemsize)
        return numpy.ndarray(shape, dtype, self.buffers[view["buffer"]], start, strides).copy()

    def accessor(self, array, component, kind):
        self.data += bytes(-len(self.data) % 4)
        view = self.add("bufferViews", {"buffer": 0, "byteOffset": len(self.data), "byteLength": array.nbytes})
        self.data += array.tobytes()
        item = {"bufferView": view, "componentType": component, "count": len(array), "type": kind}
        if kind == "VEC3":
            item |= {"min": array.min(axis=0).tolist(), "max": array.max(axis=0).tolist()}
        return self.add("accessors", item)

    def visit(self, index, parent):
        node = self.source["nodes"][index]
        matrix = camera.multiply(parent, camera.of_node(node))
        if "mesh" in node:
            for primitive in self.source["meshes"][node["mesh"]]["primitives"]:
                self.primitive(primitive, numpy.array(matrix))
        for child in node.get("children", []):
            self.visit(child, matrix)

    def primitive(self, source, matrix):
        """Positions go to world space here, so that all renderers get the same floats."""
        positions = self.array(source["attributes"]["POSITION"]).astype(numpy.float64)
        positions = (positions @ matrix[:3, :3].T + matrix[:3, 3]).astype(numpy.float32)
        self.box = [
            numpy.minimum(self.box[0], positions.min(axis=0)),
            numpy.maximum(self.box[1], positions.max(axis=0)),
        ]
        attributes = {"POSITION": self.accessor(positions, 5126, "VEC3")}
        material = self.material(source["material"])
        if "baseColorTexture" in self.json["materials"][material]["pbrMetallicRoughness"]:
            uvs = self.array(source["attributes"]["TEXCOORD_0"]).astype(numpy.float32)
            attributes["TEXCOORD_0"] = self.accessor(uvs, 5126, "VEC2")
        indices = self.array(source["indices"]).ravel().astype(numpy.uint32)
        primitive = {"attributes": attributes, "material": material}
        primitive["indices"] = self.accessor(indices, 5125, "SCALAR")
        mesh = self.add("meshes", {"primitives": [primitive]})
        self.add("nodes", {"mesh": mesh})

    def material(self, index):
        source = self.source["materials"][index].get("pbrMetallicRoughness", {})
        pbr = {"baseColorFactor": [*source.get("baseColorFactor", [1, 1, 1])[:3], 1], "metallicFactor": 0}
        if "baseColorTexture" in source:
            texture = self.source["textures"][source["baseColorTexture"]["index"]]
            pbr["baseColorTexture"] = {"index": self.texture(texture["source"])}
        extensions = {"KHR_materials_specular": {"specularFactor": 0}}
        name = f"material {index}"
        known = [i for i, m in enumerate(self.json.get("materials", [])) if m["name"] == name]
        material = {"name": name, "pbrMetallicRoughness": pbr, "extensions": extensions, "doubleSided": True}
        return known[0] if known else self.add("materials", material)

    def texture(self, image):
        name = f"image{image}.png"
        if not (self.target / name).exists():
            write_png(self.image(image), self.target / name)
        known = [i for i, entry in enumerate(self.json.get("images", [])) if entry["uri"] == name]
        if known:
            return known[0]
        self.add("images", {"uri": name})
        return self.add("textures", {"source": len(self.json["images"]) - 1, "sampler": 0})

    def write(self):
        scene = self.source["scenes"][self.source.get("scene", 0)]
        self.json["samplers"] = [{"magFilter": 9728, "minFilter": 9728}]
        for root in scene["nodes"]:
            self.visit(root, numpy.eye(4).tolist())
        self.add_camera()
        self.json["scenes"] = [{"nodes": list(range(len(self.json["nodes"])))}]
        self.json["extensionsUsed"] = ["KHR_materials_specular"]
        self.json["buffers"] = [{"uri": "scene.bin", "byteLength": len(self.data)}]
        (self.target / "scene.bin").write_bytes(self.data)
        (self.target / "scene.gltf").write_text(json.dumps(self.json), encoding="utf-8")

    def add_camera(self):
        """Looks at the middle of the asset from the front, from where its bounding sphere just fits."""
        centre, yfov = (self.box[0] + self.box[1]) / 2, 0.6
        radius = numpy.linalg.norm(self.box[1] - self.box[0]) / 2
        direction = numpy.array([0.45, 0.3, 1.0])
        eye = centre + direction / numpy.linalg.norm(direction) * radius / numpy.sin(yfov / 2)
        perspective = {"yfov": yfov, "aspectRatio": 1, "znear": float(radius) / 100}
        self.add("cameras", {"type": "perspective", "perspective": perspective})
        rotation = camera.look_at_quaternion(eye.tolist(), centre.tolist())
        self.add("nodes", {"camera": 0, "translation": eye.tolist(), "rotation": rotation})


def write_png(data, path):
    """Any picture as 8-bit RGB PNG."""
    mitsuba = scalar_mitsuba()
    source = path.with_suffix(".source")
    source.write_bytes(data)
    picture = mitsuba.Bitmap(str(source))
    source.unlink()
    picture.convert(mitsuba.Bitmap.PixelFormat.RGB, mitsuba.Struct.Type.UInt8, True).write(str(path))


def scalar_mitsuba():
    """Mitsuba for its picture class; this variant needs no LLVM."""
    import mitsuba

    mitsuba.set_variant("scalar_rgb")
    return mitsuba


def write_environment(source, target):
    """An .hdr file as a 32-bit EXR."""
    mitsuba = scalar_mitsuba()
    picture = mitsuba.Bitmap(str(source))
    picture.convert(mitsuba.Bitmap.PixelFormat.RGB, mitsuba.Struct.Type.Float32, False).write(str(target))
