"""Clear coats over their coverage and roughness."""

from .gltf import Gltf
from .stage import Grid, build_stage

FACTOR = [0, 0.33, 0.67, 1]
ROUGHNESS = [0, 0.2, 0.4, 0.7]


def build():
    gltf = Gltf(
        "clear coats",
        "KHR_materials_clearcoat over a rough red base. Top: clearcoatFactor 0, 0.33, 0.67, 1 from left to right, a "
        "smooth coat: the panels' mirror images get stronger. Middle: clearcoatRoughnessFactor 0, 0.2, 0.4, 0.7 of a "
        "whole coat: the images blur. Bottom: the same over a rough metal. A coat darkens its base a little, most "
        "towards the rim.",
    )
    build_stage(gltf, 4, 3)
    grid = Grid(gltf, 4, 3)
    for column, (factor, roughness) in enumerate(zip(FACTOR, ROUGHNESS)):
        for row, (metallic, strength, blur) in enumerate([(0, factor, 0), (0, 1, roughness), (1, 1, roughness)]):
            coat = {"clearcoatFactor": strength, "clearcoatRoughnessFactor": blur}
            extensions = gltf.use("KHR_materials_clearcoat", coat)
            name = f"metallic {metallic}, coat {strength}, roughness {blur}"
            base = gltf.material(name, [0.7, 0.04, 0.03], metallic=metallic, roughness=0.7, extensions=extensions)
            grid.add(name, column, row, base)
    return gltf
