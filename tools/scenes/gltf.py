"""A glTF 2.0 file in the making: geometry goes into one embedded buffer, the rest is JSON."""

import base64
import json
import math
import struct

from .shapes import Shape

ARRAY_BUFFER, ELEMENT_ARRAY_BUFFER = 34962, 34963
UNSIGNED_SHORT, FLOAT = 5123, 5126
NEAREST, LINEAR = 9728, 9729
REPEAT, CLAMP_TO_EDGE, MIRRORED_REPEAT = 10497, 33071, 33648
COPYRIGHT = "CC0 1.0, the étendue authors"


def tidy(x):
    """x with at most 9 decimals, so that the last bit of a platform's sine does not reach the file."""
    x = round(x, 9)
    return int(x) if x == int(x) else x


def f32(x):
    """x rounded to 6 decimals and then to the nearest float, as a double."""
    return struct.unpack("<f", struct.pack("<f", round(x, 6) + 0.0))[0]


def look_at(eye, target):
    """The unit quaternion (x, y, z, w) that turns −Z from eye to target and keeps +Y up."""
    x, y, z = (t - e for t, e in zip(target, eye))
    yaw = math.atan2(-x, -z)
    pitch = math.atan2(y, math.hypot(x, z))
    cy, sy, cp, sp = math.cos(yaw / 2), math.sin(yaw / 2), math.cos(pitch / 2), math.sin(pitch / 2)
    return [cy * sp, sy * cp, -sy * sp, cy * cp]


def about_y(degrees):
    """The unit quaternion of a turn about +Y."""
    return [0, math.sin(math.radians(degrees) / 2), 0, math.cos(math.radians(degrees) / 2)]


