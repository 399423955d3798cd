#!/usr/bin/env python3
"""Syrup flows out of a slot in a plate, by the grid: as the slot widens through a cell the flow grows with it.

usage: plate_hole_test.py PROGRAM MPIEXEC
"""
import sys

import numpy

import harness
from harness import Workplace

SLOT = """schema_version: 1
domain:
  dimensions: 2
  min: [-0.0625, 0.025]
  max: [0.0625, 0.15]
  spacing: 0.005
  symmetry: [x]
  boundaries: {{y_min: open, y_max: open, x_min: {{slip: no_slip}}, x_max: {{slip: no_slip}}}}
liquids:
  - {{name: syrup, density: 1000, viscosity: 10 Pa.s, subtract_bodies: true, shapes: [{{box: {{min: [-0.05, {bottom}], max: [0.05, 0.14]}}}}]}}
bodies:
  - name: plate
    slip: no_slip
    shape: {{difference: {{from: {{box: {{min: [-0.06, {bottom}], max: [0.06, 0.25]}}}}, subtract: [{{box: {{min: [-0.05, {top}], max: [0.05, 0.3]}}}},
      {{box: {{min: [-{half}, 0], max: [{half}, 0.12]}}}}]}}}}
method: grid
time: {{end: 0.025, step: 5 ms}}
output: {{interval: 0.025}}
"""


class PlateHole(Workplace):
    def momentum(self, half, top, ranks):
        """Of the liquid downwards after 25 ms [kg/m m/s]; lengths in cells."""
        with open(self.path("slot.yaml"), "w") as file:
            file.write(SLOT.format(half=0.005 * half, top=0.005 * top, bottom=0.005 * (top - 2)))
        self.run_scene(self.path("slot.yaml"), "run", ranks, {}, extra=["--overwrite"])
        return -self.columns("run", "steps.csv")["momentum y [kg/m m/s]"][-1]

    def test_its_flow_grows_with_its_width(self):
        # The velocities around the plate's edges were free where its side was beyond the middle of a cell: 25 % more from a slot 3 % wider.
        for top, ranks in ((15.7, 1), (15.9, 2), (15.55, 3)):
            flow = numpy.array([self.momentum(half, top, ranks) for half in (3.45, 3.55, 3.7, 3.9)])
            with self.subTest(top=top):
                self.assertGreater(numpy.diff(flow).min(), 0)
                self.assertLess(flow[1] / flow[0], 1.1)


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    harness.main(sys.argv, __doc__)
