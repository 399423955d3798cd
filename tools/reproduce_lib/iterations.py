"""Figures 3.8 and 3.12: iterations from step to step, by lambda, and with and without bodies that the liquid moves."""

from claims_lib.iisph import DENSITY_ERROR
from claims_lib.run import run_scene
from claims_lib.table import CommandFailed

from .costs import iterations_over_time
from .entries import entry

KEY = "method.pressure."
FACTOR = KEY + "multilevel.grid_factor"
BEST_FACTOR = 1.2  # lambda at which grid and particles agree best on irregular particles
SHARES = (0.10, 0.25, 0.50, 0.75, 1.0)  # of the best lambda, as in the dissertation

DOUBLE_DAM_BREAK = """schema_version: 1
title: Two columns of water fall towards each other
domain:
  max: [1.2, 0.4, 0.6]
  spacing: {spacing}
liquids:
  - name: water
    density: 1000
    viscosity: 1 mPa.s
    shapes:
      - box: {{min: [0, 0, 0], max: [0.3, 0.4, 0.4]}}
      - box: {{min: [0.9, 0, 0], max: [1.2, 0.4, 0.4]}}
{bodies}method:
  viscosity: {{artificial: 0.3}}
time: {{end: {end}, rule: fixed, step: {step}}}
output: {{interval: 0}}
max_lost_fraction: 0.005
"""
CUBE = """  - name: cube_{number}
    kind: dynamic
    density: {density}
    shape:
      box: {{min: [{x:.3f}, {y:.3f}, {z:.3f}], max: [{x_max:.3f}, {y_max:.3f}, {z_max:.3f}]}}
"""
SIMULATION_FAILED = 3  # exit code
CUBE_EDGE = 0.1       # [m]
DENSITIES = (300, 600, 900)  # of the cubes, in turn


def iterations(context, results, scene, folder, settings):
    """Pairs of time [s] and iterations of each step; none for a simulation that failed."""
    run = run_scene(context, scene, context.scratch / folder, ranks=results.ranks, arguments=["--overwrite"],
                    set=settings, expect=None, timeout=24 * 3600)
    if run.finished.code not in (0, SIMULATION_FAILED):
        raise CommandFailed(f"exit code {run.finished.code}: {run.finished.output}")
    steps = run.steps()
    return run, list(zip(steps["time"], steps["pressure iterations"])) if run.finished.code == 0 else []


def mean(rows):
    return float(sum(row[-1] for row in rows) / len(rows))


@entry("figure-3.8", "Iterations of MGCG on the dissertation's grids over two runs, by lambda", quick=120)
def figure_3_8(context, results):
    end = context.pick(1.2, 0.3, 0.02)
    scenes = {"stirrer": context.root / "inputs/stirrer/scene.yaml",  # liquid with bodies that are moved through it
              "dam break": context.root / "inputs/dam_break/scene.yaml"}
    spacing = {"stirrer": context.pick(0.0015, 0.005, 0.01), "dam break": context.pick(0.0075, 0.02, 0.04)}
    rows, means = [], {}
    for scene, path in scenes.items():
        for share in SHARES:
            _, found = iterations(context, results, path, f"{scene.replace(' ', '_')}-{share}",
                                  {KEY + "solver": "isph", KEY + "preconditioner": "multilevel_rediscretised", FACTOR: share * BEST_FACTOR,
                                   KEY + "density_error": DENSITY_ERROR, "time.end": end, "output.interval": 0,
                                   "domain.spacing": spacing[scene]})
            means[scene, share] = mean(found) if found else "failed"
            rows += [[scene, share, time, n] for time, n in found]
    results.curves("curves", ["scene", "lambda / best", "time [s]", "iterations"], rows)
    results.table("figure-3.8", ["lambda / best", *(f"{scene}: mean iterations" for scene in scenes), "theirs"],
                  [[share, *(means[scene, share] for scene in scenes),
                    "one of two fails" if share == 1.0 else "fewest just below failure"] for share in SHARES])
    with results.figure("figure-3.8", columns=2) as panels:
        for axes, scene in zip(panels, scenes):
            iterations_over_time(axes, [row for row in rows if row[0] == scene], SHARES, column=1)
            axes.set_title(scene)
            axes.legend(title="lambda / best", fontsize=7)


def cubes():
    """Three rows of two cubes that fall from above the dry floor between the columns into the water that meets there."""
    text = "bodies:\n"
    for number in range(6):
        x, y, z = 0.4 + 0.15 * (number // 2), 0.07 + 0.16 * (number % 2), 0.2
        text += CUBE.format(number=number, density=DENSITIES[number % 3], x=x, y=y, z=z, x_max=x + CUBE_EDGE,
                            y_max=y + CUBE_EDGE, z_max=z + CUBE_EDGE)
    return text


# To a density error of 0.01 % one iteration a step would do, with cubes and without.
STOP = {KEY + "stop": "residual", KEY + "residual": 1e-4}


@entry("figure-3.12", "Iterations over a double dam break, with cubes that the water carries and without", quick=180)
def figure_3_12(context, results):
    spacing, end = context.pick((0.0075, 2.0), (0.02, 0.8), (0.04, 0.02))
    solvers, scenes = ("multilevel", "multilevel_rediscretised"), {"with cubes": cubes(), "without": ""}
    rows, lines = [], []
    for name, bodies in scenes.items():
        scene = results.folder / "runs" / f"{name.replace(' ', '_')}.yaml"
        scene.parent.mkdir(parents=True, exist_ok=True)
        scene.write_text(DOUBLE_DAM_BREAK.format(bodies=bodies, spacing=spacing, end=end, step=0.06 * spacing))
        for solver in solvers:
            run, found = iterations(context, results, scene, f"{scene.stem}-{solver}",
                                    {KEY + "solver": "isph", KEY + "preconditioner": solver, **STOP})
            steps = run.steps()
            lines.append([solver, name, int(steps["particles"][0]), int(steps["lost by leak"][-1]),
                          mean(found) if found else "failed", max(row[-1] for row in found) if found else None,
                          "as many with and without"])
            rows += [[solver, name, time, n] for time, n in found]
    results.curves("curves", ["solver", "scene", "time [s]", "iterations"], rows)
    results.table("figure-3.12", ["solver", "scene", "liquid particles", "lost", "mean iterations", "most", "theirs"],
                  sorted(lines))
    with results.figure("figure-3.12", columns=2) as panels:
        for axes, solver in zip(panels, solvers):
            iterations_over_time(axes, [row for row in rows if row[0] == solver], scenes, column=1)
            axes.set_title(f"{solver}, to a residual of 1e-4")
            axes.legend(fontsize=8)
