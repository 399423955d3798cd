"""Figures 3.6 and 3.9: how fast pressure solvers converge, and what they cost."""

from claims_lib.bench import pressure_bench
from claims_lib.iisph import DENSITY_ERROR, SOLVERS, START, dam_break
from claims_lib.run import run_scene

from .costs import bars, pressure_seconds
from .entries import entry
from .iterations import BEST_FACTOR, FACTOR, KEY

ISPH = {KEY + "solver": "isph"}
PROFILE = {
    "multilevel": SOLVERS["multilevel"],
    "multilevel_rediscretised": {**ISPH, KEY + "preconditioner": "multilevel_rediscretised"},
    "CG": {**ISPH, KEY + "preconditioner": "none"},
    "ICCG": {**ISPH, KEY + "preconditioner": "incomplete_cholesky"},
    "SORCG": {**ISPH, KEY + "preconditioner": "sor_jacobi", KEY + "relaxation": 1.2},
    "IISPH": SOLVERS["iisph jacobi"],
    "IISPH, spectral": SOLVERS["iisph"],
    "DFSPH": SOLVERS["dfsph"],
}
# Times over those of the dissertation's own solver, to a density error of 0.01 %; 3.4 million particles, 24 cores.
DISSERTATION_TIMES = {"multilevel_rediscretised": 1.0, "CG": 4.0, "IISPH": 12.0}
OVER_A_RUN = {"IISPH": 7.5, "CG": 2.3, "multilevel": 1.0}  # likewise, in a run of a million particles
# The dissertation's sizes, and ours with --quick.
SIZES, QUICK_SIZES, SMALLEST_SIZES = (123_500, 1_000_000, 3_400_000), (15_000, 60_000, 124_000), (1_000, 2_000)


def time_to_error(context, results):
    """Iterations and seconds of a step to a density error, warm from step to step as in a run."""
    particles, errors = context.pick(1_000_000, 13_000, 500), context.pick(*2 * [(1e-2, 1e-3, 1e-4, 1e-5)], (DENSITY_ERROR,))
    step, rows = 8.32e-3, []
    for name, settings in PROFILE.items():
        for error in errors:
            with dam_break(context, step, particles=particles, end=5 * step) as (count, folder, scene):
                run = run_scene(context, scene, folder / "run", ranks=results.ranks, timeout=24 * 3600,
                                set={**settings, KEY + "density_error": error, KEY + "largest_residual": 1})
                steps = run.steps()
                late = steps["time"] > START
                rows.append([name, count, error, float(steps["pressure iterations"][late].mean()),
                             float(pressure_seconds(steps)[late].mean())])
    return rows


def over_time(context, results):
    """Seconds of each step's pressure solve; with ISPH, also without the construction of the system."""
    end = context.pick(1.0, 0.2, 0.01)
    rows = []
    with dam_break(context, 2.08e-3, particles=context.pick(1_000_000, 13_000, 500), end=end) as (_, folder, scene):
        for name in OVER_A_RUN:
            steps = run_scene(context, scene, folder / name, ranks=results.ranks, timeout=24 * 3600,
                              set={**PROFILE[name], KEY + "density_error": DENSITY_ERROR}).steps()
            spent = pressure_seconds(steps)
            rows += [[name, time, float(whole), float(solve)]
                     for time, whole, solve in zip(steps["time"], spent, steps["solve"])]
    return rows


def residuals(context, results):
    rows = []
    for size in context.pick(SIZES, QUICK_SIZES, SMALLEST_SIZES):
        report = pressure_bench(context, size, ["multilevel", "multilevel_rediscretised", "none"], [1e-6], ranks=results.ranks)
        for solve in report["solves"]:
            name = {"none": "CG"}.get(solve["preconditioner"], solve["preconditioner"])
            rows += [[name, report["rows"], k, residual, seconds] for k, (residual, seconds) in
                     enumerate(zip(solve["history"]["residuals"], solve["history"]["seconds"]))]
    return rows


@entry("figure-3.9", "Convergence of multilevel, CG, ICCG, SORCG, IISPH and DFSPH; cost over a run; growth with the size",
       quick=240)
def figure_3_9(context, results):
    costs = time_to_error(context, results)
    at = {name: row for row in costs for name in [row[0]] if row[2] == DENSITY_ERROR}
    results.table("to-an-error", ["solver", "particles", "density error", "iterations", "pressure [s/step]"], costs)
    results.table("figure-3.9", ["solver", "iterations to 0.01 %", "time over multilevel", "over multilevel_rediscretised",
                                 "theirs: over their grids"],
                  [[name, row[3], row[4] / at["multilevel"][4], row[4] / at["multilevel_rediscretised"][4],
                    DISSERTATION_TIMES.get(name)] for name, row in at.items()])
    spent = over_time(context, results)
    results.curves("over-time", ["solver", "time [s]", "pressure [s]", "solve [s]"], spent)
    sums = {name: [sum(row[k] for row in spent if row[0] == name) for k in (2, 3)] for name in OVER_A_RUN}
    results.table("over-a-run", ["solver", "pressure [s]", "over multilevel", "theirs: over their grids"],
                  [[name, sums[name][0], sums[name][0] / sums["multilevel"][0], theirs]
                   for name, theirs in OVER_A_RUN.items()])
    histories = residuals(context, results)
    results.curves("residuals", ["solver", "unknowns", "iteration", "residual", "seconds [s]"], histories)
    sizes = sorted({row[1] for row in histories})
    results.table("iterations", ["solver", *(f"{size} unknowns" for size in sizes)],
                  [[name, *(max(row[2] for row in histories if row[:2] == [name, size]) for size in sizes)]
                   for name in ("multilevel", "multilevel_rediscretised", "CG")])
    with results.figure("figure-3.9", columns=3, rows=2) as panels:
        draw_errors(panels[0][0], panels[0][1], costs, at)
        draw_times(panels[1][0], spent)
        draw_residuals(panels[1][1], histories)
        names = ("multilevel_rediscretised", "CG", "IISPH")
        bars(panels[0][2], names, [at[name][4] / at["multilevel_rediscretised"][4] for name in names],
             [DISSERTATION_TIMES[name] for name in names], "time to 0.01 % over that of multilevel_rediscretised")
        bars(panels[1][2], list(OVER_A_RUN), [sums[name][0] / sums["multilevel"][0] for name in OVER_A_RUN],
             list(OVER_A_RUN.values()), "pressure solve over a run, over multilevel (theirs: their grids)")


