#!/usr/bin/env python3
"""A block of syrup that slumps, by the grid: half of it beside a plane of symmetry as the whole, and from one seed of particles to another.

usage: slump_test.py PROGRAM MPIEXEC
"""
import sys

import numpy

import harness
from harness import Workplace

SLUMP = """schema_version: 1
domain:
  dimensions: 2
  min: [{left}, 0]
  max: [{right}, 0.08]
  spacing: {spacing}
  boundaries: {{x_min: {side}, x_max: open, y_min: {{slip: {slip}}}, y_max: open}}
liquids:
  - {{name: syrup, density: 1000, viscosity: 100 Pa.s, shapes: [{{box: {{min: [{start}, 0], max: [0.04, 0.04]}}}}]}}
method: grid
time: {{end: 0.03}}
output: {{interval: 0.03}}
"""
WHOLE, HALF = {"left": -0.08, "start": -0.04, "side": "open"}, {"left": 0, "start": 0, "side": "{mirror: true}"}


class Slump(Workplace):
    def momentum(self, ranks, **values):
        """Of the liquid downwards, a number for each step [kg/m m/s]."""
        with open(self.path("slump.yaml"), "w") as file:
            file.write(SLUMP.format(**{"right": 0.08, **values}))
        self.run_scene(self.path("slump.yaml"), "run", ranks, {}, extra=["--overwrite"])
        return -self.columns("run", "steps.csv")["momentum y [kg/m m/s]"]

    def test_half_of_it_falls_as_the_whole(self):
        # With free slip half of it fell up to 20 % faster with 5 cells, 7 % with 10.
        for slip, spacing, ranks, off in (("free_slip", 0.008, 1, 0.015), ("free_slip", 0.004, 2, 0.015), ("no_slip", 0.008, 2, 0.04)):
            with self.subTest(slip=slip, spacing=spacing):
                whole = self.momentum(ranks, slip=slip, spacing=spacing, **WHOLE)
                half = self.momentum(ranks, slip=slip, spacing=spacing, **HALF)
                self.assertLess(numpy.abs(2 * half / whole - 1).max(), off)

    def test_other_seeds_fall_alike(self):
        # Over a floor that holds, up to 8 % apart: whether a sliver of liquid reached the next face decided what that face held.
        first = self.momentum(1, slip="no_slip", spacing=0.004, **WHOLE)
        for more in (0.008, 0.016, 0.024):
            with self.subTest(wider=more):
                other = self.momentum(1, slip="no_slip", spacing=0.004, **{**WHOLE, "left": -0.08 - more, "right": 0.08 + more})
                self.assertLess(numpy.abs(other / first - 1).max(), 0.025)


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    harness.main(sys.argv, __doc__)
