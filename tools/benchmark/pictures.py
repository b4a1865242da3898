"""Pictures as arrays (height, width, 3) of f32, row 0 at the top."""

import pathlib

import numpy

# What each peer writes.
SUFFIX = {"mitsuba": ".npy", "cycles": ".exr"}


def read(path):
    path = pathlib.Path(path)
    if path.suffix == ".npy":
        return numpy.load(path)
    return read_exr(path)[0]


def read_exr(path):
    """(picture, header)"""
    import OpenEXR

    with OpenEXR.File(str(path), separate_channels=True) as file:
        channels, header = file.channels(), dict(file.header())
        names = [next(n for n in channels if n == c or n.endswith("." + c)) for c in "RGB"]
        planes = [numpy.asarray(channels[name].pixels, numpy.float32) for name in names]
    return numpy.stack(planes, axis=2), header
