"""Table 3.1, table 2.6 and figure 2.10: pressure solvers in runs of the same dam break."""

import dataclasses

from claims_lib.iisph import DENSITY_ERROR, OURS, SOLVERS, START, dam_break
from claims_lib.run import run_scene

from .entries import entry

FRAME = 16.64e-3  # of the dissertation's tables, at 60 frames a second [s]
PHASES = ("sort", "neighbours", "density", "forces", *OURS, "pressure force", "move")

# Iterations, seconds of the pressure solve and in total, a frame: by time step [s].
DISSERTATION_3_1 = {
    2.08e-3: {"iisph jacobi": (13.15, 45.97, 62.56), "multilevel": (15.71, 34.97, 51.33)},
    4.16e-3: {"iisph jacobi": (30.66, 53.80, 62.23), "multilevel": (12.63, 15.33, 23.70)},
    8.32e-3: {"iisph jacobi": (80.46, 73.43, 78.01), "multilevel": (12.22, 7.31, 11.88)},
}
DISSERTATION_2_6 = {0.2e-3: (0.99, 12.27, 24.93), 1.6e-3: (6.69, 2.96, 4.69)}
DISSERTATION_2_10 = {"iisph jacobi": 86.73, "isph jacobi cg": 22.95}  # [s]


@dataclasses.dataclass(frozen=True)
class Cost:
    """Of a run, without its first frame, whose pressures come from nothing."""

    iterations: float  # mean of a step
    pressure: float    # seconds of the pressure solve with all that only it needs, a frame
    total: float       # seconds, a frame


def run(context, results, folder, scene, solver, settings=None):
    name = solver.replace(" ", "_")
    return run_scene(context, scene, folder / name, ranks=results.ranks, timeout=24 * 3600,
                     set={"method.pressure.density_error": DENSITY_ERROR, **SOLVERS[solver], **(settings or {})})


def cost_of(finished):
    steps = finished.steps()
    late = steps["time"] > START
    frames = (steps["time"][late][-1] - START) / FRAME
    phases = [name for name in steps.names() if name in PHASES]
    pressure = sum(steps[phase][late] for phase in OURS)
    total = sum(steps[phase][late] for phase in phases)
    return Cost(float(steps["pressure iterations"][late].mean()), float(pressure.sum() / frames),
                float(total.sum() / frames))


@entry("table-3.1", "Iterations and seconds a frame with different time steps, IISPH beside ours")
def table_3_1(context, results):
    rows = []
    for step, printed in DISSERTATION_3_1.items():
        with dam_break(context, step) as (particles, folder, scene):
            for solver in SOLVERS:
                found = cost_of(run(context, results, folder, scene, solver))
                rows.append([1e3 * step, solver, particles, found.iterations, found.pressure, found.total,
                             *printed.get(solver, (None, None, None))])
    results.table("table-3.1", ["step [ms]", "solver", "particles", "iterations", "pressure [s/frame]",
                                "total [s/frame]", "theirs: iterations", "theirs: pressure [s/frame]",
                                "theirs: total [s/frame]"], rows)
    with results.figure("table-3.1", columns=2) as (left, right):
        for solver in SOLVERS:
            of = [row for row in rows if row[1] == solver]
            left.plot([row[0] for row in of], [row[3] for row in of], "o-", label=solver)
            right.plot([row[0] for row in of], [row[4] for row in of], "o-", label=solver)
        for solver in ("multilevel", "iisph jacobi"):
            printed = {1e3 * step: values[solver] for step, values in DISSERTATION_3_1.items()}
            left.plot(list(printed), [value[0] for value in printed.values()], "x:", label=f"dissertation, {solver}")
        left.set(xlabel="step [ms]", ylabel="iterations", xscale="log", yscale="log")
        right.set(xlabel="step [ms]", ylabel="pressure solve [s a frame]", xscale="log", yscale="log")
        left.legend(fontsize=7)


@entry("table-2.6", "Iterations and seconds a frame of the hybrid method with a small and a large time step")
def table_2_6(context, results):
    rows = []
    for step, printed in DISSERTATION_2_6.items():
        with dam_break(context, step, particles=27_000 if context.quick else 125_000, end=2 * FRAME,
                       spacing=18e-3) as (particles, folder, scene):
            for name, settings in (("multilevel", {}), ("isph jacobi cg", {"method.pressure.largest_residual": 1})):
                found = cost_of(run(context, results, folder, scene, name, settings))
                rows.append([1e3 * step, name, particles, found.iterations, found.pressure, found.total,
                             *(printed if name == "isph jacobi cg" else (None, None, None))])
    results.table("table-2.6", ["step [ms]", "solver", "particles", "iterations", "pressure [s/frame]",
                                "total [s/frame]", "theirs: iterations", "theirs: pressure [s/frame]",
                                "theirs: total [s/frame]"], rows)
    with results.figure("table-2.6") as axes:
        for name in ("multilevel", "isph jacobi cg"):
            of = [row for row in rows if row[1] == name]
            axes.plot([row[0] for row in of], [row[3] for row in of], "o-", label=name)
        axes.plot([1e3 * step for step in DISSERTATION_2_6], [line[0] for line in DISSERTATION_2_6.values()], "x:",
                  label="dissertation, CG")
        axes.set(xlabel="step [ms]", ylabel="iterations", xscale="log", yscale="log")
        axes.legend(fontsize=8)


@entry("figure-2.10", "Seconds of the pressure solve over a dam break, IISPH beside ours")
def figure_2_10(context, results):
    end = 0.4 if context.quick else 1.0
    solvers = ("iisph jacobi", "isph jacobi cg", "multilevel")
    curves, rows = [], []
    with dam_break(context, 2e-3, particles=13_000 if context.quick else 125_000, end=end,
                   spacing=18e-3) as (particles, folder, scene):
        for solver in solvers:
            steps = run(context, results, folder, scene, solver).steps()
            seconds = sum(steps[phase] for phase in OURS)
            curves += [[solver, time, spent] for time, spent in zip(steps["time"], seconds.cumsum())]
            rows.append([solver, particles, float(seconds.sum()), DISSERTATION_2_10.get(solver)])
    for row in rows:
        row += [row[2] / rows[1][2], row[3] / DISSERTATION_2_10["isph jacobi cg"] if row[3] else None]
    results.curves("curves", ["solver", "time [s]", "pressure solve until then [s]"], curves)
    results.table("figure-2.10", ["solver", "particles", "pressure [s]", "theirs: pressure [s]", "over ISPH with CG",
                                  "theirs: over ISPH with CG"], rows)
    with results.figure("figure-2.10") as axes:
        for solver in solvers:
            axes.plot(*zip(*[point[1:] for point in curves if point[0] == solver]), label=solver)
        axes.set(xlabel="time [s]", ylabel="pressure solve until then [s]", yscale="log")
        axes.legend(fontsize=8)
