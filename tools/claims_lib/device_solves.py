"""Rows of `device` on solves: iterations on any number of ranks, work on the Serial back end."""

from . import grid_solves, seeing_stokes
from .bench import pressure_bench
from .gtest import run_gtest
from .pressure import middle_size
from .run import RunFolder, scratch, treacle
from .table import Figure

RANKS, QUICK_RANKS = (1, 2, 3, 4, 8), (1, 2, 4)
SMOOTHERS = {"chebyshev": "Chebyshev", "gauss_seidel": "sweeps"}
SIZES, QUICK_SIZES = (57_000, 300_000, 1_000_000, 3_400_000), (57_000,)
BYTES = 4000            # of a particle at the peak of `bench pressure`
WORK = {"ball": (110, 110), "sheet": (150,)} # WU with set-up, in the order of the stiffness
TEST = "Pressures.TakeFewIterationsWhateverTheSize"
VISCOSITY = 1000        # [Pa s] of the ball over a pool that is solved for with its pressure
NONE = "Chebyshev not measured: no key chooses it there"


def ranks_of(context):
    return QUICK_RANKS if context.quick else RANKS


def same(counts):
    """On all numbers of ranks as on one, within an iteration. counts: {ranks: iterations}."""
    return all(abs(count - counts[1]) <= 1 for count in counts.values())


def in_words(counts):
    values = list(counts.values())
    return str(values[0]) if len(set(values)) == 1 else " / ".join(map(str, values))


def one_pressure(context, size, smoother, ranks):
    """Iterations to 1e-6; those of no convergence are more than any."""
    report = pressure_bench(context, size, ["multilevel"], [1e-6], ranks=ranks,
                            overrides={"method.pressure.multilevel.smoother": smoother})
    solve = report["solves"][0]
    return solve["iterations"] if solve["converged"] else seeing_stokes.NEVER


def free_memory():
    """Memory that programs can have without others being swapped out [bytes]."""
    with open("/proc/meminfo") as file:
        return next(1024 * int(line.split()[1]) for line in file if line.startswith("MemAvailable"))


def sph_pressure(context):
    memory = free_memory()
    parts, ok = [], True
    for size in QUICK_SIZES if context.quick else SIZES:
        if size * BYTES > memory:
            parts.append(f"{size} particles not measured, {memory / 2**30:.0f} GB free")
            ok = False
            continue
        found = {one: {ranks: one_pressure(context, size, one, ranks) for ranks in ranks_of(context)} for one in SMOOTHERS}
        device = found["chebyshev"]
        ok = ok and max(device.values()) <= 9 and same(device)
        parts.append(f"{size} particles: " + ", ".join(f"{SMOOTHERS[one]} {in_words(counts)}" for one, counts in found.items()))
    return Figure(f"on {', '.join(map(str, ranks_of(context)))} ranks, " + "; ".join(parts), ok)


def by_size(reports, start):
    """{size: {ranks: iterations}} of what a test recorded under names that start so."""
    sizes = [key.removeprefix(start) for key in reports[1].properties if key.startswith(start) and key.removeprefix(start).isdigit()]
    return {size: {ranks: int(report.properties[start + size]) for ranks, report in reports.items()} for size in sizes}


def grid_pressure(context):
    """By what the test records: iterations_24 by the back end's default smoother, iterations_chebyshev_24 once it takes both."""
    reports = {ranks: run_gtest(context, "grid_pressure_test", TEST, ranks=ranks) for ranks in ranks_of(context)}
    default, device = by_size(reports, "iterations_"), by_size(reports, "iterations_chebyshev_")
    ok = bool(device) and all(max(counts.values()) <= 12 and same(counts) for counts in device.values())
    parts = [f"by the default {in_words(counts)} at {size}^3" for size, counts in default.items()]
    parts += [f"Chebyshev {in_words(counts)} at {size}^3" for size, counts in device.items()] or [NONE]
    return Figure(f"on {', '.join(map(str, ranks_of(context)))} ranks, " + ", ".join(parts), ok)


