"""What each feature of the shader costs: compiled in but not used, and used."""

import json
import pathlib
import tempfile

from . import install, places, statistics, tables
from .peer_etendue import Etendue

BOX = places.REPOSITORY / "scenes" / "cornell_box.gltf"
# The block that gets each material in turn, and its plain dielectric.
BLOCK = "brushed metal"
PLAIN = {"baseColorFactor": [0.8, 0.7, 0.6, 1], "metallicFactor": 0, "roughnessFactor": 0.35}
GLASS = {"KHR_materials_transmission": {"transmissionFactor": 1}}
SOLID = GLASS | {"KHR_materials_volume": {"thicknessFactor": 1}}
ABSORBING = GLASS | {
    "KHR_materials_volume": {"thicknessFactor": 1, "attenuationDistance": 0.3, "attenuationColor": [0.9, 0.5, 0.3]}
}
# Feature: what uses it, as changes of the block's material, or as flags of a render; none where the box has
# nothing to use it with.
USES = {
    "clearcoat": {"KHR_materials_clearcoat": {"clearcoatFactor": 1, "clearcoatRoughnessFactor": 0.1}},
    "sheen": {"KHR_materials_sheen": {"sheenColorFactor": [0.8, 0.8, 0.8], "sheenRoughnessFactor": 0.4}},
    "iridescence": {"KHR_materials_iridescence": {"iridescenceFactor": 1}},
    "ior": {"KHR_materials_ior": {"ior": 1.8}},
    "diffuse_transmission": {"KHR_materials_diffuse_transmission": {"diffuseTransmissionFactor": 0.5}},
    "transmission": GLASS,
    "media": SOLID,
    "absorption": ABSORBING,
    "dispersion": SOLID | {"KHR_materials_dispersion": {"dispersion": 1}},
    "anisotropy": None,
    "normal_texture": None,
    "base_color_texture": None,
    "colors": None,
    "alpha_mask": None,
    "unlit": {"KHR_materials_unlit": {}},
    "point_light": None,
    "environment": {"flags": {"env": 1}},
    "lens": {"flags": {"aperture": 0.02, "focus_distance": 3}},
    "panorama": {"flags": {"projection": "panorama"}},
}
HEADERS = ("feature", "compiled in, not used: time", "used: time", "kernel, bytes of SPIR-V")


def write_box(folder, name, extensions):
    """The box with a plain dielectric block that has these extensions of its material."""
    scene = json.loads(BOX.read_text(encoding="utf-8"))
    material = next(m for m in scene["materials"] if m["name"] == BLOCK)
    material["pbrMetallicRoughness"] = PLAIN
    material["extensions"] = extensions
    scene["extensionsUsed"] = sorted({*scene.get("extensionsUsed", []), *extensions})
    path = pathlib.Path(folder) / f"{name}.gltf"
    path.write_text(json.dumps(scene), encoding="utf-8")
    return path


class Column:
    """Renders of one kind, timed in turns with others."""

    def __init__(self, command, threads, scene, size, spp, flags):
        self.etendue = Etendue(command, scene, threads)
        self.size, self.spp, self.flags, self.seconds = size, spp, flags, []

    def draw(self, seed):
        answer = self.etendue.render(self.spp, seed, self.size, **self.flags)
        self.seconds.append(answer["seconds"])
        return answer["report"]

    def kernel_bytes(self, folder):
        path = pathlib.Path(folder) / "kernel.spv"
        self.etendue.write_spirv(path, **self.flags)
        return path.stat().st_size


def measure(command, threads, names, rounds, spp, size):
    """A row a feature: ratios of times to those of the plain box, drawn in turns."""
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        plain = write_box(folder, "plain", {})
        for name in names:
            install.say(f"features: {name}")
            row = measure_one(command, threads, folder, plain, name, rounds, spp, size)
            rows.append(row)
        rows.append(measure_one(command, threads, folder, plain, "all", rounds, spp, size))
    return rows


def measure_one(command, threads, folder, plain, name, rounds, spp, size):
    column = lambda scene, flags: Column(command, threads, scene, size, spp, flags)  # noqa: E731
    base, unused = column(plain, {}), column(plain, {"require": name})
    use = USES.get(name)
    used = None
    if use is not None:
        scene = plain if "flags" in use else write_box(folder, name, use)
        used = column(scene, use.get("flags", {}))
    columns = [c for c in (base, unused, used) if c]
    for i in range(rounds):
        for each in columns[:: 1 if i % 2 == 0 else -1]:
            report = each.draw(i)
    ratio = lambda c: statistics.median([a / b for a, b in zip(c.seconds, base.seconds)])  # noqa: E731
    return {
        "feature": name,
        "unused": ratio(unused),
        "used": ratio(used) if used else None,
        "kernel_bytes": {"without": base.kernel_bytes(folder), "with": unused.kernel_bytes(folder)},
        "seconds": {"plain": base.seconds, "unused": unused.seconds, "used": used.seconds if used else None},
        "device": report["device"],
        "driver": report["driver"],
    }


def markdown(rows, rounds, spp, size):
    lines = [
        f"{size}×{size}, {spp} samples a pixel, medians of {rounds} ratios in turns, over the Cornell box with a plain "
        f"dielectric block. Driver: {rows[0]['driver']}.",
        "",
    ]
    return "\n".join([*lines, *tables.table(HEADERS, map(cells, rows))]) + "\n"


def cells(row):
    used = f"{row['used']:.2f}" if row["used"] else ""
    bytes_of = row["kernel_bytes"]
    return [row["feature"], f"{row['unused']:.2f}", used, f"{bytes_of['without']} to {bytes_of['with']}"]
