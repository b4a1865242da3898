"""The command line."""

import argparse
import json
import pathlib
import sys

from . import assets, builder, compare, features, gpu, kernel, light_scenes, lights, peer_etendue, places, scaling
from . import scene_writer, tables
from .places import BenchError


def positive(text):
    """A whole number from 1 on."""
    value = int(text)
    if value < 1:
        raise argparse.ArgumentTypeError(f"{text} is not 1 or more")
    return value


def several(text):
    """A whole number from 2 on: one picture has no spread."""
    value = positive(text)
    if value < 2:
        raise argparse.ArgumentTypeError(f"{text} is not 2 or more")
    return value


def parser():
    top = argparse.ArgumentParser(
        prog="tools/bench",
        description="Measures étendue against its peers.",
        epilog="Also: tools/bench scaling, tools/bench gpu, tools/bench kernel, tools/bench bvh, tools/bench lights, tools/bench-features; each has --help.",
    )
    top.add_argument(
        "--scenes", default="", help=f"comma-separated: {', '.join(scene_writer.NAMES)} (default: all that can be had)"
    )
    top.add_argument("--peers", default="mitsuba,cycles", help="comma-separated: %(default)s")
    top.add_argument("--rounds", type=positive, default=5, help="interleaved rounds (default %(default)s)")
    top.add_argument("--spp", type=positive, default=16, help="samples a pixel of a timed render (default %(default)s)")
    top.add_argument("--size", type=positive, default=512, help="width and height (default %(default)s)")
    top.add_argument("--batches", type=several, default=8, help="pictures of the agreement check (default %(default)s)")
    top.add_argument("--batch-spp", type=positive, default=16, help="samples a pixel of each (default %(default)s)")
    top.add_argument(
        "--threads", type=positive, default=places.threads(), help="for everyone (default: all, %(default)s)"
    )
    top.add_argument("--guiding", choices=["auto", "on", "off"], default="auto", help="of étendue (default %(default)s)")
    top.add_argument("--quick", action="store_true", help="3 rounds of 4 samples at 256x256: tries the machinery out")
    add_device(top)
    return top


def add_device(top):
    device = top.add_mutually_exclusive_group()
    device.add_argument("--driver", default="newest", help="newest, system, or a Debian suite for tools/lavapipe")
    device.add_argument("--gpu", action="store_true", help="whatever the system's Vulkan gives")
    top.add_argument("--etendue", help="use this program instead of building it")
    top.add_argument("--json", type=pathlib.Path, metavar="FILE")
    top.add_argument("--markdown", type=pathlib.Path, metavar="FILE")


def command_of(options):
    """étendue with what has to stand before it."""
    driver = "system" if options.gpu else options.driver
    return [*peer_etendue.runner(driver), str(peer_etendue.program(options.etendue))]


def settings_of(options):
    s = compare.Settings(
        command_of(options),
        options.size,
        8,
        options.spp,
        options.rounds,
        options.batches,
        options.batch_spp,
        options.threads,
        guiding=options.guiding,
    )
    if options.quick:
        s.size, s.rounds, s.spp, s.batches, s.batch_spp = 256, 3, 4, 8, 8
    return s


def compare_all(options):
    settings = settings_of(options)
    report = {
        "settings": {k: v for k, v in vars(settings).items() if k != "etendue"},
        "rows": [],
        "driver": "",
        "peers": [],
    }
    report["left_out"] = [] if options.scenes or places.shared_assets() else list(assets.NAMES)
    everything = [name for name in scene_writer.NAMES if name not in report["left_out"]]
    for scene in split(options.scenes, scene_writer.NAMES, "--scenes") or everything:
        for peer in split(options.peers, compare.PEERS, "--peers"):
            row = compare.measure(settings, scene, peer)
            report["rows"].append(row)
            report["driver"] = row.get("etendue", {}).get("driver", report["driver"])
            version = row.get("other", {}).get("version", peer)
            report["peers"] += [] if version in report["peers"] else [version]
            write(options, report, tables.comparison(report))
    print(tables.comparison(report))
    return 1 if any("error" in row for row in report["rows"]) else 0


def split(text, known, flag):
    names = [name for name in text.split(",") if name]
    for name in names:
        if name not in known:
            raise BenchError(f"{flag}: there is no {name!r}; there are {', '.join(known)}")
    return names


