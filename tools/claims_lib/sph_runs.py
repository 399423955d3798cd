"""Runs behind the rows of `sph`: on 1, 2 and 3 ranks, evaluated however they end, and their energies."""

import contextlib

import numpy

from .run import last_words, run_scene, scratch
from .table import Figure

GRAVITY = 9.81  # [m/s2]
ENDS = {0: "", 5: "still running at its limit"}


@contextlib.contextmanager
def scene_run(context, text, name, *, ranks=2, **options):
    """The RunFolder of a scene, and how the run ended otherwise than well, or "". A run that fails has left its tables and frames
    up to then. text: of the scene, or what makes it for a folder that it may put files into."""
    limit = context.pick("4h", "6min", "1min")
    with scratch(context, name) as folder:
        scene = folder / "scene.yaml"
        scene.write_text(text if isinstance(text, str) else text(folder))
        run = run_scene(context, scene, folder / "run", ranks=ranks, expect=None, arguments=("--wall-limit", limit), **options)
        code = run.finished.code
        yield run, ENDS[code] if code in ENDS else f"exit code {code}: {last_words(run.finished.output, 1)[:120]}"


def judged(run, fault, judge):
    """What judge(run) returns, a text and whether it is right; a run that ended badly is not right, whatever its results."""
    try:
        text, ok = judge(run)
    except Exception as error:
        if not fault:
            raise
        text, ok = f"no figure ({error})", False
    return text + (f", {fault}" if fault else ""), bool(ok) and not fault


def ranks_of(context):
    return context.pick((1, 2, 3), (2,), (2,))


def on_ranks(context, text, name, judge, **options):
    """The figure of a scene on 1, 2 and 3 ranks; with --quick on 2."""
    parts, right = [], True
    for ranks in ranks_of(context):
        with scene_run(context, text, name, ranks=ranks, **options) as (run, fault):
            words, ok = judged(run, fault, judge)
        parts.append(f"{ranks} rank{'s' if ranks > 1 else ''}: {words}")
        right = right and ok
    return Figure("; ".join(parts), right)


def over_cases(context, cases, name, scene, judge, case_text):
    """The figure of many cases, on 1, 2 and 3 ranks in turn: how many are right, and each that is not. scene(case) is as in scene_run,
    judge(run, case) as in judged."""
    short = []
    for number, case in enumerate(cases):
        with scene_run(context, scene(case), name, ranks=1 + number % 3) as (run, fault):
            words, ok = judged(run, fault, lambda run: judge(run, case))
        if not ok:
            short.append(f"{case_text(case)}: {words}")
    return Figure(f"{len(cases) - len(short)} of {len(cases)} right" + "".join(f"; {text}" for text in short), bool(cases) and not short)


def liquid_energy(steps):
    """Kinetic and potential energy of the liquid at each step, [J], in the plane [J/m]."""
    return steps["kinetic energy"] + steps["potential energy"]


def first_energy(run, *, densities=(1,), gravity=GRAVITY, axis=1):
    """The liquid's energy as it was seeded, from the first frame: the first row of steps.csv stands after a step, in which it may
    have grown. densities: of the liquids, in their order; only their ratios count."""
    frame = run.frame(0)
    mass = numpy.asarray(densities, float)[frame["liquid"].astype(int)] if len(densities) > 1 else numpy.ones(len(frame["position"]))
    mass *= run.steps()["mass"][0] / mass.sum()
    return float((mass * (0.5 * (frame["velocity"] ** 2).sum(axis=1) + gravity * frame["position"][:, axis])).sum())


def body_energy(bodies, name, mass, inertia, *, gravity=GRAVITY, axis="z"):
    """Energy of a dynamic body at each step; inertia: about each axis, as a ball or a cube has it [kg m2]."""
    moved = sum(bodies[f"{name} velocity {one}"] ** 2 for one in "xyz")
    turned = sum(bodies[f"{name} angular velocity {one}"] ** 2 for one in "xyz")
    return 0.5 * mass * moved + 0.5 * inertia * turned + mass * gravity * bodies[f"{name} position {axis}"]


def crossings(time, value):
    """Times at which a series passes zero, by linear interpolation."""
    found = []
    for k in range(len(value) - 1):
        if value[k] * value[k + 1] < 0:
            found.append(float(time[k] + (time[k + 1] - time[k]) * value[k] / (value[k] - value[k + 1])))
    return found


def profile(frame, across, along, spacing, places):
    """Velocity component `along` at places (array of positions, components of the frame's axes given by `across`), by a linear fit
    over the particles within 1.5 spacings."""
    x, u = frame["position"][:, across], frame["velocity"][:, along]
    found = []
    for place in places:
        away = x - numpy.asarray(place)
        near = (numpy.abs(away) < 1.5 * spacing).all(axis=1)
        weight = numpy.prod(1 - numpy.abs(away[near]) / (1.5 * spacing), axis=1) ** 0.5
        matrix = numpy.column_stack([numpy.ones(near.sum()), away[near]])
        found.append(numpy.linalg.lstsq(matrix * weight[:, None], u[near] * weight, rcond=None)[0][0] if near.sum() > 4 else numpy.nan)
    return numpy.array(found)