def draw_errors(left, right, costs, at):
    for name in PROFILE:
        of = [row for row in costs if row[0] == name]
        left.plot([row[3] for row in of], [row[2] for row in of], ".-", label=name)
        right.plot([row[4] for row in of], [row[2] for row in of], ".-", label=f"{name} ({at[name][3]:.0f})")
    left.set(xlabel="iterations a step", ylabel="density error", xscale="log", yscale="log")
    right.set(xlabel="pressure solve [s a step]", ylabel="density error", xscale="log", yscale="log")
    left.legend(fontsize=7)
    right.legend(fontsize=7, title="(iterations to 0.01 %)", title_fontsize=7)


def draw_times(axes, spent):
    for name in OVER_A_RUN:
        of = [row for row in spent if row[0] == name]
        line, = axes.plot([row[1] for row in of], [row[2] for row in of], label=name)
        if name != "IISPH":
            axes.plot([row[1] for row in of], [row[3] for row in of], ":", color=line.get_color(),
                      label=f"{name}, solve alone")
    axes.set(xlabel="time [s]", ylabel="pressure solve [s a step]", yscale="log")
    axes.legend(fontsize=7)


def draw_residuals(axes, histories):
    for name, style in (("multilevel", "-"), ("CG", "--")):
        for size in sorted({row[1] for row in histories}):
            of = [row for row in histories if row[:2] == [name, size]]
            axes.plot([row[2] for row in of], [row[3] for row in of], style, label=f"{name}, {size} unknowns")
    axes.set(xlabel="iteration", ylabel="residual", xscale="log", yscale="log")
    axes.legend(fontsize=7)


BEST_IN_THEIRS = {"V-cycle": 1.0, "MGCG": 0.125}  # lambda over their best
DIVERGED = 1e3                                    # residuals beyond are not drawn


@entry("figure-3.6", "Convergence of the V-cycle by itself and of MGCG on the dissertation's grids, by lambda", quick=10)
def figure_3_6(context, results):
    size, sweeps, rows = context.pick(300_000, 15_000, 1_000), 40, []
    for share in context.pick(*2 * [(0.125, 0.25, 0.5, 1.0, 2.0, 4.0)], (0.125, 1.0)):
        report = pressure_bench(context, size, ["multilevel_rediscretised"], [1e-6], ranks=results.ranks, sweeps=sweeps,
                                overrides={FACTOR: share * BEST_FACTOR})
        for kind, history in (("V-cycle", report["preconditioners"][0]["sweeps"]), ("MGCG", report["solves"][0]["history"])):
            rows += [[kind, share, k, residual] for k, residual in enumerate(history["residuals"])]
    galerkin = pressure_bench(context, size, ["multilevel"], [1e-6], ranks=results.ranks)["solves"][0]["history"]
    rows += [["MGCG", "galerkin", k, residual] for k, residual in enumerate(galerkin["residuals"])]
    results.curves("figure-3.6-curves", ["method", "lambda / best", "iteration", "residual"], rows)

    def iterations(kind, share, to=1e-3):
        reached = [row[2] for row in rows if row[:2] == [kind, share] and row[3] <= to]
        return min(reached) if reached else None

    shares = [share for share in dict.fromkeys(row[1] for row in rows)]
    results.table("figure-3.6", ["lambda / best", "V-cycle to 1e-3", "MGCG to 1e-3", "MGCG to 1e-6", "theirs"],
                  [[share, iterations("V-cycle", share), iterations("MGCG", share), iterations("MGCG", share, 1e-6),
                    {0.125: "best MGCG", 1.0: "best V-cycle; MGCG stagnates"}.get(share)] for share in shares])
    with results.figure("figure-3.6", columns=2) as (left, right):
        for axes, kind in ((left, "V-cycle"), (right, "MGCG")):
            for share in shares:
                of = [row for row in rows if row[:2] == [kind, share] and row[3] < DIVERGED]
                if of:
                    noted = ", the dissertation's best" if BEST_IN_THEIRS[kind] == share else ""
                    axes.plot([row[2] for row in of], [row[3] for row in of], label=f"{share}{noted}")
            axes.set(xlabel=f"{kind} iteration", ylabel="residual", yscale="log", xlim=(0, sweeps))
            axes.legend(title="lambda / best", fontsize=7)

