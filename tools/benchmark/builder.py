"""What the builder's presets cost and bring, and what Embree (PyPI embreex) does with the same triangles."""

import json
import os
import subprocess

from . import install, scene_writer, statistics, tables
from .peer_etendue import Etendue
from .places import TOOLS, BenchError

PRESETS = ["fast", "balanced", "best"]
# Kinds of rays, each as étendue's integrator and flags: one primary ray a sample; the same and a cosine-weighted
# closest-hit ray from each hit.
KINDS = {
    "primary": {"integrator": "normals"},
    "bounce": {"integrator": "path_bsdf", "max_depth": 2, "env": "1"},
}
HEADERS = (
    "scene",
    "triangles",
    "builder",
    "build, s",
    "bytes a triangle",
    "nodes a ray",
    "pairs a ray",
    "paths, Mrays/s",
    "primary, Mrays/s",
    "primary and bounce, Mrays/s",
)


def require_presets(command):
    """An étendue without --bvh has nothing to compare."""
    help_text = subprocess.run([*command, "render", "--help"], capture_output=True, text=True, check=False).stdout
    if "--bvh" not in help_text:
        raise BenchError("this étendue has no --bvh; build a version that has the builder's presets")


def measure(command, threads, scenes, rounds, spp, size, embree):
    """Rows: a scene with a preset, or with Embree."""
    require_presets(command)
    rows = []
    for scene in scenes:
        etendue = Etendue(command, scene_writer.path_of(scene), threads)
        columns = {preset: Preset(etendue, preset, spp, size) for preset in PRESETS}
        for i in range(rounds):
            install.say(f"bvh: {scene}, round {i + 1} of {rounds}")
            for column in columns.values():
                column.draw(i)
        rows += [column.row(scene) for column in columns.values()]
        rows += [embree_row(scene, size, rounds)] if embree else []
    return rows


class Preset:
    """Renders of a scene with one preset."""

    def __init__(self, etendue, preset, spp, size):
        self.etendue, self.preset, self.spp, self.size = etendue, preset, spp, size
        self.kinds = {"path": {}, **KINDS}
        # Counting costs time, so that rays are counted in renders of their own.
        self.counted = {kind: self.render(kind, 1, 0, stats=True) for kind in self.kinds}
        self.runs = {kind: [] for kind in self.kinds}

    def render(self, kind, spp, seed, **more):
        return self.etendue.render(spp, seed, self.size, bvh=self.preset, **self.kinds[kind], **more)["report"]

    def draw(self, seed):
        """A round."""
        for kind, runs in self.runs.items():
            runs.append(self.render(kind, self.spp, seed))

    def rays_per_second(self, kind):
        """Rays of a sample, by the samples of a second."""
        rays = self.counted[kind]["rays"]["closest"] + self.counted[kind]["rays"]["any"]
        seconds = statistics.median([run["seconds"]["render"] for run in self.runs[kind]])
        return rays * self.spp / seconds

    def row(self, scene):
        counted = self.counted["path"]
        builds = [run["bvh"]["seconds"] for runs in self.runs.values() for run in runs]
        return {
            "scene": scene,
            "builder": self.preset,
            "triangles": counted["triangles"],
            "build_seconds": statistics.median(builds),
            "bytes_per_triangle": counted["bvh"]["bytes_per_triangle"],
            "device_bytes": counted["device_bytes"],
            "nodes_per_ray": counted["rays"]["nodes_per_ray"],
            "pairs_per_ray": counted["rays"]["pairs_per_ray"],
            "rays_per_second": {kind: self.rays_per_second(kind) for kind in self.kinds},
        }


def embree_row(scene, size, rounds):
    """Embree's part: it runs by itself, after étendue's rounds."""
    install.say(f"bvh: {scene}, Embree")
    python = install.embree()
    command = [python, "-m", "benchmark.peer_embree", scene_writer.path_of(scene), size, size, rounds]
    environment = os.environ | {"PYTHONPATH": str(TOOLS), "PYTHONDONTWRITEBYTECODE": "1"}
    return {"scene": scene, "builder": "embree", **json.loads(install.run(command, "embreex failed", environment))}


def markdown(rows, rounds, spp, size):
    lines = [
        f"{size}×{size}, {spp} samples a pixel, medians of {rounds} interleaved rounds. Embree: one ray a pixel, from "
        "one thread / from two; its second figure is of bounce rays alone.",
        "",
    ]
    return "\n".join([*lines, *tables.table(HEADERS, map(cells, rows))]) + "\n"


def cells(row):
    head = [row["scene"], row["triangles"], row["builder"], f"{row['build_seconds']:.3g}"]
    rates = row["rays_per_second"]
    if row["builder"] == "embree":
        both = [" / ".join(tables.rate(rates[f"{kind}_{n}"]) for n in (1, 2)) for kind in KINDS]
        return [*head, "", "", "", "", *both]
    counts = [f"{row[key]:.2f}" for key in ("bytes_per_triangle", "nodes_per_ray", "pairs_per_ray")]
    return [*head, *counts, *(tables.rate(rates[kind]) for kind in ("path", *KINDS))]
