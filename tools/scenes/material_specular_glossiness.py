"""Specular-glossiness materials over glossiness and specular colour."""

from .gltf import Gltf
from .stage import Grid, build_stage

GLOSSINESS = [0, 0.4, 0.7, 0.9]
ROWS = [  # name, diffuse, specular
    ("plastic", [0.1, 0.3, 0.6, 1], [0.04, 0.04, 0.04]),
    ("coloured specular", [0.1, 0.3, 0.6, 1], [0.5, 0.1, 0.1]),
    ("gold", [0, 0, 0, 1], [1, 0.77, 0.34]),
]


def build():
    gltf = Gltf(
        "specular-glossiness",
        "KHR_materials_pbrSpecularGlossiness: glossinessFactor 0, 0.4, 0.7, 0.9 from left to right; a blue plastic, "
        "the same with a red specularFactor (the red highlight takes its light from the blue base), and gold with a "
        "black diffuseFactor. The metallic-roughness factors say magenta, which must not be seen.",
    )
    build_stage(gltf, 4, 3)
    grid = Grid(gltf, 4, 3)
    for row, (label, diffuse, specular) in enumerate(ROWS):
        for column, glossiness in enumerate(GLOSSINESS):
            settings = {"diffuseFactor": diffuse, "specularFactor": specular, "glossinessFactor": glossiness}
            extensions = gltf.use("KHR_materials_pbrSpecularGlossiness", settings)
            name = f"{label}, glossiness {glossiness}"
            grid.add(name, column, row, gltf.material(name, [1, 0, 1], roughness=0.5, extensions=extensions))
    return gltf
