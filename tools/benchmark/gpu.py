"""Rays per second, after the protocol of DGriffin91/tray_racing: 1080p, primary rays, and one ambient ray for each hit.

Rays are counted by `--stats` in a render of their own, since counting costs time, and timed without it.
"""

from . import install, scene_writer, statistics, tables
from .peer_etendue import Etendue

SIZE = (1920, 1080)
# integrator, flags, what is traced.
PASSES = {
    "primary": ("normals", {}, "one closest-hit ray a sample"),
    "ambient, closest hit": (
        "path_bsdf",
        {"max_depth": 2, "env": "1"},
        "the same, and a closest-hit ray in a cosine-weighted direction",
    ),
    "ambient, any hit": ("ao", {}, "the same, but any hit ends the second ray"),
    "path": ("path", {"max_depth": 8}, "whole paths"),
}


def measure(command, threads, scenes, rounds, spp):
    """Rows: scene, pass, rays a sample, median and spread of rays per second, paths per second."""
    rows = []
    for scene in scenes:
        etendue = Etendue(command, scene_writer.path_of(scene), threads)
        counts, times = {}, {name: [] for name in PASSES}
        for name, (integrator, flags, _) in PASSES.items():
            install.say(f"gpu: {scene}, counting {name} rays")
            report = etendue.render(1, 0, SIZE, integrator=integrator, stats=True, **flags)["report"]
            counts[name] = report["rays"]
        for i in range(rounds):
            install.say(f"gpu: {scene}, round {i + 1} of {rounds}")
            for name, (integrator, flags, _) in PASSES.items():
                times[name].append(etendue.render(spp, i, SIZE, integrator=integrator, **flags)["seconds"])
        rows += [row(scene, name, counts[name], times[name], spp, etendue.about) for name in PASSES]
    return rows


def row(scene, name, counts, seconds, spp, about):
    """counts: the report's rays of one sample a pixel."""
    pixels = SIZE[0] * SIZE[1]
    rays, samples = (counts["closest"] + counts["any"]) / pixels, pixels * spp
    middle = statistics.median(seconds)
    return {
        "scene": scene,
        "pass": name,
        "rays": counts,
        "rays_per_sample": rays,
        "seconds": list(seconds),
        "rays_per_second": rays * samples / middle,
        "paths_per_second": samples / middle,
        "slowest": rays * samples / max(seconds),
        "fastest": rays * samples / min(seconds),
        "device": about["device"],
        "driver": about["driver"],
    }


def markdown(rows, rounds, spp):
    where = f"{rows[0]['device']}, {rows[0]['driver']}"
    lines = [f"1920×1080, {spp} samples a pixel, medians (slowest to fastest) of {rounds} rounds, on {where}.", ""]
    lines += tables.table(("scene", "pass", "rays a sample", "Mrays/s", "Mpaths/s"), map(cells, rows))
    lines += [
        "",
        *(f"- {name}: `--integrator {integrator}`, {what}." for name, (integrator, _, what) in PASSES.items()),
    ]
    return "\n".join(lines) + "\n"


def cells(row):
    spread = f"({tables.rate(row['slowest'])} to {tables.rate(row['fastest'])})"
    rays = f"{tables.rate(row['rays_per_second'])} {spread}"
    return [row["scene"], row["pass"], f"{row['rays_per_sample']:.2f}", rays, tables.rate(row["paths_per_second"])]
