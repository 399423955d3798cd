#!/usr/bin/env python3
"""Every scene of inputs/ is good, runs, and gives the same answer on any number of ranks, bit for bit when it runs again.

usage: inputs_test.py PROGRAM MPIEXEC SCENE RANKS... (SCENE is the name of a folder of inputs/)
"""
import glob
import os
import sys
import unittest

import harness
from harness import INPUTS, TIGHT, TIGHT_ON_GRID, Workplace

# Coarser and shorter, so that a run has at most 50 steps.
SHORTENED = {
    "blobs": {"domain.spacing": "0.025", "time.end": "0.12"},
    "bunny_drop": {"domain.spacing": "0.02", "time.end": "0.1"},
    "cube_drop": {"domain.spacing": "0.02", "time.end": "0.1"},
    "dam_break": {"domain.spacing": "0.04", "time.end": "0.15"},
    "drop": {"domain.spacing": "0.001", "time.end": "0.03", "method.viscosity.residual": "1e-10"},
    "floating_body": {"domain.spacing": "0.02", "time.end": "0.07"},
    "floating_cube": {"time.end": "0.02"},
    "hanging_ball": {"domain.spacing": "0.02", "time.end": "0.07"},
    "hydrostatic_column": {"time.end": "0.02"},
    "layered_tank": {"time.end": "0.01"},
    "koshizuka_oka": {"domain.spacing": "0.0146", "time.end": "0.08"},
    "martin_moyce": {"domain.spacing": "0.0057", "time.end": "0.04"},
    "neutral_ball": {"domain.spacing": "0.022", "time.end": "0.008", "method.pressure.residual": "1e-7", "method.pressure.max_iterations": "20000"},
    "periodic_tank": {"domain.spacing": "0.02", "time.end": "0.12"},
    "stirrer": {"time.end": "0.05"},
    "water_wheel": {"domain.spacing": "0.025", "time.end": "0.06"},
    "viscous_bunny": {"domain.spacing": "0.02", "time.end": "0.1", "method.viscosity.residual": "1e-10"},
    "viscous_dragon": {"domain.spacing": "0.02", "time.end": "0.1", "method.viscosity.residual": "1e-10"},
    "viscous_film": {"time.end": "0.2", "method.viscosity.residual": "1e-10", "method.pressure.solver": "isph"},
    "coiling": {"domain.spacing": "0.005", "time.end": "0.4", "time.cfl": "0.6", "method.viscosity.residual": "1e-10"},
    "many_viscosities": {"domain.spacing": "0.025", "time.end": "0.04", "method.viscosity.residual": "1e-10"},
    "buckling": {"domain.spacing": "0.005", "time.end": "0.35", "time.cfl": "0.6", "method.viscosity.residual": "1e-10"},
    "two_liquids": {"domain.spacing": "0.05", "time.end": "0.07"},
    "falling_ball": {"domain.spacing": "0.04", "time.end": "0.1"},
    "gravity_current": {"time.end": "0.3"},
    "honey_dipper": {"domain.spacing": "0.01", "time.end": "0.1"},
    "bunny_pool": {"domain.spacing": "0.06", "time.end": "0.2"},
    "dragon_ball": {"domain.spacing": "0.03", "time.end": "0.3"},
    "gears": {"domain.spacing": "0.02", "time.end": "0.03"},
    "perforated_plates": {"domain.spacing": "0.05", "time.end": "0.08"},
    "pile_up": {"domain.spacing": "0.04", "time.end": "0.2"},
    "rotating_drum": {"domain.spacing": "0.05", "time.end": "0.12"},
    "pouring": {"domain.spacing": "0.006", "time.end": "0.4"},
    "smoothie_glass": {"domain.spacing": "0.04", "time.end": "0.06"},
    "cake": {"domain.spacing": "0.01", "time.end": "0.05", "bodies.plate.shape.cylinder.height": "0.024"},
    "dipper": {"domain.spacing": "0.006", "time.end": "0.05"},
    "doughnuts": {"domain.spacing": "0.004", "time.end": "0.06", "time.cfl": "1"},
    "hand": {"domain.spacing": "0.008", "time.end": "0.05"},
    "toothpaste": {"domain.spacing": "0.004", "time.end": "0.45"},  # once it has landed, differences grow tenfold in 0.1 s
}
ON_GRID = {"bunny_pool", "cake", "dipper", "doughnuts", "dragon_ball", "falling_ball", "gears", "gravity_current", "hand", "honey_dipper",
           "perforated_plates", "pile_up", "pouring", "rotating_drum", "smoothie_glass", "toothpaste"}

# Of the spacing, after at most 50 steps: the solver's 1e-10, amplified by the motion.
TOLERANCE = 1e-6

SCENE, RANKS = "", []


def spacing_of(folder):
    """Of effective.yaml, where every value is in SI."""
    with open(os.path.join(folder, "effective.yaml")) as file:
        return next(float(line.split()[1]) for line in file if line.strip().startswith("spacing:"))


class Scene(Workplace):
    def setUp(self):
        super().setUp()
        self.file = os.path.join(INPUTS, SCENE, "scene.yaml")

    def test_the_scene_is_good_and_described(self):
        self.treacle("check", self.file)
        for study in glob.glob(os.path.join(INPUTS, SCENE, "study*.yaml")):
            self.treacle("check", study)
        self.assertTrue(os.path.exists(os.path.join(INPUTS, SCENE, "README.md")))

    def test_the_answer_is_the_same_on_any_number_of_ranks_and_bitwise_when_repeated(self):
        values = {**(TIGHT_ON_GRID if SCENE in ON_GRID else TIGHT), **SHORTENED[SCENE], "output.interval": SHORTENED[SCENE]["time.end"]}
        frames = {}
        for ranks in RANKS:
            self.run_scene(self.file, f"on_{ranks}", ranks, values)
            frames[ranks] = self.frame(f"on_{ranks}")
        self.assertLessEqual(len(self.steps(f"on_{RANKS[0]}")), 50)
        tolerance = TOLERANCE * spacing_of(self.path(f"on_{RANKS[0]}"))
        for ranks in RANKS[1:]:
            with self.subTest(ranks=ranks):
                self.assertLess(self.largest_move(frames[RANKS[0]], frames[ranks]), tolerance)
        self.run_scene(self.file, "again", 2, values)
        again = self.frame("again")
        for name, values in frames[2].items():
            self.assertEqual(values.tobytes() if name != "time" else values,
                             again[name].tobytes() if name != "time" else again[name], name)


class AllScenes(unittest.TestCase):
    def test_every_folder_of_inputs_is_tested(self):
        folders = {name for name in os.listdir(INPUTS) if os.path.isdir(os.path.join(INPUTS, name))}
        self.assertEqual(folders - {"templates"}, set(SHORTENED))  # new_test.py has those


if __name__ == "__main__":
    if len(sys.argv) < 5:
        sys.exit(__doc__)
    SCENE, RANKS = sys.argv[3], [int(word) for word in sys.argv[4:]]
    harness.main(sys.argv[:3] + (["AllScenes"] if SCENE == "all" else ["Scene"]), __doc__)
