"""Tests of the parts that can go wrong quietly; the standard library alone.

cd tools && python3 -m unittest benchmark.test_benchmark
"""

import math
import random
import struct
import unittest

from . import camera, plot, spirv, statistics


def apply(matrix, vector):
    return [sum(a * b for a, b in zip(row, vector)) for row in matrix[:3]]


class Intervals(unittest.TestCase):
    def test_order_statistics_of_five(self):
        self.assertEqual(statistics.ratio_interval([3, 1, 2, 5, 4]), (1, 5, 1 - 2 / 32))

    def test_eight_and_more_come_closer(self):
        low, high, covers = statistics.ratio_interval(range(1, 10))
        self.assertEqual((low, high), (2, 8))
        self.assertAlmostEqual(covers, 1 - 2 * 10 / 512)

    def test_coverage_is_what_random_rounds_give(self):
        draw = random.Random(7)
        hits = 0
        for _ in range(4000):
            low, high, covers = statistics.ratio_interval([draw.lognormvariate(0, 1) for _ in range(9)])
            hits += low <= 1 <= high
        # 4.5 standard errors: a false alarm in 10⁵ runs of another seed.
        self.assertLess(abs(hits / 4000 - covers), 4.5 * math.sqrt(covers * (1 - covers) / 4000))

    def test_summary_takes_the_median_of_the_ratios(self):
        entry = statistics.summary([1.0, 9.0, 2.0])
        self.assertEqual((entry["median"], entry["low"], entry["high"]), (2.0, 1.0, 9.0))


class Student(unittest.TestCase):
    def test_p_values_of_tables(self):
        # Two-sided 5% and 0.1% points.
        for freedom, t, p in ((1, 12.706, 0.05), (5, 2.571, 0.05), (10, 4.587, 0.001), (1e6, 1.959964, 0.05)):
            self.assertAlmostEqual(statistics.student_p(t, freedom) / p, 1, delta=2e-3)

    def test_closed_forms(self):
        # Cauchy: p = 1 − (2/π) atan t. Far tails keep their relative precision.
        for t in (0.5, 3.0, 1e4):
            self.assertAlmostEqual(statistics.student_p(t, 1) / (2 / math.pi * math.atan(1 / t)), 1, places=9)

    def test_the_quantile_inverts_p(self):
        self.assertAlmostEqual(statistics.student_p(statistics.student_quantile(1e-6, 9.5), 9.5) / 1e-6, 1, places=6)

    def test_power_law(self):
        self.assertAlmostEqual(statistics.power_law([1, 2, 4], [3, 3 * 2**1.5, 3 * 8]), 1.5)


class Cameras(unittest.TestCase):
    def setUp(self):
        eye, target = (1.0, 2.0, 5.0), (-0.5, 0.25, -1.0)
        self.node = {"translation": eye, "rotation": camera.look_at_quaternion(eye, target)}
        self.matrix = camera.of_node(self.node)
        length = math.dist(eye, target)
        self.forward = [(t - e) / length for e, t in zip(eye, target)]

    def close(self, a, b):
        for x, y in zip(a, b):
            self.assertAlmostEqual(x, y)

    def test_gltf_looks_along_minus_z_and_up_is_up(self):
        self.close(apply(self.matrix, [0, 0, -1, 0]), self.forward)
        self.assertGreater(apply(self.matrix, [0, 1, 0, 0])[1], 0)
        self.assertAlmostEqual(apply(self.matrix, [1, 0, 0, 0])[1], 0)

    def test_mitsuba_looks_along_z_with_x_to_the_left(self):
        matrix = camera.to_mitsuba(self.matrix)
        self.close(apply(matrix, [0, 0, 1, 0]), self.forward)
        self.close(apply(matrix, [1, 0, 0, 0]), [-x for x in apply(self.matrix, [1, 0, 0, 0])])
        self.close(apply(matrix, [0, 0, 0, 1]), self.node["translation"])

    def test_blender_has_z_up(self):
        x, y, z = self.forward
        self.close(apply(camera.to_blender(self.matrix), [0, 0, -1, 0]), [x, -z, y])

    def test_matrices_come_by_columns(self):
        columns = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 7, 8, 9, 1]
        self.close(apply(camera.of_node({"matrix": columns}), [0, 0, 0, 1]), [7, 8, 9])


class Plots(unittest.TestCase):
    def test_values_lie_inside_and_in_order(self):
        axis = plot.Axis([3, 40, 2000], 0, 100)
        places = [axis.at(v) for v in (3, 40, 2000)]
        self.assertEqual(places, sorted(places))
        self.assertTrue(0 < places[0] and places[2] < 100)
        self.assertEqual(axis.ticks(), [10, 100, 1000])

    def test_a_constant_has_an_axis(self):
        self.assertTrue(plot.Axis([5.0, 5.0], 0, 1).ticks())


def instruction(code, *operands):
    return [len(operands) + 1 << 16 | code, *operands]


def name(number, text):
    raw = text.encode() + b"\0"
    return instruction(5, number, *struct.unpack(f"={(len(raw) + 3) // 4}I", raw.ljust((len(raw) + 3) // 4 * 4, b"\0")))


class Spirv(unittest.TestCase):
    """A function `inner` loads a vec4 from a buffer and adds it to itself; `main` calls it twice and branches."""

    def setUp(self):
        words = [spirv.MAGIC, 0x10300, 0, 100, 0, *name(20, "inner"), *name(30, "main")]
        words += instruction(22, 1, 32) + instruction(23, 2, 1, 4)  # float, vec4
        words += instruction(32, 3, 12, 2) + instruction(59, 3, 10, 12)  # a variable in a storage buffer
        words += instruction(21, 4, 32, 0) + instruction(43, 4, 5, 7)  # uint 7
        words += instruction(28, 6, 1, 5) + instruction(32, 7, 4, 6) + instruction(59, 7, 11, 4)  # workgroup float[7]
        words += instruction(54, 2, 20, 0, 9) + instruction(248, 21)
        words += instruction(61, 2, 22, 10) + instruction(129, 2, 23, 22, 22) + instruction(12, 2, 24, 8, 31, 23)
        words += instruction(254, 24) + instruction(56)
        words += instruction(54, 2, 30, 0, 9) + instruction(248, 31)
        words += instruction(57, 2, 32, 20) + instruction(57, 2, 33, 20) + instruction(250, 40, 31, 31)
        words += instruction(56)
        self.module = spirv.Module(struct.pack(f"={len(words)}I", *words))

    def test_calls_and_vectors_are_counted_through(self):
        inner = self.module.count(self.module.function("inner"))
        self.assertEqual(inner, {"load buffer": 1, "load buffer bytes": 16, "float": 4, "transcendental": 4})
        main = self.module.count(self.module.function("main"))
        twice = {key: 2 * value for key, value in inner.items()}
        self.assertEqual(main, {**twice, "branch": 1})

    def test_bytes_of_variables(self):
        self.assertEqual(self.module.variable_bytes("workgroup"), 28)
        self.assertEqual(self.module.variable_bytes("private"), 0)

    def test_another_file_is_refused(self):
        with self.assertRaises(ValueError):
            spirv.Module(b"glTF" * 8)


if __name__ == "__main__":
    unittest.main()
