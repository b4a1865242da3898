"""What the compiled kernel does for a ray, and the limit that a device's bandwidth and arithmetic put to it."""

import pathlib
import tempfile

from . import gpu, install, scene_writer, spirv, tables
from .peer_etendue import Etendue
from .places import BenchError

# The loop over elements, and what it does with each kind. A list has its own.
LOOP, NODE, PAIR, LIST = "trace_on", "visit_node", "test_pair", "closest_of_all"
COUNTS = ("scene", "pass", "part", *spirv.CLASSES, *spirv.MEMORY)
RAYS = (
    "scene",
    "pass",
    "nodes a ray",
    "pairs a ray",
    "bytes a ray",
    "operations a ray",
    "limit by bandwidth, Mrays/s",
    "limit by arithmetic, Mrays/s",
    "measured, Mrays/s",
    "share of the limit",
)


def compiled(etendue, integrator, flags):
    """The module that the device gets for a scene."""
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder) / "kernel.spv"
        etendue.write_spirv(path, integrator=integrator, **flags)
        return spirv.Module(path.read_bytes())


def parts(module):
    """Operations and accesses of the whole kernel and of the loop over elements, by part."""
    number = {name: module.function(name) for name in ("main", LOOP, NODE, PAIR, LIST)}
    if None in (number["main"], number[LOOP]) or (number[LIST] is None and None in (number[NODE], number[PAIR])):
        raise BenchError(
            f"the kernel has no functions {LOOP}, and {NODE} and {PAIR} or {LIST}: these shaders name them otherwise; "
            "tell tools/benchmark/kernel.py",
            3,
        )
    found = {"kernel": module.count(number["main"]), "loop": module.count(number[LOOP])}
    inner = {"list": LIST} if number[LIST] is not None else {"node": NODE, "pair": PAIR}
    return found | {part: module.count(number[name]) for part, name in inner.items()}


def arithmetic(count):
    return sum(count[name] for name in spirv.ARITHMETIC)


def per_ray(found, rays):
    """(bytes, operations) of a ray. In a tree the loop's own share, all but node and pair, is for each element."""
    if "list" in found:
        return found["loop"]["load buffer bytes"], arithmetic(found["loop"])
    nodes, pairs = rays["nodes_per_ray"], rays["pairs_per_ray"]
    own = arithmetic(found["loop"]) - arithmetic(found["node"]) - arithmetic(found["pair"])
    element = found["loop"]["load buffer bytes"]
    operations = nodes * arithmetic(found["node"]) + pairs * arithmetic(found["pair"]) + (nodes + pairs) * own
    return element * (nodes + pairs), operations


def limits(ray_bytes, operations, bandwidth, tflops):
    """Rays per second by bandwidth (GB/s) and by arithmetic; None where the figure is not given. A peak of FLOP/s
    counts a fused multiply-add as two, and an operation here takes the place of one such."""
    by_bytes = bandwidth * 1e9 / ray_bytes if bandwidth else None
    by_operations = tflops * 1e12 / 2 / operations if tflops else None
    return by_bytes, by_operations


def measure(command, threads, scenes, rounds, spp, bandwidth, tflops):
    """Rows: scene, pass, counts by part, traversal statistics, limits, measured rays per second."""
    rows = []
    for scene in scenes:
        etendue = Etendue(command, scene_writer.path_of(scene), threads)
        for timed in gpu.measure(command, threads, [scene], rounds, spp):
            integrator, flags, _ = gpu.PASSES[timed["pass"]]
            install.say(f"kernel: {scene}, {timed['pass']}")
            module = compiled(etendue, integrator, flags)
            found = parts(module)
            ray_bytes, operations = per_ray(found, timed["rays"])
            by_bytes, by_operations = limits(ray_bytes, operations, bandwidth, tflops)
            rows.append(
                {key: timed[key] for key in ("scene", "pass", "rays", "rays_per_second", "device", "driver")}
                | {
                    "parts": {part: dict(count) for part, count in found.items()},
                    "bytes_per_ray": ray_bytes,
                    "operations_per_ray": operations,
                    "workgroup_bytes": module.variable_bytes("workgroup"),
                    "private_bytes": module.variable_bytes("private"),
                    "limit_by_bandwidth": by_bytes,
                    "limit_by_arithmetic": by_operations,
                }
            )
    return rows


def markdown(rows, figures_are_of_device):
    """figures_are_of_device: whether a measured share of the limits means anything."""
    lines = [f"On {rows[0]['device']}, {rows[0]['driver']}. Scalar operations and accesses, each instruction once:", ""]
    lines += tables.table(COUNTS, [cells for row in rows for cells in part_cells(row)])
    lines += ["", *(memory_line(row) for row in rows)]
    lines += ["", "A ray:", "", *tables.table(RAYS, [ray_cells(row, figures_are_of_device) for row in rows])]
    return "\n".join(lines) + "\n"


def part_cells(row):
    for part, count in row["parts"].items():
        accesses = [f"{count.get(name, 0)} ({count.get(name + ' bytes', 0)} B)" for name in spirv.MEMORY]
        yield [row["scene"], row["pass"], part, *(count.get(name, 0) for name in spirv.CLASSES), *accesses]


def memory_line(row):
    return (
        f"- {row['scene']}, {row['pass']}: {row['workgroup_bytes']} bytes of workgroup memory; variables of a lane "
        f"before the driver's compiler: {row['private_bytes']} bytes."
    )


def ray_cells(row, figures_are_of_device):
    bounds = [row["limit_by_bandwidth"], row["limit_by_arithmetic"]]
    known = [bound for bound in bounds if bound]
    share = f"{100 * row['rays_per_second'] / min(known):.1f}%" if known and figures_are_of_device else ""
    return [
        row["scene"],
        row["pass"],
        f"{row['rays']['nodes_per_ray']:.2f}",
        f"{row['rays']['pairs_per_ray']:.2f}",
        f"{row['bytes_per_ray']:.0f}",
        f"{row['operations_per_ray']:.0f}",
        *(tables.rate(bound) if bound else "" for bound in bounds),
        tables.rate(row["rays_per_second"]),
        share,
    ]
