"""étendue, a process a render."""

import json
import os
import pathlib
import subprocess
import tempfile

from . import install, places
from .places import BenchError


def program(chosen=None):
    """The program: that of --etendue, else built here."""
    if chosen:
        if not os.access(chosen, os.X_OK):
            raise BenchError(f"--etendue {chosen}: no such program")
        return pathlib.Path(chosen).resolve()
    install.say("building étendue ...")
    build = ["cargo", "build", "--release", "--locked", "--quiet", "--bin", "etendue"]
    done = subprocess.run(build, cwd=places.REPOSITORY, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise BenchError(f"cargo could not build étendue:\n{done.stderr}".rstrip(), 3)
    return places.target() / "release" / "etendue"


def runner(driver):
    """What to put before the program. driver: "newest", "system", or a Debian suite of tools/lavapipe."""
    if driver == "system":
        return []
    suite = "trixie-backports" if driver == "newest" else driver
    return [str(install.lavapipe_root(suite) / "run")]


class Etendue:
    """Renders one scene. Scene loading, build and compilation are repeated each time and timed apart.

    guiding: auto, on or off, as of `etendue render`; what looks at a kernel wants it off.
    """

    name = "etendue"

    def __init__(self, command, scene, threads, guiding="off"):
        self.command, self.scene, self.guiding = command, scene, guiding
        self.environment = os.environ | {"LP_NUM_THREADS": str(threads), "RAYON_NUM_THREADS": str(threads)}
        self.about = {}

    def run(self, flags):
        """`etendue render` with flags, with _ for -; True stands for a flag without a value."""
        environment = self.scene.parent / "environment.exr"
        if environment.exists():
            flags.setdefault("env", environment)
        flags.setdefault("guiding", self.guiding)
        # What is timed is what a long render runs, however short the measurement.
        flags.setdefault("optimization", "full")
        command = [*self.command, "render", str(self.scene), "--quiet"]
        for flag, value in flags.items():
            command += [f"--{flag.replace('_', '-')}"] + ([] if value is True else [str(value)])
        done = subprocess.run(command, env=self.environment, capture_output=True, text=True, check=False)
        if done.returncode != 0:
            raise BenchError(f"étendue failed ({done.returncode}): {done.stderr.strip()}", 3)

    def write_spirv(self, path, **flags):
        """The kernel that a render with these flags would run."""
        self.run(flags | {"spirv": path})

    def render(self, spp, seed, size, output=None, max_depth=8, **more):
        """more: further flags. Returns the --json report with seconds at the top."""
        width, height = size if isinstance(size, tuple) else (size, size)
        flags = {"spp": spp, "seed": seed, "size": f"{width}x{height}", "max_depth": max_depth, **more}
        with tempfile.TemporaryDirectory() as folder:
            report = pathlib.Path(folder) / "report.json"
            self.run(flags | {"json": report} | ({"output": output} if output else {}))
            answer = json.loads(report.read_text(encoding="utf-8"))
        if answer["non_finite_samples"]:
            raise BenchError(f"étendue drew {answer['non_finite_samples']} samples that are no numbers", 1)
        phases = answer["seconds"]
        self.about = {"version": f"étendue {answer['version']}", "driver": answer["driver"], "device": answer["device"]}
        self.about |= {key: phases[key] for key in ("load", "accel", "upload", "compile")}
        # A guide's training is a part of the picture's time, as its samples are of a peer's.
        seconds = phases["render"] + answer["guiding"]["seconds"]
        return {"seconds": seconds, "mean": answer["mean_radiance"], "report": answer}

    def close(self):
        """Nothing is left running."""
