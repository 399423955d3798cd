#!/usr/bin/env python3
"""Walls that slide, and lids as long as a period: the shear flow below them, by both methods, on 1 to 3 ranks.

usage: walls_test.py PROGRAM MPIEXEC
"""
import csv
import os
import sys

import numpy

import harness
from harness import SCENES, TIGHT, TIGHT_ON_GRID, Workplace

SPEED, HEIGHT, LENGTH, VISCOSITY = 0.1, 0.2, 0.2, 100
DRAG = VISCOSITY * SPEED / HEIGHT * LENGTH
# Of a linear profile over 20 spacings.
METHODS = {"grid": (TIGHT_ON_GRID, 0.015, 0.01), "sph": (TIGHT, 0.02, 0.03)}


class Walls(Workplace):
    def loads(self, run):
        with open(self.path(run, "bodies.csv")) as file:
            last = list(csv.DictReader(file))[-1]
        return {name: float(last.get(f"{name} viscous force x [N/m]", "nan")) for name in ("y_min", "y_max", "lid")}

    def check_shear(self, scene, mover):
        for method, (tight, profile, drag) in METHODS.items():
            speeds = {}
            for ranks in (1, 2, 3):
                with self.subTest(scene=scene, method=method, ranks=ranks):
                    run = f"{method}{ranks}"
                    self.run_scene(os.path.join(SCENES, scene), run, ranks, {"method.kind": method, **tight})
                    frame = self.frame(run)
                    speeds[ranks] = frame["velocity"][:, 0]
                    error = speeds[ranks] - SPEED * frame["position"][:, 1] / HEIGHT
                    self.assertLess(numpy.abs(error).max(), profile * SPEED)
                    loads = self.loads(run)
                    self.assertAlmostEqual(loads[mover], -DRAG, delta=drag * DRAG)
                    self.assertAlmostEqual(loads["y_min"], DRAG, delta=drag * DRAG)
                    numpy.testing.assert_allclose(speeds[ranks], speeds[1], rtol=0, atol=1e-6 * SPEED)

    def test_a_wall_slides(self):
        self.check_shear("sliding_wall.yaml", "y_max")

    def test_a_lid_as_long_as_the_period_slides(self):
        self.check_shear("sliding_lid.yaml", "lid")

    def test_a_wall_slides_on_after_a_checkpoint(self):
        scene = os.path.join(SCENES, "sliding_wall.yaml")
        for method, (tight, _, _) in METHODS.items():
            with self.subTest(method=method):
                values = {"method.kind": method, "time.end": "0.2", "output.interval": "0.2", **tight}
                self.run_scene(scene, method, 2, values)
                self.run_scene(scene, method + "_cut", 2, values, code=5, extra=["--wall-limit", "1 us"])
                self.treacle("resume", method + "_cut", ranks=2)
                whole, cut = self.frame(method), self.frame(method + "_cut")
                numpy.testing.assert_allclose(cut["velocity"], whole["velocity"], rtol=0, atol=1e-9 * SPEED)


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    harness.main(sys.argv, __doc__)
