"""Where things are: the repository, the cache, the assets of others."""

import os
import pathlib

TOOLS = pathlib.Path(__file__).resolve().parent.parent
REPOSITORY = TOOLS.parent


class BenchError(Exception):
    """What the user must change, in a sentence. code: the exit code, 2 for input, 3 for device or machine."""

    def __init__(self, text, code=2):
        super().__init__(text)
        self.code = code


class NotComparable(Exception):
    """The scene has something that a peer has no exact counterpart of."""


def cache():
    """The private folder of the benchmarks: $ETENDUE_BENCH_DIR, or etendue/bench in the user's cache."""
    chosen = os.environ.get("ETENDUE_BENCH_DIR")
    if chosen:
        return pathlib.Path(chosen).resolve()
    base = os.environ.get("XDG_CACHE_HOME") or pathlib.Path.home() / ".cache"
    return pathlib.Path(base) / "etendue" / "bench"


def shared_assets():
    """The folder of assets of others' making, or None: $ETENDUE_SHARED/assets, else ../shared/assets."""
    chosen = os.environ.get("ETENDUE_SHARED")
    folder = (pathlib.Path(chosen) if chosen else REPOSITORY.parent / "shared") / "assets"
    return folder if folder.is_dir() else None


def target():
    """Cargo's target folder."""
    return pathlib.Path(os.environ.get("CARGO_TARGET_DIR") or REPOSITORY / "target")


def threads():
    """Cores that this process may use."""
    return len(os.sched_getaffinity(0))
