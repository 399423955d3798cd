"""Rows of `repairs` on the grid's solves: systems without rows, jumps of viscosity, walls."""

import itertools
import random

from .gtest import gtest_on_ranks
from .run import run_scene, scratch
from .table import Figure

INLET = """
schema_version: 1
title: A plane inlet into air
domain:
  dimensions: 2
  min: [-16 mm, -4 mm]
  max: [16 mm, 128 mm]
  spacing: 2 mm
  boundaries: {{x_min: open, x_max: open, y_min: open, y_max: open}}
liquids: [{{name: syrup, density: 1000, viscosity: {viscosity}}}]
inlets:
  - {{disc: {{centre: [0, 0.12], direction: [0, -1], radius: 10 mm}}, velocity: {speed} m/s}}
method: {{kind: grid, grid: {{stokes: {{solve: {solve}}}}}}}
time: {{end: 0.1, cfl: {cfl}}}
output: {{interval: 0}}
"""


def sampled(context, cases, quick):
    """All cases, or a seeded sample of them."""
    cases = list(cases)
    return random.Random(27).sample(cases, quick) if context.quick else cases


def empty_systems(context):
    solve = gtest_on_ranks(context, "solve_test", "EmptySystems.*", at_least=8)
    steps = gtest_on_ranks(context, "grid_step_test", "EmptySteps.*", at_least=4)
    return Figure(f"solve layer {solve.measured}; steps {steps.measured}", solve.ok and steps.ok)


def plane_inlet(context):
    cases = sampled(context, itertools.product((0.001, 1, 60, 1e5), (0.05, 0.2, 1), (0.3, 1, 3),
                                               ("automatic", "split", "together"), (1, 2, 3)), 8)
    short = []
    for viscosity, speed, cfl, solve, ranks in cases:
        with scratch(context, "inlet") as folder:
            scene = folder / "scene.yaml"
            scene.write_text(INLET.format(viscosity=viscosity, speed=speed, cfl=cfl, solve=solve))
            steps = run_scene(context, scene, folder / "run", ranks=ranks).steps()
        # Two layers a cell, twenty particles wide.
        wanted = 20 * speed * 0.1 / 0.001
        particles = steps["particles"][-1] + steps["flowed out"][-1]
        if abs(particles - wanted) > 40:
            short.append(f"{viscosity:g} Pa s, {speed} m/s, cfl {cfl}, {solve}, {ranks} ranks: {particles:g} of {wanted:g}")
    return Figure(f"{len(cases) - len(short)} of {len(cases)} jets" + "".join(f"; {text}" for text in short), not short)


def add_rows(table):
    table.row("empty systems", claim="no liquid, no pressure row, no stress, on one rank or on all, every preconditioner, "
              "1 to 4 ranks", asked="steps go on")(empty_systems)
    table.row("plane inlet", claim="a jet into air, 1e-3 to 1e5 Pa s, 0.05 to 1 m/s, cfl 0.3 to 3, 1 to 3 ranks",
              asked="all that the inlet gives, within two layers")(plane_inlet)
