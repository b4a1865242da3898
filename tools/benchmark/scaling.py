"""Time against triangles, pixels, samples, cores, lights and depth: étendue alone, each axis with its expected law."""

import math
from dataclasses import dataclass, field

from . import install, plot, scene_writer, statistics
from .peer_etendue import Etendue

# Roulette would hide what an edge costs.
NO_ROULETTE = {"set": "ROULETTE_DEPTH=1000000"}


@dataclass
class Point:
    """One render of an axis. x is what varies."""

    x: float
    scene: str = "cornell"
    size: int = 256
    spp: int = 4
    threads: int = 0
    more: dict = field(default_factory=dict)


@dataclass
class Axis:
    """law: (words, the function of x that time should follow up to a factor)."""

    name: str
    unit: str
    points: list
    words: str
    law: object


def axes(threads, most_triangles, scale):
    """All axes. scale multiplies the samples."""
    spheres = [n for n in (10**3, 10**4, 10**5, 10**6, 10**7) if n <= most_triangles]
    cores = sorted({1 << i for i in range(threads.bit_length()) if 1 << i <= threads} | {threads})
    logarithm = lambda x: math.log2(x)  # noqa: E731
    return [
        Axis(
            "triangles",
            "triangles",
            [Point(n, f"spheres:{n}", 256, 4 * scale) for n in spheres],
            "log n: the depth of a tree; more where it leaves the caches",
            logarithm,
        ),
        Axis("pixels", "pixels", [Point(s * s, size=s, spp=4 * scale) for s in (64, 128, 256, 512, 1024)], "n", float),
        Axis("samples", "samples a pixel", [Point(n, spp=n) for n in (1, 4, 16, 64)], "n", float),
        Axis("cores", "threads", [Point(n, spp=8 * scale, threads=n) for n in cores], "1 / n", lambda x: 1 / x),
        Axis(
            "lights",
            "emissive triangles",
            [Point(2 * k * k, f"lamps:{k}", 256, 4 * scale) for k in (1, 4, 16, 64, 256)],
            "log n for choosing one (a tree), and for the rays that meet them",
            logarithm,
        ),
        Axis(
            "depth",
            "edges",
            [Point(n, spp=4 * scale, more={"max_depth": n} | NO_ROULETTE) for n in (1, 2, 4, 8, 16, 32)],
            "at most n: paths end where they leave the room",
            float,
        ),
    ]


def measure(command, threads, rounds, most_triangles, scale):
    """A report: for each axis its points with median seconds, build seconds and the exponent of a power law."""
    report = []
    for axis in axes(threads, most_triangles, scale):
        install.say(f"scaling: {axis.name} ...")
        runs = [[] for _ in axis.points]
        for _ in range(rounds):
            for point, times in zip(axis.points, runs):
                times.append(render(command, point, threads))
        report.append(summary(axis, runs))
    return report


def render(command, point, threads):
    etendue = Etendue(command, scene_of(point.scene), point.threads or threads)
    return etendue.render(**{"spp": point.spp, "seed": 0, "size": point.size} | point.more)["report"]["seconds"]


def scene_of(name):
    kind, _, number = name.partition(":")
    if kind == "spheres":
        return scene_writer.write_once(f"spheres-{number}", scene_writer.write_spheres(int(number)))
    if kind == "lamps":
        return scene_writer.write_once(f"lamps-{number}", scene_writer.write_lamps(int(number)))
    return scene_writer.path_of(name)


def summary(axis, runs):
    x = [point.x for point in axis.points]
    seconds = [statistics.median([run["render"] for run in times]) for times in runs]
    build = [statistics.median([run["accel"] for run in times]) for times in runs]
    law = [axis.law(a) for a in x]
    # The law's factor fits all points best on logarithmic axes.
    factor = math.exp(sum(math.log(a / b) for a, b in zip(seconds, law)) / len(law))
    return {
        "axis": axis.name,
        "unit": axis.unit,
        "law": axis.words,
        "x": x,
        "seconds": seconds,
        "build_seconds": build,
        "expected": [factor * value for value in law],
        "exponent": statistics.power_law(x, seconds) if len(x) > 1 else None,
        "last_exponent": statistics.power_law(x[-2:], seconds[-2:]) if len(x) > 1 else None,
    }


def markdown(report, about):
    lines = [about, ""]
    for axis in report:
        lines += [
            f"**{axis['axis']}**: expected {axis['law']}; a power law fits with exponent {axis['exponent']:.2f}, "
            f"over the last two points {axis['last_exponent']:.2f}.",
            "",
        ]
        lines += [
            f"| {axis['unit']} | " + " | ".join(f"{x:,}" for x in axis["x"]) + " |",
            "|---" * (len(axis["x"]) + 1) + "|",
        ]
        lines.append("| seconds | " + " | ".join(f"{s:.3g}" for s in axis["seconds"]) + " |")
        lines.append("| the law | " + " | ".join(f"{s:.3g}" for s in axis["expected"]) + " |")
        if axis["axis"] == "triangles":
            lines.append("| build, s | " + " | ".join(f"{s:.3g}" for s in axis["build_seconds"]) + " |")
        lines.append("")
    return "\n".join(lines)


def svg(report):
    panels = []
    for axis in report:
        measured = ("measured", "#0060a0", False, list(zip(axis["x"], axis["seconds"])))
        law = (axis["law"], "#c04000", True, list(zip(axis["x"], axis["expected"])))
        panels.append((axis["axis"], axis["unit"], "render seconds (dashed: the expected law)", [measured, law]))
    return plot.page(panels)
