"""Tables 3.1 and 2.6, figures 2.9 and 2.10: pressure solvers in runs of the same dam break."""

import dataclasses

from claims_lib.iisph import DENSITY_ERROR, SOLVERS, START, dam_break
from claims_lib.run import read_frame, run_scene

from .costs import FRAME, pressure_seconds, total_seconds
from .entries import entry
from .pictures import drawn

# Iterations, seconds of the pressure solve and in total, a frame: by time step [s].
DISSERTATION_3_1 = {
    2.08e-3: {"iisph jacobi": (13.15, 45.97, 62.56), "multilevel": (15.71, 34.97, 51.33)},
    4.16e-3: {"iisph jacobi": (30.66, 53.80, 62.23), "multilevel": (12.63, 15.33, 23.70)},
    8.32e-3: {"iisph jacobi": (80.46, 73.43, 78.01), "multilevel": (12.22, 7.31, 11.88)},
}
DISSERTATION_2_6 = {0.2e-3: {"isph jacobi cg": (0.99, 12.27, 24.93)}, 1.6e-3: {"isph jacobi cg": (6.69, 2.96, 4.69)}}
DISSERTATION_2_10 = {"iisph jacobi": 86.73, "isph jacobi cg": 22.95}  # [s]
SPACING_2_9 = 18e-3  # [m]
STEP_2_9 = 1e-3      # with larger ones particles go through walls at that spacing [s]


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
    return Cost(float(steps["pressure iterations"][late].mean()), float(pressure_seconds(steps)[late].sum() / frames),
                float(total_seconds(steps)[late].sum() / frames))


def compare_steps(context, results, name, printed, solvers, settings=None, **scene_options):
    """Costs of solvers by the time step, beside theirs. settings: {solver: {key: value}}, scene_options: of dam_break."""
    rows = []
    for step, theirs in list(printed.items())[context.pick(0, 0, -1):]:
        with dam_break(context, step, **scene_options) as (particles, folder, scene):
            for solver in solvers:
                found = cost_of(run(context, results, folder, scene, solver, (settings or {}).get(solver)))
                rows.append([1e3 * step, solver, particles, found.iterations, found.pressure, found.total,
                             *theirs.get(solver, (None, None, None))])
    titles = ["iterations", "pressure [s/frame]", "total [s/frame]"]
    results.table(name, ["step [ms]", "solver", "particles", *titles, *(f"theirs: {title}" for title in titles)], rows)
    with results.figure(name, columns=3) as panels:
        for axes, ours, theirs, label in ((panels[0], 3, 6, "iterations a step"),
                                          (panels[1], 4, 7, "pressure solve [s a frame]"),
                                          (panels[2], 5, 8, "in total [s a frame]")):
            plot_by_step(axes, rows, solvers, ours, theirs)
            axes.set_ylabel(label)
        panels[0].legend(fontsize=7)


def plot_by_step(axes, rows, solvers, ours, theirs):
    """One column of ours as full lines, one of theirs as broken lines of the same colour."""
    for solver in solvers:
        of = [row for row in rows if row[1] == solver]
        line, = axes.plot([row[0] for row in of], [row[ours] for row in of], "o-", label=solver)
        if of[0][theirs] is not None:
            axes.plot([row[0] for row in of], [row[theirs] for row in of], "s--", color=line.get_color(),
                      markerfacecolor="none", label=f"dissertation, {solver}")
    axes.set(xlabel="time step [ms]", xscale="log", yscale="log")
    steps = sorted({row[0] for row in rows})
    axes.set_xticks(steps, [f"{step:g}" for step in steps])
    axes.tick_params(axis="x", which="minor", bottom=False, labelbottom=False)
    low, high = axes.get_ylim()
    axes.set_ylim(low, high * (high / low) ** 0.3)  # room for the legend


@entry("table-3.1", "Iterations and seconds a frame with different time steps, IISPH beside ours", quick=210)
def table_3_1(context, results):
    compare_steps(context, results, "table-3.1", DISSERTATION_3_1, SOLVERS)


@entry("table-2.6", "Iterations and seconds a frame of the hybrid method with a small and a large time step", quick=30)
def table_2_6(context, results):
    compare_steps(context, results, "table-2.6", DISSERTATION_2_6, ("multilevel", "isph jacobi cg"),
                  {"isph jacobi cg": {"method.pressure.largest_residual": 1}},
                  particles=context.pick(125_000, 27_000, 500), end=2 * FRAME, spacing=SPACING_2_9)


