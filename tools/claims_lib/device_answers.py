"""Rows of `device` on answers: the same when repeated, on other numbers of ranks, on threads."""

import numpy

from . import grid_bodies, identity
from .device_steps import ASSEMBLED, CHEBYSHEV, SCENES, input_of, run_program, settings_of, threaded_program
from .house_results import Difference, compare_frames, compare_steps
from .run import built, run_scene, scratch
from .table import Figure
from .viscous_solve import STEP, run_cube, stiff_cube

RANKS, QUICK_RANKS = (1, 2, 3, 4, 8), (1, 2, 4)
# Of the rows on ranks of `ground`, `viscosity` and `grid`.
MOVE, ROLES = 1e-6, 1e-5  # largest distance [spacings], share of particles with another role
VELOCITY = 1e-7           # of the largest velocity
HONEY_MOVE = 1e-6         # [m]


def ranks_of(context):
    return QUICK_RANKS if context.quick else RANKS


def repeated(context):
    """Each of the four scenes twice on 2 ranks; frames and steps are compared byte for byte."""
    parts, frames, steps = [], 0, 0
    with scratch(context, "repeated") as folder:
        for scene in SCENES:
            settings = settings_of(context, scene)
            settings = {**settings, "output.interval": settings["time.end"], "output.double_precision": "true"}
            pair = [run_program(context, built(context, "treacle"), input_of(context, scene), folder / f"{scene.name}_{name}", settings, ranks=2)
                    for name in "ab"]
            difference = Difference()
            compare_frames(difference, *pair)
            compare_steps(difference, *pair)
            frames, steps = frames + difference.frames, steps + difference.steps
            parts += [f"{scene.name}: {text}" for text in difference.found]
    return Figure(f"{len(SCENES)} scenes twice on 2 ranks, {frames} frames, {steps} steps: {'; '.join(parts) or 'the same bit for bit'}",
                  not parts and frames > 0 and steps > 0)


def dam_break(context, name, settings):
    """Largest move beside one rank [spacings], and roles that differ."""
    with scratch(context, "dam_break") as folder:
        frames = {ranks: run_scene(context, context.root / "inputs/dam_break/scene.yaml", folder / str(ranks), ranks=ranks,
                                   set=identity.overrides(context, **settings)).frame() for ranks in ranks_of(context)}
    others = [frame for ranks, frame in frames.items() if ranks > 1]
    moved = max(identity.largest_move(frames[1], frame) for frame in others) / identity.spacing(context)
    roles = max(identity.differing_roles(frames[1], frame) for frame in others)
    return (f"dam break, {name}: {moved:.1e} d, {roles} roles",
            moved <= MOVE and roles <= max(1, ROLES * len(frames[1]["id"])))


def viscous_cube(context):
    """As in the row on ranks of `viscosity`."""
    settings = {"method.viscosity.residual": 1e-10, "method.pressure.stop": "residual", "method.pressure.residual": 1e-10,
                "output.interval": 2 * STEP, "output.double_precision": "true"}
    with scratch(context, "cube") as folder:
        frames = [run_cube(context, stiff_cube(20, 100), folder / str(ranks), ranks=ranks, set=settings).frame(-1)
                  for ranks in ranks_of(context)]
    scale = numpy.abs(frames[0]["velocity"]).max()
    apart = max(float(numpy.abs(frame["velocity"] - frames[0]["velocity"]).max() / scale) for frame in frames[1:])
    return f"viscous cube: {apart:.1e} of the largest velocity", apart < VELOCITY


def honey(context):
    """As in the row on ranks of `grid`; shorter with --quick."""
    more = {"time.end": 0.1, "output.interval": 0.1} if context.quick else {}
    with scratch(context, "honey") as folder:
        frames = [grid_bodies.dipped(context, folder, str(ranks), ranks, **more).frame(-1) for ranks in ranks_of(context)]
    apart = max(grid_bodies.apart(frames[0], frame) for frame in frames[1:])
    return f"honey dipper: {apart:.1e} m", apart < HONEY_MOVE


def on_ranks(context):
    found = [dam_break(context, "Chebyshev", CHEBYSHEV), dam_break(context, "sweeps", ASSEMBLED), viscous_cube(context), honey(context)]
    return Figure(f"{', '.join(map(str, ranks_of(context)[1:]))} ranks against 1, the most: " + "; ".join(text for text, _ in found),
                  all(ok for _, ok in found))


def on_threads(context):
    """A run of the witness' program on 1, 2 and 4 threads, one rank."""
    program, frames = threaded_program(context), {}
    with scratch(context, "threads") as folder:
        for threads in (1, 2, 4):
            settings = identity.overrides(context, **CHEBYSHEV)
            frames[threads] = run_program(context, program, context.root / "inputs/dam_break/scene.yaml", folder / str(threads), settings,
                                          env={"OMP_NUM_THREADS": str(threads)}).frame()
    moves = {threads: identity.largest_move(frames[1], frame) / identity.spacing(context) for threads, frame in frames.items() if threads > 1}
    roles = max(identity.differing_roles(frames[1], frame) for frame in frames.values())
    return Figure("against 1 thread: " + ", ".join(f"{threads} threads {move:.1e} d" for threads, move in moves.items()) + f", {roles} roles",
                  max(moves.values()) <= MOVE and roles <= max(1, ROLES * len(frames[1]["id"])))


def add_rows(table):
    table.row("same answers, repeated", claim="dam break, viscous bunny, honey dipper, gears", asked="bit for bit")(repeated)
    table.row("same answers, ranks", claim="1 to 8 ranks: dam break with Chebyshev and with sweeps, viscous cube, honey dipper",
              asked="1e-6 d, 1e-7 of the largest velocity, 1e-6 m")(on_ranks)
    table.row("same answers, threads", claim="dam break on 1, 2 and 4 threads", asked="1e-6 d")(on_threads)
