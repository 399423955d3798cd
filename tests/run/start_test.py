#!/usr/bin/env python3
"""Liquids start with the motion that the scene states, and shapes made of shapes hold liquid back, with both methods.

usage: start_test.py PROGRAM MPIEXEC
"""
import os
import shutil
import sys

import numpy

import harness
from harness import Workplace

SPINNING = """schema_version: 1
title: A drop that starts with a spin and a shear
domain: {{{domain}, spacing: 0.05, gravity: {gravity}}}
liquids:
  - name: syrup
    density: 1000
    viscosity: 1
    shapes: [{{sphere: {{centre: {centre}, radius: 0.3}}}}]
    velocity: {velocity}
    angular_velocity: {spin}
    velocity_gradient: {{x: {row}}}
method: {{kind: {kind}}}
time: {{end: 20 ms, rule: fixed, step: 2 ms}}
output: {{interval: 20 ms, checkpoint_interval: 10 ms, checkpoints_kept: 4, double_precision: true}}
"""
PLANE = {"domain": "dimensions: 2, max: [1, 1]", "gravity": "[0, 0]", "centre": "[0.5, 0.5]", "velocity": "[0.1, 0.2]",
         "spin": "[0, 0, 3]", "row": "[0, 0.5]"}
SPACE = {"domain": "max: [1, 1, 1]", "gravity": "[0, 0, 0]", "centre": "[0.5, 0.5, 0.5]", "velocity": "[0.1, 0.2, 0]",
         "spin": "[1, 2, 3]", "row": "[0, 0.5, 0]"}

# Plugged, the bore in the floor of the pot holds back; open, what stands above it falls through.
POT = """schema_version: 1
title: A pot with a hole
domain: {{max: [0.4, 0.4, 0.6], spacing: 0.02}}
liquids:
  - {{name: water, density: 1000, shapes: [{{box: {{min: [0.1, 0.1, 0.3], max: [0.3, 0.3, 0.4]}}}}]}}
bodies:
  - name: pot
    shape:
      difference:
        from: {{box: {{min: [0.04, 0.04, 0.24], max: [0.36, 0.36, 0.5]}}}}
        subtract:
          - box: {{min: [0.1, 0.1, 0.3], max: [0.3, 0.3, 0.5]}}
          - {{cylinder: {{centre: [0.2, 0.2, {bore}], axis: [0, 0, 1], radius: 0.06, height: 0.06}}}}
method: {{kind: {kind}}}
time: {{end: 0.2}}
output: {{interval: 0.2}}
"""

QUARTER = """schema_version: 1
title: A quarter of a ball in a corner between free-slip walls, and one of a body
domain: {{max: [0.5, 0.5, 0.5], spacing: 0.025}}
liquids:
  - {{name: water, density: 1000, shapes: [{{sphere: {{centre: [0, 0, 0.25], radius: 0.2, clip: true}}}}]}}
bodies:
  - {{name: buoy, kind: dynamic, density: 500, shape: {{cylinder: {{centre: [0.5, 0.5, 0.3], axis: [0, 0, 1], radius: 0.2, height: 0.2, clip: true}}}}}}
method: {{kind: {kind}}}
time: {{end: 20 ms}}
output: {{interval: 20 ms}}
"""


class Start(Workplace):
    def write(self, text):
        with open(self.path("scene.yaml"), "w") as file:
            file.write(text)
        return self.path("scene.yaml")

    def test_a_spin_is_there_in_the_first_frame_and_after_a_resumption(self):
        for kind in ("sph", "grid"):
            for name, words in (("plane", PLANE), ("space", SPACE)):
                run = f"{kind}_{name}"
                scene = self.write(SPINNING.format(kind=kind, **words))
                self.run_scene(scene, run, 2, {})
                first = self.frame(run, 0)
                vector = lambda key: numpy.array([float(x) for x in words[key].strip("[]").split(",")] + [0] * (3 - words[key].count(",") - 1))
                arm = first["position"] - vector("centre")
                gradient = numpy.zeros((3, 3))
                gradient[0] = vector("row")
                right = vector("velocity") + numpy.cross(vector("spin"), arm) + arm @ gradient.T
                numpy.testing.assert_allclose(first["velocity"], right, atol=1e-12, err_msg=run)
                # Angular momentum about z is kept but for the shear's part, which viscosity stretches: within 1 %.
                last = self.frame(run)
                turn = [numpy.cross(f["position"] - f["position"].mean(0), f["velocity"]).sum(0)[2] for f in (first, last)]
                self.assertLess(abs(turn[1] / turn[0] - 1), 0.01, run)
                shutil.copytree(self.path(run), self.path("straight"))
                os.remove(self.checkpoints(run)[-1])
                self.treacle("resume", run, ranks=2)
                self.assertLess(self.largest_move(self.frame("straight"), self.frame(run)), 1e-12)
                shutil.rmtree(self.path("straight"))

    def test_a_bore_lets_liquid_through_and_a_pot_without_one_holds_it(self):
        for kind in ("sph", "grid"):
            for bore, name in ((0.27, "open"), (0.1, "whole")):
                run = f"{kind}_{name}"
                self.run_scene(self.write(POT.format(kind=kind, bore=bore)), run, 2, {})
                below = (self.frame(run)["position"][:, 2] < 0.23).mean()
                if name == "open":
                    self.assertGreater(below, 0.05, run)
                else:
                    self.assertEqual(below, 0, run)

    def test_clip_cuts_at_the_domain_and_says_how_much(self):
        for kind in ("sph", "grid"):
            scene = self.write(QUARTER.format(kind=kind))
            said = self.treacle("check", scene).stdout
            self.assertIn("liquids.water is cut at the domain (clip)", said)
            self.assertIn("75 % of its 0.03351 m3 are cut off", said)
            self.assertNotIn("thinner than the spacing", said)
            self.assertIn("bodies.buoy is cut at the domain (clip)", said)
            self.run_scene(scene, f"quarter_{kind}", 2, {})


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    harness.main(sys.argv, __doc__)
