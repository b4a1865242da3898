"""Stretched highlights over strength and direction."""

import math

from .gltf import Gltf
from .stage import Grid, build_stage, globe

STRENGTH = [0, 0.4, 0.7, 1]
DEGREES = [0, 30, 60, 90]


def build():
    gltf = Gltf(
        "anisotropy",
        "KHR_materials_anisotropy on metal globes whose tangents run eastwards, along the circles of latitude. Top: "
        "anisotropyStrength 0, 0.4, 0.7, 1 from left to right: the highlights stretch along the tangents. Middle: a "
        "strength of 0.9, anisotropyRotation 0, 30, 60 and 90 degrees from left to right, counter-clockwise: at 90 "
        "they stretch along the meridians. Bottom: the same on a rougher metal.",
    )
    build_stage(gltf, 4, 3)
    grid = Grid(gltf, 4, 3, globe(40, 20))
    for column, (strength, degrees) in enumerate(zip(STRENGTH, DEGREES)):
        rows = [(strength, 0, 0.3), (0.9, degrees, 0.3), (0.9, degrees, 0.5)]
        for row, (stretch, turn, roughness) in enumerate(rows):
            name = f"strength {stretch}, {turn} degrees, roughness {roughness}"
            settings = {"anisotropyStrength": stretch, "anisotropyRotation": math.radians(turn)}
            extensions = gltf.use("KHR_materials_anisotropy", settings)
            metal = gltf.material(name, [0.9, 0.75, 0.55], metallic=1, roughness=roughness, extensions=extensions)
            grid.add(name, column, row, metal)
    return gltf
