#!/usr/bin/env python3
"""Water at rest: pressure grows with depth as rho g, the floor carries the weight, nothing moves.

usage: hydrostatic_test.py PROGRAM MPIEXEC RANKS
"""
import os
import sys
import unittest

import numpy

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "run"))
import harness
from harness import INPUTS, Workplace

RANKS = 2
DENSITY, GRAVITY, WIDTH, HEIGHT, SPACING = 1000.0, 9.81, 0.24, 0.64, 0.02
WEIGHT = DENSITY * GRAVITY * WIDTH * HEIGHT  # [N/m]
# By 0.5 s the start has died away.
SETTLED = 0.5


class HydrostaticColumn(Workplace):
    done = None

    def setUp(self):
        super().setUp()
        if HydrostaticColumn.done is None:
            scene = os.path.join(INPUTS, "hydrostatic_column", "scene.yaml")
            self.run_scene(scene, "run", RANKS, {"time.end": "0.8", "output.interval": "0.01"})
            frames = [self.frame("run", number) for number in range(-31, 0)]
            HydrostaticColumn.done = (frames, self.steps("run"), self.columns("run", "bodies.csv"))
        self.settled_frames, self.history, self.loads = HydrostaticColumn.done

    def slope(self, frame):
        """Of the pressure over the depth, in rho g, where no particle sees a wall or the surface."""
        x, p = frame["position"], frame["pressure"]
        margin = 3 * SPACING
        bulk = ((x[:, 0] > margin) & (x[:, 0] < WIDTH - margin) & (x[:, 1] > margin)
                & (x[:, 1] < x[:, 1].max() - margin))
        self.assertGreater(bulk.sum(), 100)
        return -numpy.polyfit(x[bulk, 1], p[bulk], 1)[0] / (DENSITY * GRAVITY)

    def test_pressure_grows_with_depth_as_rho_g(self):
        # The column breathes a little, by millimetres per second: the mean of 31 frames over 0.3 s.
        mean = numpy.mean([self.slope(frame) for frame in self.settled_frames])
        self.assertAlmostEqual(mean, 1, delta=0.03)  # first order in the spacing: 32 layers

    def test_walls_carry_the_weight(self):
        settled = self.loads["time [s]"] >= SETTLED
        sides = [name for name in self.loads.dtype.names if name.endswith("pressure force y [N/m]")]
        carried = -sum(self.loads[name][settled].mean() for name in sides)
        self.assertAlmostEqual(carried / WEIGHT, 1, delta=0.01)  # of a mean over the last 0.3 s

    def test_nothing_moves(self):
        settled = self.history["time [s]"] >= SETTLED
        self.assertLess(self.history["max speed [m/s]"][settled].max(), 0.05)  # sqrt(g H) is 2.5 m/s


if __name__ == "__main__":
    if len(sys.argv) < 4:
        sys.exit(__doc__)
    RANKS = int(sys.argv.pop(3))
    harness.main(sys.argv, __doc__)
