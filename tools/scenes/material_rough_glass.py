"""Solid glass over its roughness and its absorption."""

from . import png
from .gltf import NEAREST, REPEAT, Gltf
from .shapes import quad
from .stage import RADIUS, Grid, build_stage, globe

ROUGHNESS = [0, 0.15, 0.3, 0.6]
DISTANCES = [None, 2, 0.5]  # in radii of the balls


def build():
    gltf = Gltf(
        "rough glass",
        "KHR_materials_transmission and KHR_materials_volume: balls of glass (index 1.5) before stripes, roughness 0, "
        "0.15, 0.3 and 0.6 from left to right; clear, then an attenuationDistance of 2 and of 0.5 radii to an amber "
        "colour. A smooth ball shows what is behind it upside down; the longest way inside, through the middle, is "
        "the darkest.",
    )
    build_stage(gltf, 4, 3)
    light, dark = (205, 205, 205), (60, 60, 60)
    rows = [[light, dark]]
    texture = gltf.texture("stripes", png.encode(2, 1, rows, alpha=False), gltf.sampler(NEAREST, REPEAT))
    stripes = gltf.diffuse("stripes", [1, 1, 1], texture=texture)
    wall = quad([-4, -2, -1.4], [8, 0, 0], [0, 5, 0], uv_scale=(14, 1))
    gltf.node("stripes", mesh=gltf.mesh("stripes", (wall, stripes)))
    grid = Grid(gltf, 4, 3, globe(40, 20))
    for row, distance in enumerate(DISTANCES):
        for column, roughness in enumerate(ROUGHNESS):
            volume = {"thicknessFactor": 2 * RADIUS}
            if distance is not None:
                volume |= {"attenuationDistance": distance * RADIUS, "attenuationColor": [0.9, 0.45, 0.08]}
            extensions = {
                **gltf.use("KHR_materials_transmission", {"transmissionFactor": 1}),
                **gltf.use("KHR_materials_volume", volume),
            }
            name = f"roughness {roughness}, attenuation over {distance} radii"
            glass = gltf.material(name, [1, 1, 1], roughness=roughness, extensions=extensions)
            grid.add(name, column, row, glass)
    return gltf