def grid_viscosity(context):
    """Cases of `treacle bench viscosity`, each by its scene, cells and stiffness."""
    cells = (48,) if context.quick else (48, 96, 192)
    found = {}
    for ranks in ranks_of(context):
        for case in grid_solves.bench(context, cells, ranks=ranks):
            name = (case.get("smoother", "sweeps"), f"{case['scene']} {case['cells']}^3 {case['nu dt/dx2']:.0e}")
            found.setdefault(name, {})[ranks] = case["iterations"]
    device = [counts for (smoother, _), counts in found.items() if smoother == "chebyshev"]
    text = ", ".join(f"{smoother} {name}: {in_words(counts)}" for (smoother, name), counts in found.items())
    return Figure(f"on {', '.join(map(str, ranks_of(context)))} ranks, {text}" + ("" if device else f"; {NONE}"),
                  bool(device) and all(max(counts.values()) <= 25 and same(counts) for counts in device))


def stokes_iterations(context, cells, ranks):
    """Most of the second step's, since the first starts from nothing."""
    with scratch(context, "unified") as folder:
        scene = folder / "scene.yaml"
        scene.write_text(seeing_stokes.SCENE.format(spacing=1 / cells, viscosity=VISCOSITY, solve="together"))
        treacle(context, "run", scene, "--out", folder / "out", "--set", "time.end=0.015", ranks=ranks, timeout=4 * 3600)
        return int(RunFolder(folder / "out").steps()["stokes iterations"][1:].max())


def unified(context):
    cells = 32 if context.quick else 128
    counts = {ranks: stokes_iterations(context, cells, ranks) for ranks in ranks_of(context)}
    return Figure(f"on {', '.join(map(str, ranks_of(context)))} ranks, ball over a pool, {VISCOSITY} Pa s, {cells}^3: sweeps {in_words(counts)}; "
                  f"{NONE}", False)


def pressure_work(context):
    """Other programs on the machine make a run slower, never faster."""
    size = middle_size(context)
    parts, best = [], {}
    for smoother, name in SMOOTHERS.items():
        solves = [pressure_bench(context, size, ["multilevel"], [1e-6], ranks=2, overrides={"method.pressure.multilevel.smoother": smoother})
                  ["solves"][0] for _ in range(2)]
        best[smoother] = min(solves, key=lambda solve: solve["work [WU]"])
        parts.append(f"{name} {best[smoother]['work [WU]']:.1f} WU (set-up {best[smoother]['set-up [WU]']:.1f})")
    least = min(solve["work [WU]"] for solve in best.values())
    return Figure(f"{size} particles to 1e-6, 2 ranks, the better of two runs: {', '.join(parts)}", least <= 24)


def viscosity_work(context):
    cases = grid_solves.bench(context, (96,), ranks=2, repeats=3 if context.quick else 5)
    wanted = {name: list(values) for name, values in WORK.items()}
    ok = all(case["work [WU]"] <= wanted[case["scene"]].pop(0) for case in cases)
    return Figure("96^3, 2 ranks: " + ", ".join(
        f"{case['scene']} {case['nu dt/dx2']:.0e} {case['iterations']} iterations {case['work [WU]']:.0f} WU" for case in cases), ok)


def add_rows(table):
    ranks = "1, 2, 3, 4, 8 ranks, Chebyshev; sweeps beside it"
    table.row("iterations, SPH pressure", claim=f"to 1e-6 from 57k to 3.4M particles on {ranks}", asked="<= 9, the same +- 1 on all")(sph_pressure)
    table.row("iterations, grid pressure", claim=f"to 1e-10 on {ranks}", asked="<= 12, the same +- 1 on all")(grid_pressure)
    table.row("iterations, grid viscosity", claim=f"to 1e-8, 48^3 to 192^3, on {ranks}", asked="<= 25, the same +- 1 on all")(grid_viscosity)
    table.row("iterations, unified", claim=f"pressure and viscosity together, 128^3, on {ranks}", asked="<= 40, the same +- 1 on all")(unified)
    table.row("work, SPH pressure", claim="Serial back end, to 1e-6, 1M particles, set-up included",
              asked="<= 24 WU (products in double precision)")(pressure_work)
    table.row("work, grid viscosity", claim="Serial back end, ball at 1e3 and 1e5 Pa s, sheet at 1e5, 96^3, set-up included",
              asked="<= 110, 110, 150 WU")(viscosity_work)
