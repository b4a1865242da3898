"""Mitsuba behind a pipe: reads a JSON request a line from stdin, writes a JSON answer a line to stdout."""

import pathlib
import sys
import tempfile
import time

import drjit
import mitsuba
import numpy

from . import camera, mitsuba_metal, protocol, scene_reader
from .places import NotComparable


class Peer:
    """One scene."""

    def __init__(self, scene, threads, **settings):
        drjit.set_thread_count(threads)
        source = scene_reader.read(scene)
        self.settings = settings
        self.source = source
        start = time.perf_counter()
        with tempfile.TemporaryDirectory() as folder:
            self.scene = mitsuba.load_dict(description(source, pathlib.Path(folder)))
        drjit.sync_thread()
        self.load_seconds = time.perf_counter() - start
        self.sensors = {}

    def about(self):
        return {"version": f"Mitsuba {mitsuba.__version__} llvm_ad_rgb", "load": self.load_seconds}

    def sensor(self, size, sampler):
        if (size, sampler) not in self.sensors:
            self.sensors[size, sampler] = mitsuba.load_dict(sensor(self.source, size, sampler))
        return self.sensors[size, sampler]

    def render(self, spp, seed, size, output=None, sampler="independent", max_depth=8):
        """The time is from the call to the finished picture in memory."""
        view = self.sensor(size, sampler)
        integrator = mitsuba.load_dict({"type": "path", "max_depth": max_depth, "rr_depth": 5})
        start = time.perf_counter()
        picture = mitsuba.render(self.scene, sensor=view, integrator=integrator, spp=spp, seed=seed)
        drjit.eval(picture)
        drjit.sync_thread()
        seconds = time.perf_counter() - start
        pixels = picture.numpy()
        if output:
            numpy.save(output, pixels.astype(numpy.float32))
        return {"seconds": seconds, "mean": pixels.mean(axis=(0, 1), dtype=numpy.float64).tolist()}


def description(source, folder):
    """The scene as Mitsuba's dictionary."""
    scene = {"type": "scene"}
    for i, mesh in enumerate(source.meshes):
        path = folder / f"{i}.ply"
        write_ply(path, mesh)
        scene[f"bsdf{i}"] = bsdf(mesh.material) | {"id": f"bsdf{i}"}
        shape = {"type": "ply", "filename": str(path), "face_normals": True, "bsdf": {"type": "ref", "id": f"bsdf{i}"}}
        if mesh.material.radiance:
            shape["emitter"] = {"type": "area", "radiance": rgb(mesh.material.radiance)}
        scene[f"mesh{i}"] = shape
    if source.environment:
        scene["environment"] = {"type": "envmap", "bitmap": environment(source.environment)}
    return scene


def rgb(value):
    return {"type": "rgb", "value": list(value)}


def bsdf(material):
    reflectance = rgb(material.color)
    if material.texture:
        if material.color != [1, 1, 1]:
            raise NotComparable("a texture times a factor has no counterpart in Mitsuba")
        reflectance = {"type": "bitmap", "filename": str(material.texture), "filter_type": "nearest"}
    plain = {"type": "diffuse", "reflectance": reflectance}
    if material.alpha is not None:
        plain = {"type": mitsuba_metal.NAME, "alpha": material.alpha, "specular": rgb(material.color)}
    return {"type": "twosided", "bsdf": plain} if material.double_sided else plain


def write_ply(path, mesh):
    """Binary PLY. Mitsuba's v points down as glTF's does."""
    fields = [("position", "<f4", 3)] + ([("uv", "<f4", 2)] if mesh.uvs is not None else [])
    vertices = numpy.zeros(len(mesh.positions), fields)
    vertices["position"] = mesh.positions
    names = ["x", "y", "z"]
    if mesh.uvs is not None:
        vertices["uv"] = mesh.uvs
        names += ["u", "v"]
    faces = numpy.zeros(len(mesh.triangles), [("n", "u1"), ("v", "<i4", 3)])
    faces["n"], faces["v"] = 3, mesh.triangles
    properties = "".join(f"property float {name}\n" for name in names)
    header = f"ply\nformat binary_little_endian 1.0\nelement vertex {len(vertices)}\n{properties}"
    header += f"element face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n"
    with path.open("wb") as file:
        file.write(header.encode())
        vertices.tofile(file)
        faces.tofile(file)


def environment(path):
    """étendue's picture on Mitsuba's grid.

    Mitsuba's columns begin a quarter turn later. Its rows lie at j / (H − 1), étendue's at (i + 1/2) / H. With 2 H + 1
    rows every other one coincides, the rest are means of two, and linear interpolation gives the same function.
    """
    texels = numpy.array(mitsuba.Bitmap(str(path)), dtype=numpy.float32)
    height, width = texels.shape[:2]
    if width % 4:
        raise NotComparable("the environment's width is no multiple of 4")
    rows = numpy.empty((2 * height + 1, width, 3), numpy.float32)
    rows[1::2] = texels
    rows[2:-1:2] = (texels[1:] + texels[:-1]) / 2
    rows[0], rows[-1] = texels[0], texels[-1]
    return mitsuba.Bitmap(numpy.ascontiguousarray(numpy.roll(rows, -width // 4, axis=1)))


def sensor(source, size, sampler):
    matrix = numpy.array(camera.to_mitsuba(source.camera))
    return {
        "type": "perspective",
        "to_world": mitsuba.ScalarTransform4f(matrix),
        "fov": float(numpy.degrees(source.yfov)),
        "fov_axis": "y",
        "near_clip": 1e-3,
        "far_clip": 1e5,
        "sampler": {"type": sampler},
        "film": {
            "type": "hdrfilm",
            "width": size,
            "height": size,
            "pixel_format": "rgb",
            "component_format": "float32",
            "rfilter": {"type": "box"},
        },
    }


if __name__ == "__main__":
    protocol.serve(Peer, sys.argv[1:])
