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


def thick_film(end=0.4, **settings):
    """A film that is steady within the run: 20 m2/s, nu dt / d^2 = 1000."""
    return {"liquids.0.viscosity": "2e4", "time.end": str(end), "output.interval": str(end),
            **{key.replace("__", "."): str(value) for key, value in settings.items()}}


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
            # 50 particles high, the step 2 % of the time and less: seen 0.3 %
            self.assert_follows(u, start_up(y, end, viscosity, HEIGHT), 0.02)

    def test_a_channel_follows_the_exact_start_up_and_stays_so_when_it_has_slid(self):
        for end, faster in ((0.5, 1), (3.0, 5)):  # in the end its middle has slid by 90 spacings
            y, u = self.velocities(f"channel_{end}", {
                "time.end": str(end), "output.interval": str(end), "domain.max": "[0.2, 1.0]",
                "domain.gravity": f"[{faster * PULL}, 0]",
                "domain.boundaries.y_max.kind": "wall", "domain.boundaries.y_max.slip": "no_slip"})
            # Half a channel is a film, on each of its walls.
            half = numpy.minimum(y, HEIGHT - y)
            self.assert_follows(u, faster * start_up(half, end, 0.2, HEIGHT / 2), 0.02)  # seen 1.2 and 0.7 %

    def test_a_film_slips_as_far_as_its_slip_length_says(self):
        for ratio in (0.5, 5):
            length = ratio * SPACING
            y, u = self.velocities(f"slip_{ratio}", thick_film(
                domain__boundaries__y_min__slip="slip_length", domain__boundaries__y_min__slip_length=length))
            steady = PULL / 20 * (y * HEIGHT - y ** 2 / 2 + length * HEIGHT)
            self.assert_follows(u, steady, 0.01)  # seen 0.2 %

    def test_a_power_law_film_has_its_profile(self):
        # tau = 1000 g (H - y) = K G^n
        for exponent, consistency in ((0.5, 2000), (1.5, 1e5)):
            y, u = self.velocities(f"power_{exponent}", thick_film(
                liquids__0__viscosity=consistency, liquids__0__rheology__law="power_law",
                liquids__0__rheology__exponent=exponent, liquids__0__rheology__min_shear_rate=1e-5))
            power = 1 + 1 / exponent
            steady = (1000 * PULL / consistency) ** (1 / exponent) / power * (HEIGHT ** power - (HEIGHT - y) ** power)
            self.assert_follows(u, steady, 0.02)  # seen 0.3 and 0.1 %

    def test_a_bingham_film_carries_a_plug(self):
        # The upper half is below the yield stress; the regularisation lets it creep by 1/m.
        y, u = self.velocities("bingham", thick_film(
            liquids__0__rheology__law="herschel_bulkley", liquids__0__rheology__yield_stress=100,
            liquids__0__rheology__regularisation_time=20000))
        plug = HEIGHT - 100 / (1000 * PULL)
        below = numpy.minimum(y, plug)
        self.assert_follows(u, 1000 * PULL / 2e4 * (plug * below - below ** 2 / 2), 0.03)  # seen 1.1 %


if __name__ == "__main__":
    if len(sys.argv) < 4:
        sys.exit(__doc__)
    ranks = int(sys.argv.pop(3))
    harness.main(sys.argv, __doc__)
