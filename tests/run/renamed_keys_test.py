#!/usr/bin/env python3
"""Scenes that have keys and words of earlier versions run, with a warning for each, and write the present ones.

usage: renamed_keys_test.py PROGRAM MPIEXEC
"""
import sys

import harness
from harness import Workplace

SCENE = """schema_version: 1
title: A block of paint that falls past a plate
domain: {max: [0.3, 0.3], dimensions: 2, spacing: 0.02}
liquids:
  - name: paint
    density: 1000
    viscosity: 5
    around_bodies: true
    rheology: {law: carreau, exponent: 0.5, relaxation_time: 0.1 s, infinite_viscosity: 0.5}
    shapes: [{box: {min: [0.1, 0], max: [0.2, 0.15]}}]
bodies:
  - {name: plate, shape: {box: {min: [0.12, 0.04], max: [0.18, 0.08]}}}
METHODtime: {end: 4 ms, rule: fixed, step: 2 ms}
output: {interval: 2 ms, checkpoint_interval: 2 ms}
lost_limit: 0.01
"""
METHODS = {"sph": """method:
  kind: sph
  rebalance_above: 1.2
  pressure: {solver: isph, body_coupling: implicit}
  viscosity: {rheology_solves: 3, rheology_residual: 0.02, checkerboard_damping: 0.9, body_coupling: explicit}
""", "grid": """method:
  kind: grid
  grid:
    rebalance_above: 1.2
    pressure: {least_distance: 1e-3, least_opening: 0.02}
    viscosity: {least_wet: 2e-3, least_gap: 0.02, normal_layer: 0.03}
    correction: {slack: 0.06, softness: 0.02}
    contraction: {steps: 20, slack: 0.04}
"""}
# Places in the file, and what is said of them.
COMMON = ["8: liquids.paint.around_bodies is now subtract_bodies",
          "9: liquids.paint.rheology.infinite_viscosity is now infinite_shear_viscosity"]
SAID = {"sph": ["15: method.rebalance_above is now max_load_imbalance",
                "16: method.pressure.body_coupling is now coupling",
                "16: method.pressure.coupling: implicit is now strong",
                "17: method.viscosity.rheology_solves is now max_picard_iterations",
                "17: method.viscosity.rheology_residual is now picard_residual",
                "17: method.viscosity.checkerboard_damping is now hourglass_coefficient",
                "17: method.viscosity.body_coupling is now coupling",
                "17: method.viscosity.coupling: explicit is now weak",
                "20: lost_limit is now max_lost_fraction"],
        "grid": ["16: method.grid.rebalance_above is now max_load_imbalance",
                 "17: method.grid.pressure.least_distance is now min_theta",
                 "17: method.grid.pressure.least_opening is now min_face_area_fraction",
                 "18: method.grid.viscosity.least_wet is now min_liquid_fraction",
                 "18: method.grid.viscosity.least_gap is now min_fluid_fraction",
                 "18: method.grid.viscosity.normal_layer is now no_penetration_layer",
                 "19: method.grid.correction.slack is now dead_band",
                 "19: method.grid.correction.softness is now cfm_epsilon",
                 "20: method.grid.contraction is now density_relaxation",
                 "20: method.grid.density_relaxation.slack is now dead_band",
                 "23: lost_limit is now max_lost_fraction"]}
WRITTEN = {"sph": ["max_picard_iterations: 3", "picard_residual: 0.02", "hourglass_coefficient: 0.9", "coupling: weak"],
           "grid": ["min_theta: 0.001", "min_face_area_fraction: 0.02", "min_liquid_fraction: 0.002", "min_fluid_fraction: 0.02",
                    "no_penetration_layer: 0.03", "dead_band: 0.06", "cfm_epsilon: 0.02", "dead_band: 0.04"]}


class RenamedKeys(Workplace):
    def write(self, kind, more=""):
        with open(self.path("scene.yaml"), "w") as file:
            file.write(SCENE.replace("METHOD", METHODS[kind]) + more)
        return self.path("scene.yaml")

    def test_runs_warn_of_each_and_write_the_present_keys(self):
        for kind in ("sph", "grid"):
            with self.subTest(kind):
                said = self.run_scene(self.write(kind), kind, 2, {}).stdout
                for text in COMMON + SAID[kind]:
                    self.assertIn("warning: " + self.path("scene.yaml") + ":" + text, said)
                with open(self.path(kind, "effective.yaml")) as file:
                    written = file.read()
                for text in WRITTEN[kind] + ["subtract_bodies: true", "infinite_shear_viscosity: 0.5", "max_lost_fraction: 0.01"]:
                    self.assertIn(text, written)
                self.assertNotIn("least_", written)

    def test_check_warns_and_a_run_goes_on_with_an_earlier_key(self):
        scene = self.write("sph")
        self.assertIn("lost_limit is now max_lost_fraction", self.treacle("check", scene).stdout)
        self.run_scene(scene, "run", 1, {"lost_limit": "0.5"})
        self.treacle("resume", "run", "--until", "6 ms", "--set", "lost_limit=0.2")
        with open(self.path("run", "effective.yaml")) as file:
            self.assertIn("max_lost_fraction: 0.2", file.read())

    def test_a_key_by_both_names_is_refused(self):
        done = self.treacle("check", self.write("sph", "max_lost_fraction: 0.02\n"), code=2)
        self.assertIn("scene.yaml:20: lost_limit is now max_lost_fraction, which is given as well", done.stdout + done.stderr)


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    harness.main(sys.argv, __doc__)
