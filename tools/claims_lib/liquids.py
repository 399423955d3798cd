"""Rows of `pressure` on several liquids in one scene."""

import numpy

from .gtest import gtest_on_ranks
from .run import run_scene, scratch
from .table import Figure

ENERGIES = ("kinetic energy", "potential energy")


def stability(context):
    inputs = context.root / "inputs"
    with scratch(context, "two_liquids") as folder:
        end = {"time.end": 0.8} if context.quick else {}
        run = run_scene(context, inputs / "two_liquids/scene.yaml", folder / "run", set={"output.interval": 0, **end})
        steps = run.steps()
        lost = int(steps["particles"][0] - steps["particles"][-1])
        compression = float(steps["mean compression"].max())
        energy = sum(steps[name] for name in ENERGIES)
        falls = bool(energy[-1] < energy[0]) and bool(energy.max() <= 1.001 * energy[0])
    with scratch(context, "layered_tank") as folder:
        run = run_scene(context, inputs / "layered_tank/scene.yaml", folder / "run",
                        set={"time.end": 2 if context.quick else 8, "output.interval": 0})
        steps = run.steps()
        late = steps["time"] > 1
        speed = float(numpy.mean(steps["max speed"][late]))
    ok = lost == 0 and compression < 0.002 and falls and speed < 0.05
    return Figure(f"collapse: {lost} lost, mean compression at most {100 * compression:.2f} %, energy "
                  f"{'falls' if falls else 'GROWS'}; at rest: largest speed {speed:.3f} m/s, mean after 1 s", ok)


def momentum(context):
    """On 1, 2, 3 and 4 ranks, with solids: the tests hold the sums to 1e-12 and the matrix to its transpose."""
    return gtest_on_ranks(context, "sph_ranks_test", "ImmiscibleLiquids.*", at_least=9)


def add_rows(table):
    table.row("several liquids", claim="two liquids of densities 10 to 1 collapse, and lie on each other at rest",
              asked="none lost, mean compression < 0.2 %, energy falls; at rest < 0.05 m/s")(stability)
    table.row("several liquids, momentum", claim="their matrix is symmetric and positive definite, momentum stays",
              asked="bit for bit; 1e-12")(momentum)
