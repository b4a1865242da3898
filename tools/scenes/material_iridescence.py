"""Thin films over their thickness."""

from .gltf import Gltf
from .stage import Grid, build_stage

THICKNESS = [0, 120, 240, 360, 480]
ROWS = [  # name, metallic, base colour, index of the film
    ("thin film of 1.33 on black glass", 0, [0, 0, 0], 1.33),
    ("thin film of 2 on black glass", 0, [0, 0, 0], 2),
    ("thin film of 1.33 on steel", 1, [0.56, 0.55, 0.53], 1.33),
    ("thin film of 2 on steel", 1, [0.56, 0.55, 0.53], 2),
]


def build():
    gltf = Gltf(
        "iridescence",
        "KHR_materials_iridescence: iridescenceThicknessMaximum 0, 120, 240, 360, 480 nm from left to right; a film "
        "of index 1.33 and one of 2 on black glass of index 1.5, then both on rough steel. A film of no thickness "
        "leaves its base as it is. On glass a film of smaller index than the glass is bright where its path is a "
        "whole number of wavelengths, one of larger index where half a one is left: 120 nm of index 1.33 dim red and "
        "look blue, 120 nm of index 2 dim blue and look orange. Colours change towards the rim as the path shortens.",
    )
    build_stage(gltf, 5, 4)
    grid = Grid(gltf, 5, 4)
    for row, (label, metallic, color, ior) in enumerate(ROWS):
        for column, thickness in enumerate(THICKNESS):
            film = {
                "iridescenceFactor": 1,
                "iridescenceIor": ior,
                "iridescenceThicknessMinimum": 0,
                "iridescenceThicknessMaximum": thickness,
            }
            extensions = gltf.use("KHR_materials_iridescence", film)
            name = f"{label}, {thickness} nm"
            grid.add(
                name,
                column,
                row,
                gltf.material(name, color, metallic=metallic, roughness=0.35, extensions=extensions),
            )
    return gltf
