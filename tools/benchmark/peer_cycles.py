"""Cycles (PyPI bpy) behind a pipe: reads a JSON request a line from stdin, writes a JSON answer a line to stdout."""

import math
import os
import re
import sys
import tempfile
import time

import bpy
import mathutils
import numpy

from . import camera, protocol, scene_reader


class Peer:
    """One scene."""

    def __init__(self, scene, threads):
        source = scene_reader.read(scene)
        start = time.perf_counter()
        bpy.ops.wm.read_factory_settings(use_empty=True)
        self.scene = bpy.context.scene
        for i, mesh in enumerate(source.meshes):
            add_mesh(self.scene, f"mesh{i}", mesh)
        add_camera(self.scene, source)
        add_world(self.scene, source)
        configure(self.scene, threads)
        self.load_seconds = time.perf_counter() - start

    def about(self):
        return {"version": f"Cycles {bpy.app.version_string}", "load": self.load_seconds}

    def render(self, spp, seed, size, output=None, max_depth=8):
        """The time is Cycles' own, without the synchronisation of the scene: it writes it into the picture."""
        render, cycles = self.scene.render, self.scene.cycles
        render.resolution_x = render.resolution_y = size
        cycles.samples, cycles.seed = spp, seed
        set_depth(cycles, max_depth)
        with tempfile.TemporaryDirectory() as folder:
            path = output or os.path.join(folder, "picture.exr")
            render.filepath = path
            start = time.perf_counter()
            bpy.ops.render.render(write_still=True)
            wall = time.perf_counter() - start
            seconds = render_seconds(path)
        return {"seconds": seconds, "wall": wall}


def set_depth(cycles, max_depth):
    """A path of B bounces in Blender's sense has B + 2 edges: the light at its end is not counted.

    Roulette begins at the vertex after min_light_bounces + 2 bounces: the fifth edge's end.
    """
    cycles.max_bounces = max_depth - 2
    for kind in ("diffuse", "glossy", "transmission", "volume"):
        setattr(cycles, f"{kind}_bounces", max_depth - 2)
    cycles.min_light_bounces = 2


def render_seconds(path):
    """From the picture's header, to 10 ms: the total time is this and that of synchronisation."""
    with open(path, "rb") as file:
        return stamp(file.read(65536).decode("latin-1"), "render_time")


def stamp(header, name):
    """A string attribute like cycles.ViewLayer.render_time: [[hours:]minutes:]seconds."""
    found = re.search(r"cycles\.[^\0]*\." + name + r"\0string\0....([0-9:.]+)", header, re.DOTALL)
    if not found:
        raise RuntimeError(f"Cycles wrote no {name} into its picture")
    seconds = 0.0
    for part in found.group(1).split(":"):
        seconds = 60 * seconds + float(part)
    return seconds


def add_mesh(scene, name, source):
    """Flat-shaded triangles in Blender's Z-up world."""
    positions = source.positions[:, [0, 2, 1]] * numpy.float32([1, -1, 1])
    mesh = bpy.data.meshes.new(name)
    count = len(source.triangles)
    mesh.vertices.add(len(positions))
    mesh.vertices.foreach_set("co", positions.ravel())
    mesh.loops.add(3 * count)
    mesh.loops.foreach_set("vertex_index", source.triangles.astype(numpy.int32).ravel())
    mesh.polygons.add(count)
    mesh.polygons.foreach_set("loop_start", numpy.arange(0, 3 * count, 3, dtype=numpy.int32))
    if source.uvs is not None:
        # Blender's v points up, glTF's down.
        uvs = source.uvs[source.triangles.ravel()] * numpy.float32([1, -1]) + numpy.float32([0, 1])
        mesh.uv_layers.new().uv.foreach_set("vector", uvs.ravel())
    mesh.update()
    mesh.shade_flat()
    mesh.materials.append(add_material(source.material))
    scene.collection.objects.link(bpy.data.objects.new(name, mesh))


