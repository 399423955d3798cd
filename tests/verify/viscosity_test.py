#!/usr/bin/env python3
"""Flows of a viscous liquid beside walls against their exact solutions.

usage: viscosity_test.py PROGRAM MPIEXEC RANKS
"""
import os
import sys

import numpy

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(HERE, "..", "run"))
import harness
from harness import INPUTS, Workplace

HEIGHT, PULL, SPACING = 1.0, 0.2, 0.02
ranks = 2


def start_up(y, time, viscosity, height):
    """A film of that height on a wall at y = 0, pulled along it from rest (White, Viscous Fluid Flow, 3-4)."""
    steady = PULL / (2 * viscosity) * y * (2 * height - y)
    odd = 2 * numpy.arange(200)[:, None] + 1
    decay = numpy.exp(-(odd * numpy.pi / (2 * height)) ** 2 * viscosity * time)
    waves = 16 * PULL * height ** 2 / (viscosity * (numpy.pi * odd) ** 3) * numpy.sin(odd * numpy.pi * y / (2 * height))
    return steady - (waves * decay).sum(axis=0)


class ViscousFlows(Workplace):
    def velocities(self, name, settings):
        self.run_scene(os.path.join(INPUTS, "viscous_film", "scene.yaml"), name, ranks, settings)
        frame = self.frame(name, -1)
        return frame["position"][:, 1], frame["velocity"][:, 0]

    def assert_follows(self, velocity, exact, share):
        self.assertLess(numpy.abs(velocity - exact).max(), share * exact.max())

    def test_a_film_follows_the_exact_start_up_at_any_viscosity(self):
        # nu dt / d^2 = 10, 1000
        for viscosity, end in ((0.2, 2.0), (20, 0.4)):
            y, u = self.velocities(f"film_{viscosity}", {"liquids.0.viscosity": str(1000 * viscosity), "time.end": str(end),
                                                             "output.interval": str(end)})
            # 50 particles high, the step 2 % of the time and less: seen 0.7 %
            self.assert_follows(u, start_up(y, end, viscosity, HEIGHT), 0.02)

    def test_a_channel_follows_the_exact_start_up(self):
        end = 0.5
        y, u = self.velocities("channel", {
            "time.end": str(end), "output.interval": str(end), "domain.max": "[0.2, 1.0]",
            "domain.boundaries.y_max.kind": "wall", "domain.boundaries.y_max.slip": "no_slip"})
        # Half a channel is a film, on each of its walls.
        half = numpy.minimum(y, HEIGHT - y)
        self.assert_follows(u, start_up(half, end, 0.2, HEIGHT / 2), 0.02)  # seen 1.1 %


if __name__ == "__main__":
    if len(sys.argv) < 4:
        sys.exit(__doc__)
    ranks = int(sys.argv.pop(3))
    harness.main(sys.argv, __doc__)
