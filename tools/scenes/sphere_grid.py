"""Spheres over metalness and roughness."""

from .gltf import Gltf, about_y
from .shapes import join, plain_quad, sphere

ROUGHNESS = [0.1, 0.28, 0.46, 0.64, 0.82, 1]
METALLIC = [0, 0.5, 1]
RADIUS, STEP = 0.46, 1.1


def build():
    gltf = Gltf(
        "sphere grid",
        "The metallic-roughness model: roughness 0.1 to 1 from left to right, metallic 0, 0.5 and 1 from top to "
        "bottom, smooth normals on one shared tessellation. Two panels light it; no environment is needed.",
    )
    grey = gltf.diffuse("backdrop", [0.3, 0.3, 0.3], doubleSided=True)
    backdrop = join(
        [plain_quad([-9, -2.2, 6], [18, 0, 0], [0, 0, -8]), plain_quad([-9, -2.2, -2], [18, 0, 0], [0, 10, 0])]
    )
    gltf.node("backdrop", mesh=gltf.mesh("backdrop", (backdrop, grey)))
    add_spheres(gltf)
    panel = plain_quad([-0.5, -0.5, 0], [1, 0, 0], [0, 1, 0])
    key = gltf.mesh("key panel", (panel, gltf.emitter("key light", [1, 0.95, 0.88], 26)))
    fill = gltf.mesh("fill panel", (panel, gltf.emitter("fill light", [0.6, 0.75, 1], 11)))
    # A turn of +90° makes the panel's front, +Z, look along +X; the parent of the key light then tips it down.
    left = gltf.node("key stand", translation=[-5, 3.2, 4.2], rotation=about_y(128))
    gltf.node("key panel", left, mesh=key, rotation=[0.258819045, 0, 0, 0.965925826], scale=[3, 2.4, 1])
    gltf.node("fill panel", mesh=fill, translation=[6, 0.8, 4], rotation=about_y(-124), scale=[1.2, 4, 1])
    gltf.camera("camera", eye=[0, 0.35, 11.5], target=[0, -0.05, 0], yfov=20.5, aspect=1.8)
    return gltf


def add_spheres(gltf):
    """18 meshes that differ in their material alone and share their accessors."""
    shared = None
    for row, metallic in enumerate(METALLIC):
        for column, roughness in enumerate(ROUGHNESS):
            name = f"metallic {metallic}, roughness {roughness}"
            material = gltf.material(name, [0.94, 0.6, 0.24], metallic=metallic, roughness=roughness)
            shared = shared or gltf.primitive(sphere(4), material)
            mesh = gltf.mesh(name, {**shared, "material": material})
            place = [(column - 2.5) * STEP, (1 - row) * STEP, 0]
            gltf.node(name, mesh=mesh, translation=place, scale=[RADIUS] * 3)
