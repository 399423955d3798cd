"""Rows of `ensembles` on searches."""

import csv
import io
import math
import statistics

from .gtest import run_gtest
from .run import built, execute, run_scene, scratch
from .table import Figure

SEEDS = 15

# Medians of 15 seeds of pycma 4.4.0 to 1e-9.
EVALUATIONS = {
    ("sphere", "active"): {2: 246, 5: 704, 10: 1510},
    ("ellipsoid", "active"): {2: 468, 5: 1472, 10: 4110},
    ("ellipsoid", "plain"): {2: 570, 5: 2032, 10: 5640},
    ("rosenbrock", "active"): {2: 468, 5: 1664, 10: 5305},
    ("rosenbrock", "plain"): {2: 540, 5: 1992, 10: 5935},
}
# Those of its lq-CMA-ES.
LQ_EVALUATIONS = {
    ("sphere", "lq"): {2: 9, 5: 18, 10: 32},
    ("ellipsoid", "lq"): {2: 10, 5: 19, 10: 34},
    ("rosenbrock", "lq"): {2: 134, 5: 333, 10: 1260},
}
NEAR = 0.12
LQ_ABOVE = 0.2 # ours is 13 % above on Rosenbrock in five dimensions, over 61 seeds
SUCCESSES = 0.85

CONTAINER = """
schema_version: 1
title: A container drains through a hole in its floor, in the plane
domain:
  dimensions: 2
  min: [0, 0]
  max: [0.12, 0.2]
  spacing: {spacing}
  gravity: [0, -9.81]
  boundaries:
    x_min: {{slip: no_slip}}
    x_max: {{slip: no_slip}}
    y_min: {{kind: open, outflow: true}}
    y_max: {{kind: open}}
liquids:
  - name: liquid
    density: 1000
    viscosity: 1
    shapes: [{{box: {{min: [0, 0.06], max: [0.12, 0.16]}}}}]
bodies:
  - {{name: left, slip: no_slip, shape: {{box: {{min: [0, 0.048], max: [0.052, 0.06]}}}}}}
  - {{name: right, slip: no_slip, shape: {{box: {{min: [0.068, 0.048], max: [0.12, 0.06]}}}}}}
max_lost_fraction: 1
method: grid
measurements:
  - {{name: level, kind: height, position: [0.02, 0.06], axis: y}}
time: {{end: 1 s}}
output: {{interval: 1 s, checkpoint_interval: 0}}
"""
VISCOSITIES = (0.19, 0.22, 1.25, 4.74, 5.82, 7.86)  # [Pa s] Table 6.2 of the dissertation
LOWEST, HIGHEST, RUNS = 0.05, 500.0, 36             # of the ladder, even in their logarithms
FRAMES = 30                                         # in the second that is simulated
PIXEL = 0.25e-3                                     # [m] 480 across the container
FINE = 0.002                                        # distance of the tabled objective's entries in ln viscosity


def bench_rows(context, *words):
    done = execute(context, [built(context, "search_bench", "tests"), *words])
    return list(csv.DictReader(io.StringIO(done.output)))


def function_rows(context):
    return context.once("evaluations on functions", lambda: bench_rows(context, "functions", SEEDS))


def compared(rows, medians, is_near):
    texts, ok = [], True
    for (function, variant), asked in medians.items():
        for n, expected in asked.items():
            chosen = [row for row in rows if (row["function"], row["variant"], row["n"]) == (function, variant, str(n))]
            reached = [int(row["evaluations"]) for row in chosen if row["reached"] == "1"]
            median = statistics.median(reached) if reached else math.inf
            good = is_near(median / expected) and len(reached) >= SUCCESSES * len(chosen)
            ok = ok and good
            texts.append(f"{function} {variant} {n}: {median:g} of {expected} ({len(reached)}/{len(chosen)})"
                         + ("" if good else " SHORT"))
    return Figure(", ".join(texts), ok)


def cma_es(context):
    return compared(function_rows(context), EVALUATIONS, lambda ratio: abs(ratio - 1) <= NEAR)


def lq_cma_es(context):
    return compared(function_rows(context), LQ_EVALUATIONS, lambda ratio: ratio <= 1 + LQ_ABOVE)


