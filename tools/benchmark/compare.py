"""One row of the table: a scene, étendue and a peer, interleaved."""

import hashlib
import json
import pathlib
import shutil
import tempfile
from dataclasses import dataclass

import numpy

from . import agreement, install, pictures, scene_writer, statistics
from .peer_etendue import Etendue
from .places import TOOLS, BenchError, NotComparable, cache
from .protocol import Remote

MITSUBA_SAMPLERS = ["independent", "multijitter", "ldsampler"]
PEERS = ["mitsuba", "cycles"]


@dataclass
class Settings:
    """Of a whole run."""

    etendue: list
    size: int = 512
    max_depth: int = 8
    spp: int = 16
    rounds: int = 5
    batches: int = 8
    batch_spp: int = 16
    threads: int = 2
    # Of étendue.
    guiding: str = "auto"


def open_peer(name, scene, threads):
    """A peer with the scene loaded."""
    log = cache() / f"{name}.log"
    module = {"PYTHONPATH": str(TOOLS), "PYTHONDONTWRITEBYTECODE": "1"}
    if name == "mitsuba":
        library, before = install.llvm()
        command = [*before, install.toolbox(), "-m", "benchmark.peer_mitsuba"]
        module["DRJIT_LIBLLVM_PATH"] = str(library)
    else:
        command = [install.cycles(), "-m", "benchmark.peer_cycles"]
    return Remote(name, command, module, log, scene=str(scene), threads=threads)