class Gltf:
    """`about` says in a sentence or more what the scene tests; it becomes the asset's extras."""

    def __init__(self, name, about):
        self.buffer = bytearray()
        self.extensions = set()
        self.json = {
            "asset": {
                "version": "2.0",
                "generator": "étendue tools/make-scenes",
                "copyright": COPYRIGHT,
                "extras": {"about": about},
            },
            "scene": 0,
            "scenes": [{"name": name, "nodes": []}],
        }

    def add(self, kind, item):
        """Appends to a top-level array and returns the index."""
        self.json.setdefault(kind, []).append(item)
        return len(self.json[kind]) - 1

    # --- geometry ---

    def view(self, data, target=None):
        self.buffer += bytes(-len(self.buffer) % 4)
        view = {"buffer": 0, "byteOffset": len(self.buffer), "byteLength": len(data)}
        if target:
            view["target"] = target
        self.buffer += data
        return self.add("bufferViews", view)

    def floats(self, rows, bounds=False):
        rows = [[f32(x) for x in row] for row in rows]
        data = b"".join(struct.pack(f"<{len(row)}f", *row) for row in rows)
        accessor = {
            "bufferView": self.view(data, ARRAY_BUFFER),
            "componentType": FLOAT,
            "count": len(rows),
            "type": f"VEC{len(rows[0])}",
        }
        if bounds:
            accessor["min"] = [min(column) for column in zip(*rows)]
            accessor["max"] = [max(column) for column in zip(*rows)]
        return self.add("accessors", accessor)

    def indices(self, indices):
        data = struct.pack(f"<{len(indices)}H", *indices)
        view = self.view(data, ELEMENT_ARRAY_BUFFER)
        accessor = {"bufferView": view, "componentType": UNSIGNED_SHORT, "count": len(indices), "type": "SCALAR"}
        return self.add("accessors", accessor)

    def primitive(self, shape: Shape, material):
        attributes = {"POSITION": self.floats(shape.positions, bounds=True)}
        if shape.normals:
            attributes["NORMAL"] = self.floats(shape.normals)
        if shape.uvs:
            attributes["TEXCOORD_0"] = self.floats(shape.uvs)
        return {"attributes": attributes, "indices": self.indices(shape.indices), "material": material}

    def mesh(self, name, *parts):
        """parts: (shape, material) pairs, or finished primitives."""
        primitives = [part if isinstance(part, dict) else self.primitive(*part) for part in parts]
        return self.add("meshes", {"name": name, "primitives": primitives})

    # --- what is seen ---

    def use(self, extension, settings):
        """An `extensions` object, noted in extensionsUsed."""
        self.extensions.add(extension)
        return {extension: settings}

    def material(self, name, color, metallic=0, roughness=1, texture=None, **more):
        """color: linear RGB or RGBA. more: glTF's own material properties."""
        pbr = {"baseColorFactor": [*color, 1][:4], "metallicFactor": metallic, "roughnessFactor": roughness}
        if texture is not None:
            pbr["baseColorTexture"] = {"index": texture}
        return self.add("materials", {"name": name, "pbrMetallicRoughness": pbr, **more})

    def diffuse(self, name, color, **more):
        """Lambert's law and nothing else: no specular lobe."""
        extensions = self.use("KHR_materials_specular", {"specularFactor": 0})
        return self.material(name, color, extensions=extensions, **more)

    def emitter(self, name, color, strength, **more):
        """Emits color × strength (W·sr⁻¹·m⁻²), reflects nothing."""
        extensions = {
            **self.use("KHR_materials_emissive_strength", {"emissiveStrength": tidy(strength)}),
            **self.use("KHR_materials_specular", {"specularFactor": 0}),
        }
        return self.material(name, [0, 0, 0], emissiveFactor=color, extensions=extensions, **more)

    def sampler(self, filter_mode, wrap):
        return self.add("samplers", {"magFilter": filter_mode, "minFilter": filter_mode, "wrapS": wrap, "wrapT": wrap})

    def texture(self, name, png, sampler, embed_in_buffer=False):
        """A PNG, as a data URI or in the buffer."""
        if embed_in_buffer:
            image = {"name": name, "mimeType": "image/png", "bufferView": self.view(png)}
        else:
            image = {"name": name, "uri": "data:image/png;base64," + base64.b64encode(png).decode()}
        return self.add("textures", {"name": name, "source": self.add("images", image), "sampler": sampler})

    # --- where it is ---

    def node(self, name, parent=None, **what):
        """A node under `parent` or at the root; what: mesh, translation, rotation, scale, ..."""
        node = self.add("nodes", {"name": name, **what})
        siblings = self.json["scenes"][0]["nodes"] if parent is None else self.json["nodes"][parent].setdefault("children", [])
        siblings.append(node)
        return node

    def camera(self, name, eye, target, yfov, aspect):
        """yfov in degrees."""
        perspective = {"yfov": tidy(math.radians(yfov)), "aspectRatio": aspect, "znear": 0.01}
        camera = self.add("cameras", {"name": name, "type": "perspective", "perspective": perspective})
        return self.node(name, camera=camera, translation=eye, rotation=look_at(eye, target))

    def light(self, name, kind, color, intensity, eye=(0, 0, 0), target=(0, 0, -1), **more):
        """A punctual light; more: range, spot."""
        self.extensions.add("KHR_lights_punctual")
        lights = self.json.setdefault("extensions", {}).setdefault("KHR_lights_punctual", {"lights": []})["lights"]
        lights.append({"name": name, "type": kind, "color": color, "intensity": intensity, **more})
        place = {"translation": eye}
        if kind != "point":
            place["rotation"] = look_at(eye, target)
        return self.node(name, **place, extensions={"KHR_lights_punctual": {"light": len(lights) - 1}})

    # --- the file ---

    def to_json(self):
        """The file's text: one line for each element of a top-level array."""
        uri = "data:application/octet-stream;base64," + base64.b64encode(self.buffer).decode()
        document = {**self.json, "buffers": [{"byteLength": len(self.buffer), "uri": uri}]}
        if self.extensions:
            document["extensionsUsed"] = sorted(self.extensions)
        fields = []
        for key, value in document.items():
            if isinstance(value, list) and isinstance(value[0], dict):
                text = "[\n" + ",\n".join("  " + dump(item) for item in value) + "\n ]"
            else:
                text = dump(value)
            fields.append(f' "{key}": {text}')
        return "{\n" + ",\n".join(fields) + "\n}\n"


def dump(value):
    return json.dumps(clean(value), ensure_ascii=False)


def clean(value):
    """Numbers made tidy. Accessor bounds are floats already and stay exact."""
    if isinstance(value, dict):
        return {key: item if key in ("min", "max") else clean(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [clean(item) for item in value]
    return tidy(value) if isinstance(value, float) else value
