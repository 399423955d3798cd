"""Table 4.1's rows on the viscous bunny, and Figure 4.4: the full form, explicit and implicit."""

import dataclasses

from claims_lib.run import run_scene
from claims_lib.table import CommandFailed

from .costs import FRAME, PHASES
from .entries import entry

SCENE = "inputs/viscous_bunny/scene.yaml"
KEY = "method.viscosity."
EXPLICIT = {KEY + "integration": "explicit", KEY + "form": "as_published"}
# As the dissertation solves it: the assembled matrix, conjugate gradients without a preconditioner but the diagonal, 1e-4.
PRINTED = {KEY + "integration": "implicit", KEY + "form": "as_published", KEY + "assembled": "true",
           KEY + "preconditioner": "jacobi", KEY + "residual": 1e-4}
OURS = {KEY + "integration": "implicit", KEY + "residual": 1e-4}
REFUSED = 2, "above the limit of the explicit viscosity"
FAILED = 3  # exit code: the simulation failed


@dataclasses.dataclass(frozen=True)
class Case:
    figure: str
    method: str
    viscosity: float  # [Pa s]
    step: float       # [s]
    settings: dict
    theirs: tuple     # seconds a frame for the viscosity and in all, None for ours
    quick: int        # steps of a quick run, which starts at a fall's speed right above the floor


CASES = (
    Case("4.3 b", "explicit", 1000, 5e-6, EXPLICIT, (6.3, 51.7), 300),
    Case("4.3 c", "explicit", 1000, 1.3e-3, EXPLICIT, (0.0, 0.5), 1),
    Case("4.3 d", "as published, assembled", 1000, 1.3e-3, PRINTED, (15.0, 15.4), 10),
    Case("4.3 d", "corrected", 1000, 1.3e-3, OURS, (None, None), 60),
    Case("4.3 e", "explicit", 50000, 5e-6, EXPLICIT, (2.9, 40.1), 1),
    Case("4.3 f", "as published, assembled", 50000, 1e-4, PRINTED, (361.4, 366.1), 10),
    Case("4.3 f", "corrected", 50000, 1e-4, OURS, (None, None), 200),
)


def run_case(context, results, case):
    """Its steps, or a word for why there are none."""
    settings = {"liquids.bunny.viscosity": case.viscosity, "time.rule": "fixed", "time.step": case.step, "output.interval": 0,
                **case.settings}
    if context.quick:
        steps = context.pick(None, case.quick, min(case.quick, 2))
        settings |= {"time.end": steps * case.step, "liquids.bunny.velocity": "[0, 0, -1.5]",
                     "liquids.bunny.shapes.0.mesh.translation": "[0.25, 0.2, 0.125]"}
    if context.smallest:
        settings["domain.spacing"] = 0.01
    name = f"{case.figure}-{case.method}".replace(" ", "_").replace(",", "")
    run = run_scene(context, context.root / SCENE, context.scratch / name, ranks=results.ranks, set=settings,
                    arguments=["--overwrite"], expect=None, timeout=48 * 3600)
    if run.finished.code == REFUSED[0] and REFUSED[1] in run.finished.output:
        return None, "refused: above its limit"
    if run.finished.code == FAILED and "viscosity solve" in run.finished.output:
        return None, "conjugate gradients failed"
    if run.finished.code != 0:
        raise CommandFailed(f"exit code {run.finished.code}: {run.finished.output[-500:]}")
    return run.steps(), ""


def seconds_of(steps):
    return sum(steps[phase] for phase in (*PHASES, "viscosity") if phase in steps)


@entry("table-4.1", "Seconds a frame of the full form on the viscous bunny, explicit, as printed and ours", quick=300)
def table_4_1(context, results):
    rows = []
    for case in CASES:
        steps, why = run_case(context, results, case)
        ours = (None, None) if steps is None else tuple(
            float(part.mean()) * FRAME / case.step for part in (steps["viscosity"], seconds_of(steps)))
        iterations = None if steps is None else float(steps["viscosity iterations"].mean())
        rows.append([case.figure, case.method, case.viscosity, case.step, *ours, *case.theirs, iterations, why])
    results.table("table_4.1", ["figure", "method", "viscosity [Pa s]", "step [s]", "viscosity [s/frame]", "total [s/frame]",
                                "viscosity, dissertation [s/frame]", "total, dissertation [s/frame]", "iterations", "note"], rows)


@entry("figure-4.4", "Seconds of a run of the viscous bunny over simulated time, explicit and implicit", quick=200)
def figure_4_4(context, results):
    rows = []
    with results.figure("figure_4.4") as axes:
        for case in (CASES[0], CASES[2], CASES[3]):
            steps, why = run_case(context, results, case)
            if steps is None:
                results.say(f"{case.method}: {why}")
                continue
            spent = seconds_of(steps).cumsum()
            rows += [[case.method, float(time), float(sum_)] for time, sum_ in zip(steps["time"], spent)]
            axes.plot(steps["time"], spent, label=f"{case.method}, {1e3 * case.step:g} ms")
        axes.set(xlabel="simulated time [s]", ylabel="seconds of the run", yscale="log")
        axes.legend(fontsize=8)
    results.curves("figure_4.4", ["method", "time [s]", "seconds [s]"], rows)
