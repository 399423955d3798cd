#!/usr/bin/env python3
"""SPH with `recovery: positions`: slabs that meet a floor, and liquid that meets liquid, lose energy and never gain it, on 1 to 3 ranks.

usage: impact_test.py PROGRAM MPIEXEC
"""
import sys

import harness
from harness import Workplace

SCENE = """schema_version: 1
domain: {dimensions: 2, min: [0, 0], max: [0.5, 0.4], spacing: SPACING}
liquids:
  - {name: slab, density: 1000, viscosity: VISCOSITY, shapes: [{box: {min: [0, BOTTOM], max: [0.5, TOP]}}], velocity: [0, -SPEED]}
POOL
method: {kind: sph, pressure: {solver: iisph_cg, recovery: positions}}
time: {end: 0.1 s}
output: {interval: 0.1 s}
"""
POOL = "  - {name: pool, density: 1000, viscosity: VISCOSITY, shapes: [{box: {min: [0, 0], max: [0.5, 0.1]}}]}"
# Speed [m/s], viscosity, spacing, whether there is liquid on the floor, ranks.
CASES = [(0.5, "1 mPa.s", "1 cm", False, 1), (2, "1 mPa.s", "1 cm", False, 2), (10, "0 Pa.s", "1 cm", False, 3), (2, "1 mPa.s", "7 mm", False, 1),
         (2, "1000 Pa.s", "1 cm", False, 1), (3, "1 mPa.s", "1 cm", True, 2)]


class Impacts(Workplace):
    def energies(self, run):
        steps = self.steps(run)
        return steps["kinetic energy [J/m]"] + steps["potential energy [J/m]"]

    def test_no_impact_gains_energy(self):
        for number, (speed, viscosity, spacing, pool, ranks) in enumerate(CASES):
            with self.subTest(speed=speed, viscosity=viscosity, spacing=spacing, pool=pool, ranks=ranks):
                bottom = 0.15 if pool else 0.05
                words = {"POOL": POOL if pool else "", "SPACING": spacing, "VISCOSITY": viscosity, "BOTTOM": bottom, "TOP": bottom + 0.15, "SPEED": speed}
                text = SCENE
                for word, value in words.items():
                    text = text.replace(word, str(value))
                with open(self.path("impact.yaml"), "w") as file:
                    file.write(text)
                run = f"run{number}"
                self.run_scene(self.path("impact.yaml"), run, ranks, {})
                energies = self.energies(run)
                self.assertLessEqual(max(energies), energies[0] * (1 + 1e-4))
                # Of the liquid at rest. No rebound: of what it came with, splashes have 2 % at most.
                rest = 9.81 * (75 * 0.175 + 50 * 0.05) if pool else 9.81 * 75 * 0.075
                self.assertLess(energies[-1], 1.02 * rest + 0.02 * (energies[0] - rest))


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    harness.main(sys.argv, __doc__)
