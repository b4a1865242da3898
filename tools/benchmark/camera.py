"""Cameras: from glTF's convention to the peers'. Plain lists, row-major 4 × 4 matrices."""

import math


def multiply(a, b):
    """The product of two matrices."""
    return [[sum(a[i][k] * b[k][j] for k in range(4)) for j in range(4)] for i in range(4)]


def from_trs(translation=(0, 0, 0), rotation=(0, 0, 0, 1), scale=(1, 1, 1)):
    """glTF's translation × rotation (quaternion x, y, z, w) × scale."""
    x, y, z, w = rotation
    turn = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]
    rows = [[turn[i][j] * scale[j] for j in range(3)] + [translation[i]] for i in range(3)]
    return [*rows, [0, 0, 0, 1]]


def of_node(node):
    """The local matrix of a glTF node. glTF stores matrices by columns."""
    if "matrix" in node:
        return [[node["matrix"][4 * j + i] for j in range(4)] for i in range(4)]
    parts = {key: node[key] for key in ("translation", "rotation", "scale") if key in node}
    return from_trs(**parts)


def to_mitsuba(matrix):
    """glTF looks along −Z with +X to the right; Mitsuba looks along +Z with +X to the left."""
    turn = [[-1, 0, 0, 0], [0, 1, 0, 0], [0, 0, -1, 0], [0, 0, 0, 1]]
    return multiply(matrix, turn)


# glTF's world has +Y up, Blender's +Z: (x, y, z) becomes (x, −z, y).
Z_UP = [[1, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 0], [0, 0, 0, 1]]


def to_blender(matrix):
    """Blender's camera looks as glTF's does, in a world with another up."""
    return multiply(Z_UP, matrix)


def look_at_quaternion(eye, target):
    """The unit quaternion (x, y, z, w) that turns −Z from eye to target and keeps +Y up."""
    x, y, z = (t - e for t, e in zip(target, eye))
    yaw, pitch = math.atan2(-x, -z) / 2, math.atan2(y, math.hypot(x, z)) / 2
    cy, sy, cp, sp = math.cos(yaw), math.sin(yaw), math.cos(pitch), math.sin(pitch)
    return [cy * sp, sy * cp, -sy * sp, cy * cp]
