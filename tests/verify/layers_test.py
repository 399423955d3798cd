#!/usr/bin/env python3
"""A liquid at rest on one of ten times its density: each has its own hydrostatic pressure, and they do not mix.

usage: layers_test.py PROGRAM MPIEXEC RANKS
"""
import os
import sys
import unittest

import numpy

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "run"))
import harness
from harness import INPUTS, Workplace

RANKS = 2
GRAVITY, WIDTH, HEIGHT, INTERFACE, SPACING = 9.81, 0.24, 0.64, 0.32, 0.02
LIGHT, HEAVY = (0, 100.0), (1, 1000.0)  # index in the scene, density
WEIGHT = GRAVITY * WIDTH * (LIGHT[1] * (HEIGHT - INTERFACE) + HEAVY[1] * INTERFACE)  # [N/m]
SETTLED = 0.5  # by then the start has died away


class LayeredTank(Workplace):
    done = None

    def setUp(self):
        super().setUp()
        if LayeredTank.done is None:
            self.run_scene(os.path.join(INPUTS, "layered_tank", "scene.yaml"), "run", RANKS,
                           {"time.end": "0.8", "output.interval": "0.01"})
            frames = [self.frame("run", number) for number in range(-31, 0)]
            LayeredTank.done = (frames, self.steps("run"), self.columns("run", "bodies.csv"))
        self.settled_frames, self.history, self.loads = LayeredTank.done

    def slope(self, frame, liquid, low, high):
        """Of the pressure over the depth, in rho g of the liquid, between two heights away from walls and interface."""
        number, density = liquid
        x, p = frame["position"], frame["pressure"]
        margin = 3 * SPACING
        bulk = ((frame["liquid"] == number) & (x[:, 0] > margin) & (x[:, 0] < WIDTH - margin)
                & (x[:, 1] > low + margin) & (x[:, 1] < high - margin))
        self.assertGreater(bulk.sum(), 40)
        return -numpy.polyfit(x[bulk, 1], p[bulk], 1)[0] / (density * GRAVITY)

    def test_pressure_grows_with_depth_as_each_liquid_has_it(self):
        for name, liquid, low, high in (("light", LIGHT, INTERFACE, HEIGHT), ("heavy", HEAVY, 0, INTERFACE)):
            with self.subTest(liquid=name):
                mean = numpy.mean([self.slope(frame, liquid, low, high) for frame in self.settled_frames])
                self.assertAlmostEqual(mean, 1, delta=0.05)  # first order in the spacing: 10 layers of each

    def test_the_floor_carries_the_weight_of_both(self):
        settled = self.loads["time [s]"] >= SETTLED
        sides = [name for name in self.loads.dtype.names if name.endswith("pressure force y [N/m]")]
        carried = -sum(self.loads[name][settled].mean() for name in sides)
        self.assertAlmostEqual(carried / WEIGHT, 1, delta=0.02)  # of a mean over the last 0.3 s

    def test_they_stay_where_they_are(self):
        height, liquid = self.settled_frames[-1]["position"][:, 1], self.settled_frames[-1]["liquid"]
        self.assertLess(height[liquid == HEAVY[0]].max(), INTERFACE + SPACING)
        self.assertGreater(height[liquid == LIGHT[0]].min(), INTERFACE - SPACING)
        settled = self.history["time [s]"] >= SETTLED
        self.assertLess(self.history["max speed [m/s]"][settled].max(), 0.1)  # sqrt(g H) is 2.5 m/s


if __name__ == "__main__":
    if len(sys.argv) < 4:
        sys.exit(__doc__)
    RANKS = int(sys.argv.pop(3))
    harness.main(sys.argv, __doc__)