def dam_break_2_9(context, end):
    return dam_break(context, STEP_2_9, particles=context.pick(125_000, 13_000, 500), end=end, spacing=SPACING_2_9)


def moments(run):
    """Of each frame: time [s], and of the liquid the front, the mean x, the mean z and the height at the back [m]."""
    for time, path in run.frames():
        x, _, z = read_frame(path)["position"].T
        back = z[x < 2 * SPACING_2_9]
        yield time, float(x.max()), float(x.mean()), float(z.mean()), float(back.max()) if len(back) else 0.0


@entry("figure-2.9", "What a dam break looks like with IISPH and with ours", quick=150)
def figure_2_9(context, results):
    end = context.pick(1.2, 0.45, 0.045)
    titles = ("front", "mean x", "mean z", "height at the back")
    curves, found, pictures = [], {}, []
    with dam_break_2_9(context, end) as (particles, folder, scene):
        for solver in ("iisph jacobi", "isph jacobi cg"):
            done = run(context, results, folder, scene, solver, {"output.interval": end / 9})
            found[solver] = list(moments(done))
            curves += [[solver, *line] for line in found[solver]]
            pictures.append([(f"{solver}, {time:.2f} s", drawn(context, results, done, "speed", "0:5", number))
                             for number, time in ((k, end * k / 9) for k in (3, 6, 9))])
        results.curves("curves", ["solver", "time [s]", *(f"{title} [m]" for title in titles)], curves)
        results.pictures("pictures", list(zip(*pictures)))
    edge = found["iisph jacobi"][0][1]
    apart = [max(abs(a[k] - b[k]) for a, b in zip(*found.values())) for k in range(1, 5)]
    results.table("figure-2.9", ["of the liquid", "particles", "largest difference [m]", "over the column's edge", "theirs"],
                  [[title, particles, far, far / edge, "comparable"] for title, far in zip(titles, apart)])
    with results.figure("figure-2.9", columns=4, size=(3.6, 3.2)) as panels:
        for k, (axes, title) in enumerate(zip(panels, titles), 1):
            for (solver, lines), style in zip(found.items(), ("o-", "x--")):
                axes.plot([line[0] for line in lines], [line[k] for line in lines], style, markerfacecolor="none",
                          label=solver)
            axes.set(xlabel="time [s]", ylabel=f"{title} [m]")
        panels[0].legend(fontsize=8)


@entry("figure-2.10", "Seconds of the pressure solve over a dam break, IISPH beside ours", quick=200)
def figure_2_10(context, results):
    solvers = ("iisph jacobi", "isph jacobi cg", "multilevel")
    curves, rows = [], []
    with dam_break_2_9(context, context.pick(1.0, 0.4, 0.02)) as (particles, folder, scene):
        for solver in solvers:
            steps = run(context, results, folder, scene, solver).steps()
            seconds = pressure_seconds(steps)
            curves += [[solver, time, spent] for time, spent in zip(steps["time"], seconds.cumsum())]
            rows.append([solver, particles, float(seconds.sum()), DISSERTATION_2_10.get(solver)])
    for row in rows:
        row += [row[2] / rows[1][2], row[3] / DISSERTATION_2_10["isph jacobi cg"] if row[3] else None]
    results.curves("curves", ["solver", "time [s]", "pressure solve until then [s]"], curves)
    results.table("figure-2.10", ["solver", "particles", "pressure [s]", "theirs: pressure [s]", "over ISPH with CG",
                                  "theirs: over ISPH with CG"], rows)
    with results.figure("figure-2.10") as axes:
        for solver in solvers:
            line, = axes.plot(*zip(*[point[1:] for point in curves if point[0] == solver]), label=solver)
            if solver in DISSERTATION_2_10:
                axes.plot(curves[-1][1], DISSERTATION_2_10[solver], "s", color=line.get_color(), markerfacecolor="none",
                          label=f"dissertation's sum, {solver}")
        axes.set(xlabel="time [s]", ylabel="pressure solve until then [s]", yscale="log")
        axes.legend(fontsize=8)
