"""Do two renderers converge to the same picture? A fast wrong picture is no result.

Each renderer draws several independent batches. Welch's t-test compares the means of each channel over the picture and
over square tiles; Bonferroni's correction holds the chance of a false alarm in a row of the table to FALSE_ALARM.
"""

import numpy

from . import statistics

FALSE_ALARM = 1e-3
TILE = 16


def tiles(batches):
    """Means of tiles, (batches, tiles, 3), the whole picture as one more tile at the end."""
    count, height, width = batches.shape[:3]
    cut = batches[:, : height // TILE * TILE, : width // TILE * TILE].astype(numpy.float64)
    small = cut.reshape(count, height // TILE, TILE, width // TILE, TILE, 3).mean(axis=(2, 4)).reshape(count, -1, 3)
    return numpy.concatenate([small, batches.mean(axis=(1, 2), dtype=numpy.float64)[:, None]], axis=1)


def compare(ours, theirs):
    """A verdict on two stacks of batches, (batches, height, width, 3)."""
    a, b = tiles(ours), tiles(theirs)
    difference = a.mean(axis=0) - b.mean(axis=0)
    va, vb = a.var(axis=0, ddof=1) / len(a), b.var(axis=0, ddof=1) / len(b)
    error = numpy.sqrt(va + vb)
    freedom = (va + vb) ** 2 / numpy.maximum(va**2 / (len(a) - 1) + vb**2 / (len(b) - 1), 1e-300)
    level = b[:, -1].mean(axis=0)
    # Black tiles have no variance: rounding is let pass.
    t = numpy.abs(difference) / numpy.maximum(error, 1e-6 * level)
    worst = numpy.unravel_index(numpy.argmax(t), t.shape)
    p = min(statistics.student_p(float(x), float(n)) for x, n in zip(t.ravel(), numpy.maximum(freedom, 1).ravel()))
    limit = FALSE_ALARM / t.size
    smallest = statistics.student_quantile(limit, float(numpy.median(freedom)))
    return {
        "agree": bool(p >= limit),
        "smallest_p": p,
        "p_limit": limit,
        "tests": int(t.size),
        "worst_t": float(t[worst]),
        "worst_tile": "picture" if worst[0] == len(difference) - 1 else int(worst[0]),
        "worst_relative_difference": float(difference[worst] / max(b[:, worst[0], worst[1]].mean(), 1e-12)),
        "relative_difference_of_means": (difference[-1] / level).tolist(),
        "smallest_bias_seen_picture": float((smallest * error[-1] / level).max()),
        "smallest_bias_seen_tile": float(numpy.median(smallest * error[:-1].mean(axis=1) / level.mean())),
        "batches": [len(a), len(b)],
    }


def relative_mse(picture, reference, variance):
    """mean((x − r)² / (r² + 0.01)), without what the reference's own noise adds to it.

    variance: of the reference, per pixel and channel. E (x − r)² = E (x − truth)² + Var r as the two are independent.
    """
    weight = 1 / (reference.astype(numpy.float64) ** 2 + 0.01)
    return float((((picture - reference) ** 2 - variance) * weight).mean())
