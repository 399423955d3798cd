#!/usr/bin/env python3
"""Water at rest: pressure grows with depth as rho g, the floor carries the weight, nothing moves.

usage: hydrostatic_test.py PROGRAM MPIEXEC RANKS
"""
import numpy

import tank_at_rest
from tank_at_rest import GRAVITY, TankAtRest

DENSITY, WIDTH, HEIGHT = 1000.0, 0.24, 0.64
WEIGHT = DENSITY * GRAVITY * WIDTH * HEIGHT  # [N/m]


class HydrostaticColumn(TankAtRest):
    scene, width = "hydrostatic_column", WIDTH

    def test_pressure_grows_with_depth_as_rho_g(self):
        def slope(frame):
            return self.slope(frame, 0, frame["position"][:, 1].max()) / (DENSITY * GRAVITY)
        # First order in the spacing: 32 layers.
        self.assertAlmostEqual(numpy.mean([slope(frame) for frame in self.settled_frames]), 1, delta=0.03)

    def test_walls_carry_the_weight(self):
        self.assertAlmostEqual(self.carried() / WEIGHT, 1, delta=0.01)  # of a mean over the last 0.3 s

    def test_nothing_moves(self):
        self.assertLess(self.fastest(), 0.05)  # sqrt(g H) is 2.5 m/s


if __name__ == "__main__":
    tank_at_rest.main(__doc__)