class Row:
    """A scene against a peer."""

    def __init__(self, settings, scene, peer, folder):
        self.settings, self.scene, self.name, self.folder = settings, scene, peer, pathlib.Path(folder)
        self.path = scene_writer.path_of(scene)
        self.ours = Etendue(settings.etendue, self.path, settings.threads, settings.guiding)
        self.peer = None

    def close(self):
        if self.peer:
            self.peer.close()

    def draw(self, renderer, spp, seed, **more):
        """(answer, picture)"""
        output = self.folder / ("ours.exr" if renderer is self.ours else f"theirs{pictures.SUFFIX[self.name]}")
        request = {"spp": spp, "seed": seed, "size": self.settings.size, "max_depth": self.settings.max_depth}
        if renderer is self.ours:
            # The peers' microfacets lose what bounces between them.
            request["set"] = "MULTIPLE_SCATTERING=0"
        answer = renderer.render(**request, **more, output=str(output))
        return answer, pictures.read(output)

    def batches(self, renderer, first):
        """Independent pictures of the same scene."""
        s = self.settings
        return numpy.stack([self.draw(renderer, s.batch_spp, first + i)[1] for i in range(s.batches)])

    def reference(self):
        """The peer's batches, kept in the cache: their mean is the reference of the error."""
        s = self.settings
        facts = [scene_writer.hash_of(self.path), conversion(), self.peer.about["version"], s.size, s.max_depth]
        key = hashlib.sha256(json.dumps([*facts, s.batches, s.batch_spp]).encode()).hexdigest()[:16]
        path = cache() / "references" / f"{self.scene}-{self.name}-{key}.npy"
        if not path.exists():
            install.say(f"{self.scene}: {self.name} draws the reference ...")
            path.parent.mkdir(parents=True, exist_ok=True)
            partial = path.with_suffix(".partial.npy")
            numpy.save(partial, self.batches(self.peer, 1000))
            shutil.move(partial, path)
        return numpy.load(path)

    def measure(self):
        """All of the row."""
        self.peer = open_peer(self.name, self.path, self.settings.threads)
        theirs = self.reference()
        install.say(f"{self.scene}: étendue draws {self.settings.batches} batches ...")
        verdict = agreement.compare(self.batches(self.ours, 2000), theirs)
        row = {"scene": self.scene, "peer": self.name, "triangles": self.triangles(), "agreement": verdict}
        if not verdict["agree"]:
            return row | {"error": not_comparable(verdict)}
        self.reference_mean = theirs.mean(axis=0, dtype=numpy.float64)
        self.reference_variance = theirs.var(axis=0, ddof=1, dtype=numpy.float64) / len(theirs)
        return row | self.measure_rounds() | {"etendue": self.ours.about, "other": self.peer.about}

    def triangles(self):
        document = json.loads(self.path.read_text(encoding="utf-8"))
        counts = {
            i: sum(document["accessors"][p["indices"]]["count"] // 3 for p in mesh["primitives"])
            for i, mesh in enumerate(document["meshes"])
        }
        return sum(counts[node["mesh"]] for node in document["nodes"] if "mesh" in node)

    def draw_timed(self, renderer, seed, **more):
        """(seconds, efficiency) of one render."""
        answer, picture = self.draw(renderer, self.settings.spp, 5000 + seed, **more)
        error = agreement.relative_mse(picture, self.reference_mean, self.reference_variance)
        if error <= 0:
            raise BenchError(f"{self.scene}: the reference is too noisy to measure the error; raise --batch-spp", 1)
        return answer["seconds"], 1 / (error * answer["seconds"])

    def rounds(self, best):
        """For each round (ours, theirs, theirs with its best sampler), drawn in turn; who begins changes."""
        drawn = []
        for i in range(self.settings.rounds):
            install.say(f"{self.scene} against {self.name}: round {i + 1} of {self.settings.rounds}")
            turns = [("ours", self.ours, {}), ("theirs", self.peer, {})]
            turns += [("best", self.peer, best)] if best != self.default_sampler() else []
            both = {name: self.draw_timed(who, i, **more) for name, who, more in turns[:: 1 if i % 2 == 0 else -1]}
            drawn.append((both["ours"], both["theirs"], both.get("best", both["theirs"])))
        return drawn

    def measure_rounds(self):
        """Speed at the same number of samples with default samplers, and 1 / (relMSE · seconds) with the best one."""
        spp, paths = self.settings.spp, self.settings.size**2 * self.settings.spp
        first = self.draw(self.peer, spp, 0)[0]["seconds"]
        self.draw(self.ours, 1, 0)
        best = self.best_sampler()
        drawn = self.rounds(best)
        ours, theirs = ([one[who][0] for one in drawn] for who in (0, 1))
        self.peer.about["first_render_extra"] = first - statistics.median(theirs)
        return {
            "spp": spp,
            "etendue_paths_per_second": paths / statistics.median(ours),
            "peer_paths_per_second": paths / statistics.median(theirs),
            "speed": statistics.summary([b / a for a, b in zip(ours, theirs)]),
            "etendue_efficiency": statistics.median([one[0][1] for one in drawn]),
            "peer_efficiency": statistics.median([one[2][1] for one in drawn]),
            "efficiency": statistics.summary([one[0][1] / one[2][1] for one in drawn]),
            "peer_sampler": best.get("sampler", "default"),
        }

    def default_sampler(self):
        return {"sampler": MITSUBA_SAMPLERS[0]} if self.name == "mitsuba" else {}

    def best_sampler(self):
        """The peer's own sampler that serves it best here, by one render of each after a warm-up."""
        if self.name != "mitsuba":
            return {}
        scores = {}
        for sampler in MITSUBA_SAMPLERS:
            self.draw_timed(self.peer, 1000, sampler=sampler)
            scores[sampler] = self.draw_timed(self.peer, 1001, sampler=sampler)[1]
        return {"sampler": max(scores, key=scores.get)}


def conversion():
    """Of the code that makes a peer's scene of ours: a reference by other code is another reference."""
    sources = [f"{name}.py" for name in ("camera", "scene_reader", "peer_mitsuba", "peer_cycles")]
    return hashlib.sha256(b"".join((TOOLS / "benchmark" / name).read_bytes() for name in sources)).hexdigest()


def not_comparable(verdict):
    where = verdict["worst_tile"]
    return (
        f"not comparable: the means differ by {100 * verdict['worst_relative_difference']:.2f}% in "
        f"{'the whole picture' if where == 'picture' else f'tile {where}'} (t = {verdict['worst_t']:.1f}, "
        f"p = {verdict['smallest_p']:.1e}, limit {verdict['p_limit']:.1e})"
    )


def measure(settings, scene, peer):
    """A finished row; a row with "error" if it cannot be compared."""
    with tempfile.TemporaryDirectory() as folder:
        row = Row(settings, scene, peer, folder)
        try:
            return row.measure()
        except NotComparable as error:
            return {"scene": scene, "peer": peer, "triangles": row.triangles(), "error": f"not comparable: {error}"}
        finally:
            row.close()