def levels(context, folder, viscosity):
    """The level in the container at each frame [m]."""
    scene = folder / "container.yaml"
    if not scene.exists():
        scene.write_text(CONTAINER.format(spacing="6 mm" if context.quick else "4 mm"))
    run = run_scene(context, scene, folder / f"{viscosity:.6g}", ranks=1,
                    set={"liquids.liquid.viscosity": f"{viscosity:.17g}"})
    table = run.measurements()
    return [table.at("level", (k + 1) / FRAMES) for k in range(FRAMES)]


def ladder(context):
    """Logarithms of the ladder's viscosities, and the levels of their runs: measured once in a call of tools/claims."""
    def measure():
        places = [math.log(LOWEST) + k * math.log(HIGHEST / LOWEST) / (RUNS - 1) for k in range(RUNS)]
        with scratch(context, "ladder") as folder:
            return places, [levels(context, folder, math.exp(x)) for x in places]
    return context.once("ladder of a container in the plane", measure)


def pixels(places, series, x):
    """Levels of a viscosity in whole pixels, between those of the ladder."""
    spacing = places[1] - places[0]
    k = min(max(int((x - places[0]) / spacing), 0), len(places) - 2)
    part = min(max((x - places[k]) / spacing, 0), 1)
    return [round(((1 - part) * a + part * b) / PIXEL) for a, b in zip(series[k], series[k + 1])]


def write_objective(path, places, series, viscosity):
    """The mean number of pixels between the levels of every viscosity and of one, by logarithm (Eq. 6.9's absolute values)."""
    seen = pixels(places, series, math.log(viscosity))
    count = int((places[-1] - places[0]) / FINE)
    with open(path, "w") as file:
        for k in range(count + 1):
            x = places[0] + k * FINE
            levels_here = pixels(places, series, x)
            file.write(f"{x:.17g} {sum(abs(a - b) for a, b in zip(levels_here, seen)) / FRAMES:.17g}\n")


def comparators(context):
    places, series = ladder(context)
    texts, ok = [], True
    with scratch(context, "objective") as folder:
        for viscosity in VISCOSITIES[:1] if context.quick else VISCOSITIES:
            path = folder / f"{viscosity:g}.txt"
            write_objective(path, places, series, viscosity)
            rows = bench_rows(context, "ladder", path, viscosity, SEEDS)
            parts = []
            for method in dict.fromkeys(row["method"] for row in rows):
                since = [int(row["evaluations"]) for row in rows if row["method"] == method and row["reached"] == "1"]
                all_ = statistics.median(int(row["all"]) for row in rows if row["method"] == method)
                parts.append(f"{method} {statistics.median(since) if since else '-'} then {all_} ({len(since)})")
                if method in ("bracketing", "cma-es"):
                    ok = ok and len(since) >= SUCCESSES * SEEDS
            texts.append(f"{viscosity:g} Pa s: " + ", ".join(parts))
    return Figure("; ".join(texts), ok)


def bounds(context):
    report = run_gtest(context, "search_cma_bounds_test", "CmaBounds.*")
    return Figure(report.text(), report.ok and report.ran >= 6)


def one_parameter(context):
    report = run_gtest(context, "search_bracketing_test", "Bracketing.*")
    return Figure(report.text(), report.ok and report.ran >= 11)


def resolution(context):
    report = run_gtest(context, "search_rungs_test", "Rungs.*")
    return Figure(report.text(), report.ok and report.ran >= 5)


def add_rows(table):
    table.row("CMA-ES", claim="evaluations to 1e-9 of active and plain CMA-ES, n = 2, 5, 10",
              asked="median of 15 seeds within 12 % of pycma's, 85 % of them successful")(cma_es)
    table.row("lq-CMA-ES", claim="evaluations to 1e-9, n = 2, 5, 10",
              asked="median of 15 seeds no more than a fifth above pycma's, 85 % of them successful")(lq_cma_es)
    table.row("CMA-ES, bounds", claim="an answer on a bound, near one or between is found without bias; restarts find the least of many minima",
              asked="tests pass")(bounds)
    table.row("comparators", claim="evaluations until the best stays within 2 % of each of six viscosities, then until the stop, and seeds of 15 that do, "
              "on the levels of a draining container",
              asked="bracketing and CMA-ES do with 13 seeds of 15 or more; the others for comparison")(comparators)
    table.row("one viscosity", claim="bracketing and Brent's method: evaluations on smooth and cornered objectives",
              asked="8 on a parabola, 12 on a corner, from any start")(one_parameter)
    table.row("rungs of resolution", claim="the correction from coarse to fine and its deviation",
              asked="90 % intervals hold 88 % or more of 400 cases, 50 % ones 50 %")(resolution)
