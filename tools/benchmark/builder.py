"""What the builder's presets cost and bring."""

import subprocess

from . import install, scene_writer, statistics, tables
from .peer_etendue import Etendue
from .places import BenchError

PRESETS = ["fast", "balanced", "best"]
NOT_REPORTED = "not reported"
HEADERS = (
    "scene",
    "triangles",
    "preset",
    "build, s",
    "structure, bytes a triangle",
    "device, bytes a triangle",
    "steps a ray",
    "Mrays/s",
)


def require_presets(command):
    """An étendue without --bvh has nothing to compare."""
    help_text = subprocess.run([*command, "render", "--help"], capture_output=True, text=True, check=False).stdout
    if "--bvh" not in help_text:
        raise BenchError("this étendue has no --bvh; build a version that has the builder's presets")


def measure(command, threads, scenes, rounds, spp, size):
    """Rows: scene, preset, build seconds, device bytes, rays a sample, steps a ray, rays per second."""
    require_presets(command)
    rows = []
    for scene in scenes:
        etendue = Etendue(command, scene_writer.path_of(scene), threads)
        runs = {preset: [] for preset in PRESETS}
        counted = {preset: etendue.render(1, 0, size, bvh=preset, stats=True)["report"] for preset in PRESETS}
        for i in range(rounds):
            install.say(f"bvh: {scene}, round {i + 1} of {rounds}")
            for preset in PRESETS:
                runs[preset].append(etendue.render(spp, i, size, bvh=preset)["report"])
        rows += [row(scene, preset, counted[preset], runs[preset], spp * size * size) for preset in PRESETS]
    return rows


def row(scene, preset, counted, runs, samples):
    rays = counted["rays"]["closest"] + counted["rays"]["any"]
    per_sample = rays / (counted["width"] * counted["height"])
    seconds = statistics.median([run["seconds"]["render"] for run in runs])
    return {
        "scene": scene,
        "preset": preset,
        "triangles": counted["triangles"],
        "device_bytes": counted["device_bytes"],
        "build_seconds": statistics.median([run["seconds"]["accel"] for run in runs]),
        "rays_per_sample": per_sample,
        "steps_per_ray": counted["rays"].get("steps_per_ray"),
        "structure_bytes": counted.get("accel_bytes"),
        "rays_per_second": per_sample * samples / seconds,
    }


def markdown(rows, rounds, spp, size):
    lines = [f"{size}×{size}, {spp} samples a pixel, medians of {rounds} interleaved rounds.", ""]
    return "\n".join([*lines, *tables.table(HEADERS, map(cells, rows))]) + "\n"


def cells(row):
    each = lambda value: NOT_REPORTED if value is None else f"{value / row['triangles']:.1f}"  # noqa: E731
    steps = NOT_REPORTED if row["steps_per_ray"] is None else f"{row['steps_per_ray']:.1f}"
    return [
        row["scene"],
        row["triangles"],
        row["preset"],
        f"{row['build_seconds']:.3g}",
        each(row["structure_bytes"]),
        each(row["device_bytes"]),
        steps,
        tables.rate(row["rays_per_second"]),
    ]