def write(options, report, markdown):
    """After each row, so that an interrupted run leaves what it has."""
    if options.json:
        options.json.write_text(json.dumps(report, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
    if options.markdown:
        options.markdown.write_text(markdown, encoding="utf-8")


def measure_scaling(arguments):
    top = argparse.ArgumentParser(prog="tools/bench scaling", description="Time against the size of the problem.")
    top.add_argument("--rounds", type=positive, default=3)
    top.add_argument("--threads", type=positive, default=places.threads())
    top.add_argument("--triangles", type=positive, default=10**7, help="the most (default %(default)s)")
    top.add_argument(
        "--samples", type=positive, default=1, help="multiplies the samples of all points (default %(default)s)"
    )
    top.add_argument("--svg", type=pathlib.Path, metavar="FILE", help="a plot")
    add_device(top)
    options = top.parse_args(arguments)
    rows = scaling.measure(command_of(options), options.threads, options.rounds, options.triangles, options.samples)
    table = scaling.markdown(
        rows, f"étendue, {options.threads} threads, medians of {options.rounds} interleaved rounds."
    )
    if options.svg:
        options.svg.write_text(scaling.svg(rows), encoding="utf-8")
    return finish(options, rows, table)


def options_alone(name, description, scenes, spp):
    """What the measurements of étendue's rays have in common."""
    top = argparse.ArgumentParser(prog=f"tools/bench {name}", description=description)
    top.add_argument("--scenes", default=scenes, help="comma-separated (default %(default)s)")
    top.add_argument("--rounds", type=positive, default=5, help="interleaved rounds (default %(default)s)")
    top.add_argument("--spp", type=positive, default=spp, help="samples a pixel (default %(default)s)")
    top.add_argument("--threads", type=positive, default=places.threads())
    add_device(top)
    return top


def measure_gpu(arguments):
    top = options_alone("gpu", "Rays per second at 1080p.", "cornell,spheres-360k,spheres-2m,spheres-8m", 64)
    options = top.parse_args(arguments)
    scenes = split(options.scenes, scene_writer.NAMES, "--scenes")
    rows = gpu.measure(command_of(options), options.threads, scenes, options.rounds, options.spp)
    return finish(options, rows, gpu.markdown(rows, options.rounds, options.spp))


def measure_kernel(arguments):
    description = "What the compiled kernel does for a ray, and the limit that a device puts to it."
    top = options_alone("kernel", description, "cornell,spheres-360k", 1)
    top.add_argument("--bandwidth", type=float, metavar="GB/s", help="of the device's memory; H100 SXM: 3350")
    top.add_argument("--tflops", type=float, metavar="N", help="its peak in fp32, 10¹²/s; H100 SXM: 67")
    options = top.parse_args(arguments)
    scenes = split(options.scenes, scene_writer.NAMES, "--scenes")
    drawn = options.rounds, options.spp
    figures = options.bandwidth, options.tflops
    rows = kernel.measure(command_of(options), options.threads, scenes, *drawn, *figures)
    return finish(options, rows, kernel.markdown(rows, options.gpu))


def measure_bvh(arguments):
    top = options_alone("bvh", "The builder's presets, and Embree.", "spheres-360k,spheres-2m,spheres-8m", 4)
    top.add_argument("--size", type=positive, default=512, help="width and height (default %(default)s)")
    top.add_argument("--no-embree", action="store_true", help="étendue alone: nothing is installed")
    options = top.parse_args(arguments)
    scenes = split(options.scenes, scene_writer.NAMES, "--scenes")
    drawn = options.rounds, options.spp, options.size
    rows = builder.measure(command_of(options), options.threads, scenes, *drawn, not options.no_embree)
    return finish(options, rows, builder.markdown(rows, *drawn))


def measure_lights(arguments):
    description = "Noise at equal time against the number of emissive triangles, by --lights uniform, power, tree."
    top = options_alone("lights", description, ",".join(light_scenes.SCENES), 16)
    counts = ",".join(map(str, lights.COUNTS))
    top.add_argument("--counts", default=counts, help="emissive triangles, comma-separated (default %(default)s)")
    top.add_argument("--size", type=positive, default=128, help="width and height (default %(default)s)")
    top.add_argument("--depth", type=positive, default=8, help="most edges of a path (default %(default)s)")
    options = top.parse_args(arguments)
    scenes = split(options.scenes, light_scenes.SCENES, "--scenes")
    drawn = options.rounds, options.spp, options.size, options.depth
    try:
        counts = [positive(count) for count in options.counts.split(",")]
    except (ValueError, argparse.ArgumentTypeError):
        raise BenchError(f"--counts {options.counts}: give whole numbers from 1 on, separated by commas") from None
    rows = lights.measure(command_of(options), options.threads, scenes, counts, *drawn)
    return finish(options, rows, lights.markdown(rows, *drawn))


def measure_features(arguments):
    top = argparse.ArgumentParser(
        prog="tools/bench-features",
        description="What each feature of the shader costs when it is compiled in but not used, and when it is used.",
    )
    known = list(features.USES)
    top.add_argument("--features", default=",".join(known), help="comma-separated (default %(default)s)")
    top.add_argument("--rounds", type=positive, default=5, help="interleaved rounds (default %(default)s)")
    top.add_argument("--spp", type=positive, default=16, help="samples a pixel (default %(default)s)")
    top.add_argument("--size", type=positive, default=256, help="width and height (default %(default)s)")
    top.add_argument("--threads", type=positive, default=places.threads())
    add_device(top)
    options = top.parse_args(arguments)
    names = split(options.features, known, "--features")
    drawn = options.rounds, options.spp, options.size
    rows = features.measure(command_of(options), options.threads, names, *drawn)
    return finish(options, rows, features.markdown(rows, *drawn))


def finish(options, report, table):
    write(options, report, table)
    print(table)
    return 0


COMMANDS = {
    "scaling": measure_scaling,
    "gpu": measure_gpu,
    "kernel": measure_kernel,
    "bvh": measure_bvh,
    "lights": measure_lights,
    "features": measure_features,
}


def main(arguments):
    """Exit codes: 0 measured, 1 means disagree, 2 usage, 3 something cannot be installed or run, 130 interrupted."""
    try:
        if arguments and arguments[0] in COMMANDS:
            return COMMANDS[arguments[0]](arguments[1:])
        return compare_all(parser().parse_args(arguments))
    except BenchError as error:
        print(f"bench: {error}", file=sys.stderr)
        return error.code
    except KeyboardInterrupt:
        return 130


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