def add_material(source):
    material = bpy.data.materials.new(source.name)
    material.use_nodes = True
    nodes, links = material.node_tree.nodes, material.node_tree.links
    nodes.clear()
    output = nodes.new("ShaderNodeOutputMaterial")
    if source.radiance:
        # One side is sampled. The other side of the lamps here is never seen.
        material.cycles.emission_sampling = "FRONT"
        shader = nodes.new("ShaderNodeEmission")
        strength = max(source.radiance)
        shader.inputs["Color"].default_value = [x / strength for x in source.radiance] + [1]
        shader.inputs["Strength"].default_value = strength
    elif source.alpha is not None:
        shader = add_metal(nodes, source)
    else:
        shader = nodes.new("ShaderNodeBsdfDiffuse")
        shader.inputs["Roughness"].default_value = 0
        shader.inputs["Color"].default_value = [*source.color, 1]
        if source.texture:
            links.new(add_texture(nodes, source.texture).outputs["Color"], shader.inputs["Color"])
    links.new(shader.outputs[0], output.inputs["Surface"])
    return material


def add_metal(nodes, source):
    """Schlick's Fresnel term (a white edge tint changes nothing) over single-scattering GGX."""
    shader = nodes.new("ShaderNodeBsdfPrincipled")
    shader.distribution = "GGX"
    shader.inputs["Metallic"].default_value = 1
    shader.inputs["Roughness"].default_value = math.sqrt(source.alpha)
    shader.inputs["Base Color"].default_value = [*source.color, 1]
    shader.inputs["Specular Tint"].default_value = (1, 1, 1, 1)
    return shader


def add_texture(nodes, path):
    texture = nodes.new("ShaderNodeTexImage")
    texture.image = bpy.data.images.load(str(path), check_existing=True)
    texture.interpolation = "Closest"
    return texture


def add_camera(scene, source):
    data = bpy.data.cameras.new("camera")
    data.sensor_fit = "VERTICAL"
    data.angle_y = source.yfov
    data.clip_start, data.clip_end = 1e-3, 1e5
    item = bpy.data.objects.new("camera", data)
    item.matrix_world = mathutils.Matrix(camera.to_blender(source.camera))
    scene.collection.objects.link(item)
    scene.camera = item


def add_world(scene, source):
    """Blender's equirectangular pictures lie as étendue's do once the world has its Z up."""
    world = bpy.data.worlds.new("world")
    scene.world = world
    world.use_nodes = True
    nodes, links = world.node_tree.nodes, world.node_tree.links
    nodes.clear()
    output, background = nodes.new("ShaderNodeOutputWorld"), nodes.new("ShaderNodeBackground")
    background.inputs["Color"].default_value = (0, 0, 0, 1)
    if source.environment:
        texture = nodes.new("ShaderNodeTexEnvironment")
        texture.image = bpy.data.images.load(str(source.environment))
        texture.image.colorspace_settings.name = "Linear Rec.709"
        links.new(texture.outputs["Color"], background.inputs["Color"])
    links.new(background.outputs[0], output.inputs["Surface"])


def configure(scene, threads):
    """Everything that would make Cycles' picture another one is off: clamps, filters, adaptive samples, denoising."""
    render, cycles = scene.render, scene.cycles
    render.engine = "CYCLES"
    render.resolution_percentage = 100
    render.use_persistent_data = True
    render.threads_mode, render.threads = "FIXED", threads
    render.image_settings.file_format = "OPEN_EXR"
    render.image_settings.color_depth = "32"
    render.image_settings.exr_codec = "NONE"
    render.dither_intensity = 0
    cycles.device = "CPU"
    cycles.pixel_filter_type = "BOX"
    cycles.use_adaptive_sampling = cycles.use_denoising = False
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0
    cycles.light_sampling_threshold = cycles.blur_glossy = 0
    cycles.caustics_reflective = cycles.caustics_refractive = True
    cycles.use_auto_tile = False
    cycles.sampling_pattern = "TABULATED_SOBOL"


if __name__ == "__main__":
    protocol.serve(Peer, sys.argv[1:])
