"""Noise at equal time against the number of emissive triangles, for each way to choose a light."""

import pathlib
import tempfile

import numpy

from . import agreement, install, light_scenes, pictures, statistics, tables
from .peer_etendue import Etendue
from .places import BenchError

SELECTIONS = ("uniform", "power", "tree")
COUNTS = (1, 10, 100, 1_000, 10_000, 100_000)
# Pictures whose mean is the reference, and how many times the samples of a timed one each has.
BATCHES, BATCH_FACTOR = 8, 8
HEADERS = (
    "scene",
    "triangles",
    *(f"relMSE, {name}" for name in SELECTIONS),
    *(f"seconds, {name}" for name in SELECTIONS),
    *(f"1/(relMSE·s), {name}" for name in SELECTIONS),
    "tree over power",
    "tree over uniform",
    "build of the tree, s",
)


class Scene:
    """Renders of a scene."""

    def __init__(self, command, threads, name, count, size, spp, depth):
        self.etendue = Etendue(command, light_scenes.path_of(name, count), threads)
        self.name, self.count, self.size, self.spp, self.depth = name, count, size, spp, depth

    def draw(self, selection, spp, seed):
        """(report, picture)"""
        with tempfile.TemporaryDirectory() as folder:
            output = pathlib.Path(folder) / "picture.exr"
            request = {"max_depth": self.depth, "lights": selection, "output": output}
            answer = self.etendue.render(spp, seed, self.size, **request)
            return answer["report"], pictures.read(output)

    def reference(self):
        """(mean, its variance) of pictures by the tree with seeds of their own."""
        drawn = [self.draw("tree", BATCH_FACTOR * self.spp, 1000 + i)[1] for i in range(BATCHES)]
        batches = numpy.stack(drawn).astype(numpy.float64)
        return batches.mean(axis=0), batches.var(axis=0, ddof=1) / BATCHES

    def measure(self, rounds):
        """A row: for each selection relMSE (its mean over the rounds) and seconds (their median)."""
        mean, variance = self.reference()
        errors, seconds, builds = ({name: [] for name in SELECTIONS} for _ in range(3))
        for i in range(rounds):
            for selection in SELECTIONS[:: 1 if i % 2 == 0 else -1]:
                report, picture = self.draw(selection, self.spp, i)
                errors[selection].append(agreement.relative_mse(picture, mean, variance))
                seconds[selection].append(report["seconds"]["render"])
                builds[selection].append(report["lights"]["seconds"])
        return {
            "scene": self.name,
            "triangles": self.count,
            "relative_mse": {name: sum(values) / rounds for name, values in errors.items()},
            "seconds": {name: statistics.median(values) for name, values in seconds.items()},
            "tree_seconds": statistics.median(builds["tree"]),
            "mean_of_reference": float(mean.mean()),
            "device": report["device"],
            "driver": report["driver"],
        }


def measure(command, threads, scenes, counts, rounds, spp, size, depth):
    """Rows by scene and number of triangles."""
    rows = []
    for name in scenes:
        for count in counts:
            install.say(f"lights: {name}, {count} triangles")
            row = Scene(command, threads, name, count, size, spp, depth).measure(rounds)
            if min(row["relative_mse"].values()) <= 0:
                raise BenchError(f"{name}, {count}: the reference is too noisy to measure the error", 1)
            row["efficiency"] = {k: 1 / (row["relative_mse"][k] * row["seconds"][k]) for k in SELECTIONS}
            rows.append(row)
    return rows


def markdown(rows, rounds, spp, size, depth):
    lines = [
        f"{size}×{size}, {spp} samples a pixel, at most {depth} edges a path, {rounds} rounds in turns: relMSE is their "
        f"mean, seconds their median. Driver: {rows[0]['driver']}.",
        "",
    ]
    return "\n".join([*lines, *tables.table(HEADERS, map(cells, rows))]) + "\n"


def cells(row):
    three = [[f"{row[key][name]:.3g}" for name in SELECTIONS] for key in ("relative_mse", "seconds", "efficiency")]
    tree = row["efficiency"]["tree"]
    gains = [f"{tree / row['efficiency'][name]:.3g}" for name in ("power", "uniform")]
    return [row["scene"], row["triangles"], *sum(three, []), *gains, f"{row['tree_seconds']:.3g}"]
