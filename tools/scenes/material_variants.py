"""Balls that change their materials together."""

from .gltf import Gltf
from .stage import Grid, build_stage

VARIANTS = ["metal", "glass", "cloth"]
COLORS = {"red": [0.75, 0.08, 0.06], "yellow": [0.8, 0.55, 0.07], "green": [0.08, 0.5, 0.12], "blue": [0.06, 0.15, 0.7]}


def build():
    gltf = Gltf(
        "variants",
        "KHR_materials_variants: above, four balls that are red, yellow, green and blue metal, glass or cloth in the "
        "variants of these names and grey without --variant; below, four that are always grey. No mapping names the "
        "last ball in the variant cloth: it stays grey.",
    )
    build_stage(gltf, 4, 2)
    grid = Grid(gltf, 4, 2)
    gltf.json["extensions"] = gltf.use("KHR_materials_variants", {"variants": [{"name": name} for name in VARIANTS]})
    grey = gltf.diffuse("grey", [0.5, 0.5, 0.5])
    for column, (label, color) in enumerate(COLORS.items()):
        looks = [metal(gltf, label, color), glass(gltf, label, color), cloth(gltf, label, color)]
        mappings = [{"material": material, "variants": [variant]} for variant, material in enumerate(looks)]
        if label == "blue":
            mappings.pop()
        grid.add(label, column, 0, grey, extensions=gltf.use("KHR_materials_variants", {"mappings": mappings}))
        grid.add("grey", column, 1, grey)
    return gltf


def metal(gltf, label, color):
    return gltf.material(f"{label} metal", color, metallic=1, roughness=0.3)


def glass(gltf, label, color):
    extensions = {
        **gltf.use("KHR_materials_transmission", {"transmissionFactor": 1}),
        **gltf.use("KHR_materials_volume", {"thicknessFactor": 1, "attenuationDistance": 1, "attenuationColor": color}),
    }
    return gltf.material(f"{label} glass", [1, 1, 1], roughness=0, extensions=extensions)


def cloth(gltf, label, color):
    extensions = gltf.use("KHR_materials_sheen", {"sheenColorFactor": [1, 1, 1], "sheenRoughnessFactor": 0.5})
    return gltf.material(f"{label} cloth", color, roughness=0.9, extensions=extensions)
