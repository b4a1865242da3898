"""Installs the peers into virtual environments of their own. Nothing of the system is touched."""

import os
import pathlib
import shutil
import subprocess
import sys

from .places import TOOLS, BenchError, cache

# Peers are pinned: a figure without its version says nothing.
TOOLBOX = ["mitsuba==3.9.1", "numpy==2.4.6", "OpenEXR==3.5.3"]
CYCLES = ["bpy==5.0.1"]
EMBREE = ["embreex==4.4.0.post1", "numpy==2.4.6"]
# The wheels of bpy 5.0 are for this version of Python alone.
CYCLES_PYTHON = "3.11"
LLVM_OLDEST = 16
OLDEST_PYTHON = (3, 11)


def say(text):
    """A line of progress, on a terminal only."""
    if sys.stderr.isatty():
        print(f"bench: {text}", file=sys.stderr)


def environment(name, python, packages):
    """The interpreter of the virtual environment `name` with these packages; makes it if it is not there."""
    folder = cache() / name
    done = folder / "installed"
    if not done.exists() or done.read_text() != "\n".join(packages):
        say(f"installing {' '.join(packages)} (hundreds of MB) ...")
        shutil.rmtree(folder, ignore_errors=True)
        folder.parent.mkdir(parents=True, exist_ok=True)
        run([python, "-m", "venv", folder], f"cannot make a virtual environment with {python}")
        pip = [folder / "bin" / "python", "-m", "pip", "install", "--quiet", "--disable-pip-version-check"]
        run([*pip, *packages], f"pip could not install {' '.join(packages)}")
        done.write_text("\n".join(packages))
    return folder / "bin" / "python"


def run(command, what, variables=None):
    """Runs a command; its output is shown if it fails."""
    command = [str(part) for part in command]
    done = subprocess.run(command, capture_output=True, text=True, check=False, env=variables)
    if done.returncode != 0:
        raise BenchError(f"{what}:\n{done.stdout}{done.stderr}".rstrip(), 3)
    return done.stdout


def toolbox():
    """The interpreter that runs the benchmark itself; it holds Mitsuba, too."""
    if sys.version_info < OLDEST_PYTHON:
        wanted, here = (".".join(map(str, version[:2])) for version in (OLDEST_PYTHON, sys.version_info))
        raise BenchError(f"the pinned numpy needs Python {wanted} or newer, and python3 is {here}", 3)
    return environment("toolbox", sys.executable, TOOLBOX)


def cycles():
    """The interpreter that holds Cycles."""
    return environment("cycles", cycles_python(), CYCLES)


def embree():
    """The interpreter that holds Embree."""
    return environment("embree", sys.executable, EMBREE)


def cycles_python():
    """A Python of the version that bpy's wheels are for."""
    name = f"python{CYCLES_PYTHON}"
    pyenv = pathlib.Path(os.environ.get("PYENV_ROOT") or pathlib.Path.home() / ".pyenv") / "versions"
    places = [shutil.which(name), *(found / "bin" / name for found in pyenv.glob(CYCLES_PYTHON + ".*"))]
    for place in filter(None, places):
        works = subprocess.run([place, "-c", "import venv"], capture_output=True, check=False)
        if works.returncode == 0:
            return place
    raise BenchError(
        f"Cycles ({CYCLES[0]}) needs Python {CYCLES_PYTHON}, and there is none in the path or under pyenv. "
        f"Install {name} with its venv module, or leave Cycles out with --peers mitsuba.",
        3,
    )


def lavapipe_root(suite):
    """The folder of tools/lavapipe with the driver of a Debian suite; fetches it if it is not there."""
    lines = run([TOOLS / "lavapipe", "--suite", suite, "--print"], f"tools/lavapipe could not fetch {suite}")
    facts = dict(line.split(None, 1) for line in lines.splitlines())
    return pathlib.Path(facts["runner"]).parent


def llvm():
    """(library, command to put before a program that loads it) for Mitsuba's LLVM backend.

    $DRJIT_LIBLLVM_PATH wins. Else the library that the newest lavapipe brings is used, under the C library that it
    was built for.
    """
    chosen = os.environ.get("DRJIT_LIBLLVM_PATH")
    if chosen:
        return pathlib.Path(chosen), []
    root = lavapipe_root("trixie-backports")
    found = sorted(path for path in root.rglob("libLLVM.so.*") if int(path.name.split(".")[2]) >= LLVM_OLDEST)
    if not found:
        raise BenchError(
            f"Mitsuba's llvm_ad_rgb needs LLVM {LLVM_OLDEST} or newer, and tools/lavapipe brought none. "
            "Set DRJIT_LIBLLVM_PATH to such a libLLVM.so.",
            3,
        )
    return found[-1], [str(root / "run")]
