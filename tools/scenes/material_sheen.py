"""Sheen over its roughness and colour."""

from .gltf import Gltf
from .stage import Grid, build_stage

ROUGHNESS = [0.15, 0.35, 0.6, 1]
ROWS = [("none", [0, 0, 0]), ("grey", [0.5, 0.5, 0.5]), ("white", [1, 1, 1]), ("orange", [1, 0.35, 0.05])]


def build():
    gltf = Gltf(
        "sheen",
        "KHR_materials_sheen over a dark blue base: sheenRoughnessFactor 0.15, 0.35, 0.6, 1 from left to right, "
        "sheenColorFactor 0, grey, white and orange from top to bottom. A sheen of small roughness is a thin bright "
        "rim, one of large roughness a haze over all. Without sheen its roughness changes nothing.",
    )
    build_stage(gltf, 4, 4)
    grid = Grid(gltf, 4, 4)
    for row, (label, color) in enumerate(ROWS):
        for column, roughness in enumerate(ROUGHNESS):
            sheen = {"sheenColorFactor": color, "sheenRoughnessFactor": roughness}
            extensions = {
                **gltf.use("KHR_materials_sheen", sheen),
                **gltf.use("KHR_materials_specular", {"specularFactor": 0}),
            }
            name = f"{label} sheen, roughness {roughness}"
            cloth = gltf.material(name, [0.02, 0.03, 0.12], roughness=0.9, extensions=extensions)
            grid.add(name, column, row, cloth)
    return gltf
