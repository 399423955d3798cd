#!/usr/bin/env python3
"""A liquid at rest on one of ten times its density: each has its own hydrostatic pressure, and they do not mix.

usage: layers_test.py PROGRAM MPIEXEC RANKS
"""
import numpy

import tank_at_rest
from tank_at_rest import GRAVITY, SPACING, TankAtRest

WIDTH, HEIGHT, INTERFACE = 0.24, 0.64, 0.32
LIGHT, HEAVY = (0, 100.0), (1, 1000.0)  # index in the scene, density
WEIGHT = GRAVITY * WIDTH * (LIGHT[1] * (HEIGHT - INTERFACE) + HEAVY[1] * INTERFACE)  # [N/m]


class LayeredTank(TankAtRest):
    scene, width = "layered_tank", WIDTH

    def test_pressure_grows_with_depth_as_each_liquid_has_it(self):
        for name, (number, density), low, high in (("light", LIGHT, INTERFACE, HEIGHT), ("heavy", HEAVY, 0, INTERFACE)):
            with self.subTest(liquid=name):
                slopes = [self.slope(frame, low, high, frame["liquid"] == number) for frame in self.settled_frames]
                # First order in the spacing: 10 layers of each.
                self.assertAlmostEqual(numpy.mean(slopes) / (density * GRAVITY), 1, delta=0.05)

    def test_the_floor_carries_the_weight_of_both(self):
        self.assertAlmostEqual(self.carried() / WEIGHT, 1, delta=0.02)  # of a mean over the last 0.3 s

    def test_they_stay_where_they_are(self):
        height, liquid = self.settled_frames[-1]["position"][:, 1], self.settled_frames[-1]["liquid"]
        self.assertLess(height[liquid == HEAVY[0]].max(), INTERFACE + SPACING)
        self.assertGreater(height[liquid == LIGHT[0]].min(), INTERFACE - SPACING)
        self.assertLess(self.fastest(), 0.1)  # sqrt(g H) is 2.5 m/s


if __name__ == "__main__":
    tank_at_rest.main(__doc__)
