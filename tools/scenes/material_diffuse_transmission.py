"""Lampshades over the fraction of light that they let through."""

from .gltf import Gltf
from .shapes import sphere
from .stage import STEP, Grid, build_stage, place

FACTOR = [0, 0.25, 0.5, 1]
ROWS = [("white", [1, 1, 1]), ("orange", [1, 0.35, 0.08]), ("unlit", [1, 1, 1])]


def build():
    gltf = Gltf(
        "diffuse transmission",
        "KHR_materials_diffuse_transmission: paper balls, diffuseTransmissionFactor 0, 0.25, 0.5 and 1 from left to "
        "right. Those of the two upper rows have a small lamp inside, white paper and paper with an orange "
        "diffuseTransmissionColorFactor: they glow the brighter the more passes. The bottom row has none inside: "
        "what passes is lost to its lit side, and shows on its other side.",
    )
    build_stage(gltf, 4, 3, key=6, fill=0.5)
    grid = Grid(gltf, 4, 3)
    lamp = gltf.mesh("lamp", (sphere(0, smooth=False), gltf.emitter("lamp", [1, 1, 1], 14)))
    for row, (label, color) in enumerate(ROWS):
        for column, factor in enumerate(FACTOR):
            settings = {"diffuseTransmissionFactor": factor, "diffuseTransmissionColorFactor": color}
            extensions = {
                **gltf.use("KHR_materials_diffuse_transmission", settings),
                **gltf.use("KHR_materials_specular", {"specularFactor": 0}),
            }
            name = f"{label}, {factor}"
            grid.add(name, column, row, gltf.material(name, [0.4, 0.4, 0.4], extensions=extensions, doubleSided=True))
            if label != "unlit":
                gltf.node("lamp", mesh=lamp, translation=place(4, 3, column, row), scale=[0.07 * STEP] * 3)
    return gltf
