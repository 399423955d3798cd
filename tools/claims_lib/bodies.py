"""Rows of `pressure` on bodies that move: they float as Archimedes has it, and momentum stays."""

import numpy

from .gtest import gtest_on_ranks
from .run import run_scene, scratch
from .table import Figure

DENSITY = 1000.0
CUBE_EDGE, CUBE_RATIO = 0.2, 0.5        # inputs/floating_cube
TANK_AREA = 0.44 * 0.44                 # of both scenes [m2]
BALL_DIAMETER, DRIFT_TIME = 0.16, 5.0   # inputs/neutral_ball
SETTLED = 0.75                          # [s]


def immersed_depth(run):
    """Mean depth of the cube's floor below the level that the volume of the water gives [m]."""
    bodies, steps = run.bodies(), run.steps()
    late = bodies["time"] > SETTLED
    floor = float(bodies["cube position z"][late].mean()) - CUBE_EDGE / 2
    water = steps["mass"][0] / DENSITY
    # water + area (level - floor) = tank area * level
    level = (water - CUBE_EDGE**2 * floor) / (TANK_AREA - CUBE_EDGE**2)
    return level - floor


def archimedes(context):
    inputs = context.root / "inputs"
    with scratch(context, "floating_cube") as folder:
        run = run_scene(context, inputs / "floating_cube/scene.yaml", folder / "run", set={"output.interval": 0})
        depth = immersed_depth(run) / (CUBE_RATIO * CUBE_EDGE)
    seconds = 2.0 if context.quick else DRIFT_TIME
    with scratch(context, "neutral_ball") as folder:
        run = run_scene(context, inputs / "neutral_ball/scene.yaml", folder / "run",
                        set={"time.end": seconds, "output.interval": 0})
        bodies = run.bodies()
        path = numpy.array([bodies[f"ball position {axis}"] for axis in "xyz"])
        drift = float(numpy.linalg.norm(path - path[:, :1], axis=0).max()) / BALL_DIAMETER
    ok = abs(depth - 1) <= 0.03 and drift < 0.2
    return Figure(f"cube {100 * (depth - 1):+.1f} % of its depth (mean after {SETTLED} s); "
                  f"ball at most {drift:.3f} diameters away in {seconds:g} s", ok)


def two_way_momentum(context):
    """On 1, 2, 3 and 4 ranks, a light, a neutral and a heavy body: the tests hold the sums to 1e-12."""
    names = "Bodies.KeepTheMomentumOfLiquidAndBodyTogether:Momentum.LiquidAndBodiesExchangeEqualForcesAndTorques"
    return gtest_on_ranks(context, "sph_ranks_test", names, at_least=2)


def add_rows(table):
    table.row("Archimedes", claim="a cube of half the density and a ball of the liquid's float as they should",
              asked="depth ± 3 %; the ball drifts < 0.2 diameters in 5 s")(archimedes)
    table.row("two-way momentum", claim="linear and angular momentum of liquid and bodies together stay",
              asked="1e-12")(two_way_momentum)
