"""Tests of the parts that can go wrong quietly; the standard library alone.

cd tools && python3 -m unittest benchmark.test_benchmark
"""

import math
import random
import unittest

from . import camera, plot, statistics


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


if __name__ == "__main__":
    unittest.main()
