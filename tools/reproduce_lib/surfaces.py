"""Tables 2.4 and 2.5, figures 2.4 to 2.8 and 3.4: densities, free surfaces and solids, ours and what they replace."""

import csv

from claims_lib.run import built, execute, launched, treacle
from claims_lib.surfaces import RULES, STABLE, THEIRS, Scene, cube_drop, largest_stable, try_step

from .entries import entry

FRAME = 1 / 60  # [s]
SOLVE = ("predict", "assemble", "hand over", "solve")
PHASES = ("sort", "neighbours", "density", "forces", *SOLVE, "pressure force", "move")
PICTURE_AT = 0.2  # [s]

SCENE = """schema_version: 1
title: {title}
domain:
  max: {size}
  spacing: $spacing
  boundaries: {{z_max: open}}
liquids:
  - name: water
    density: 1000
    shapes:
      - {shape}
{bodies}time: {{end: 0.6, rule: fixed, step: $step}}
output: {{interval: $interval}}
lost_limit: 0.001
"""
BODY = "bodies:\n  - name: solid\n    shape:\n      {shape}\n"

# Largest stable steps that the dissertation names [s]; 0: none was found.
FIGURE_2_6 = {"density-based": 0.75e-3, "density-based (clamped)": 0.75e-3, "surface-based": 0,
              "surface-based (clamped)": 0, "ghost-particle-based": 0.42e-3, "ghost-particle-based (clamped)": 0.52e-3,
              "source-term-based": 1.2e-3, "ours": 1.68e-3}
# Thousands of Poisson and Dirichlet particles, step [s], iterations, seconds of the pressure solve and in total a frame.
TABLE_2_4 = {"density-based": (40.0, 2.3, 0.75e-3, 2.92, 4.79, 6.64),
             "ghost-particle-based (clamped)": (42.2, 0.0, 0.52e-3, 0.99, 5.95, 8.85),
             "source-term-based": (32.0, 10.3, 1.2e-3, 1.96, 2.20, 3.23),
             "ours": (28.3, 14.0, 1.68e-3, 4.66, 2.16, 2.97)}
TABLE_2_5 = {"solids as unknowns": (90.6, 43.1, 0.51e-3, 2.26, 16.62, 26.37),
             "ours": (59.1, 17.5, 1.09e-3, 4.39, 6.99, 11.97)}
SOLIDS = {"solids as unknowns": {**THEIRS, "method.pressure.solid_term": "unknowns"}, "ours": THEIRS}


def scene_of(title, size, shape, spacing, top, body=None):
    bodies = BODY.format(shape=body) if body else ""
    return Scene(title, SCENE.format(title=title, size=size, shape=shape, bodies=bodies), spacing, top)


def ball_drop(context):
    return scene_of("A ball of water falls", "[0.9, 0.9, 0.9]", "sphere: {centre: [0.45, 0.45, 0.45], radius: 0.26}",
                    32e-3 if context.quick else 15e-3, 0.71)


def column(context):
    return scene_of("A column of water falls apart", "[0.9, 0.9, 1.2]", "box: {min: [0, 0, 0], max: [0.35, 0.35, 0.9]}",
                    32e-3 if context.quick else 15e-3, 0.9)


def dam_with_post(context):
    return scene_of("Dam break around a post on the floor", "[1.2, 0.55, 1]", "box: {min: [0, 0, 0], max: [0.5, 0.55, 0.6]}",
                    30e-3 if context.quick else 12.9e-3, 0.6, "box: {min: [0.8, 0.2, -0.05], max: [0.95, 0.35, 0.3]}")


def drop_on_ball(context):
    return scene_of("A cube of water falls on a ball in the air", "[0.9, 0.9, 0.9]",
                    "box: {min: [0.25, 0.25, 0.55], max: [0.65, 0.65, 0.85]}", 25e-3 if context.quick else 12.9e-3, 0.85,
                    "sphere: {centre: [0.45, 0.45, 0.35], radius: 0.12}")


def cost_of(run):
    """Means of the unknowns, particles at p = 0, iterations, and seconds a frame of the pressure solve and in total."""
    steps = run.steps()
    frames = steps["time"][-1] / FRAME
    return (float(steps["poisson"].mean()), float(steps["dirichlet"].mean()), float(steps["pressure iterations"].mean()),
            float(sum(steps[name].sum() for name in SOLVE) / frames),
            float(sum(steps[name].sum() for name in PHASES) / frames))


def particles_of(run):
    return int(run.steps()["particles"][0])


def ladders(context, results, scene, methods):
    """The largest stable Trial of each method, or None; all trials go into trials.csv."""
    results.say(f"{scene.name}, spacing {1e3 * scene.spacing:.1f} mm; {STABLE}")
    found, rows = {}, []
    for name, settings in methods.items():
        found[name], trials = largest_stable(context, scene, results.folder / "runs" / name, settings, results.ranks)
        rows += [[name, 1e3 * trial.step, trial.why or "stable"] for trial in trials]
        results.say(f"{name}: " + (f"{1e3 * found[name].step:.2f} ms" if found[name] else "none"))
    results.curves("trials", ["method", "step [ms]", "outcome"], rows)
    return found


def step_table(results, name, scene, found, printed):
    """Steps beside theirs, which count at their spacing: both over that of ours."""
    def over(steps, one):
        return steps[one] / steps["ours"] if steps.get(one) is not None and steps.get("ours") else None

    ours = {method: best.step if best else 0 for method, best in found.items()}
    results.table(name, ["method", "step [ms]", "over ours", "theirs: step [ms]", "theirs: over ours"],
                  [[method, 1e3 * ours[method], over(ours, method),
                    1e3 * printed[method] if method in printed else None, over(printed, method)] for method in found])
    with results.figure(name, size=(7, 4)) as axes:
        names = list(found)
        axes.barh([k - 0.2 for k in range(len(names))], [over(ours, one) or 0 for one in names], 0.4, label="Treacle")
        axes.barh([k + 0.2 for k in range(len(names))], [over(printed, one) or 0 for one in names], 0.4,
                  label="dissertation")
        axes.set_yticks(range(len(names)), names, fontsize=8)
        axes.invert_yaxis()
        axes.set(xlabel=f"largest stable step over ours, {scene.name}")
        axes.legend(fontsize=8)


def draw(context, results, scene, name, step, settings, field="pressure"):
    """A picture at PICTURE_AT of a run of that step."""
    trial = try_step(context, scene, results.folder / "runs" / f"picture {name}", step, settings, results.ranks,
                     interval=PICTURE_AT / 2)
    if len(trial.run.frames()) < 3:
        results.say(f"{name} at {1e3 * step:.2f} ms ends before its picture: {trial.why}")
        return trial
    into = results.folder / name.replace(" ", "_")
    treacle(context, "render", trial.run.folder, "--field", field, "--frames", "2", "--no-movie", "--out", into,
            ranks=results.ranks)
    results.files += sorted(into.glob("*.png"))
    return trial


def cost_table(results, name, found, printed):
    rows = []
    for method, best in found.items():
        if best is None:
            rows.append([method, None, None, None, None, None, None, None, *printed.get(method, [None] * 6)])
            continue
        poisson, dirichlet, iterations, solve, total = cost_of(best.run)
        rows.append([method, particles_of(best.run), poisson, dirichlet, 1e3 * best.step, iterations, solve, total,
                     *printed.get(method, [None] * 6)])
    for row in rows:
        row[10] = None if row[10] is None else 1e3 * row[10]
    results.table(name, ["method", "liquid particles", "unknowns", "at p = 0", "step [ms]", "iterations",
                         "pressure [s/frame]", "total [s/frame]", "theirs: unknowns [k]", "theirs: at p = 0 [k]",
                         "theirs: step [ms]", "theirs: iterations", "theirs: pressure [s/frame]",
                         "theirs: total [s/frame]"], rows)


@entry("table-2.4", "Largest stable step and cost of each free-surface rule, a cube of water that falls")
def table_2_4(context, results):
    methods = {name: {**THEIRS, **RULES[name]} for name in TABLE_2_4}
    cost_table(results, "table-2.4", ladders(context, results, cube_drop(context), methods), TABLE_2_4)


@entry("figure-2.6", "Largest stable step of each free-surface rule, with and without clamped sources")
def figure_2_6(context, results):
    scene = cube_drop(context)
    methods = {name: {**THEIRS, **rule} for name, rule in RULES.items()}
    found = ladders(context, results, scene, methods)
    step_table(results, "figure-2.6", scene, found, FIGURE_2_6)
    step = (found["ours"].step if found["ours"] else scene.steps()[-1])
    for name in ("ours", "source-term-based", "density-based", "surface-based"):
        draw(context, results, scene, name, step, methods[name], "speed")


@entry("table-2.5", "Largest stable step and cost with solids as unknowns and with ours, dam break around a solid")
def table_2_5(context, results):
    cost_table(results, "table-2.5", ladders(context, results, dam_with_post(context), SOLIDS), TABLE_2_5)


@entry("figure-2.7", "Pressures with solids as unknowns and with ours, dam break around a solid")
def figure_2_7(context, results):
    scene = dam_with_post(context)
    step = 0.51e-3 * scene.spacing / 12.9e-3  # theirs for solids as unknowns: both are stable with it
    rows = []
    theirs = {"solids as unknowns": 1.88e4, "ours": 2.32e4}
    for name, settings in SOLIDS.items():
        trial = draw(context, results, scene, name, step, settings)
        pressures = [trial.run.frame(k)["pressure"].max() for k in range(1, len(trial.run.frames()))]
        rows.append([name, particles_of(trial.run), 1e3 * step, trial.why or "stable",
                     float(sum(pressures) / len(pressures)), theirs[name]])
    results.table("figure-2.7", ["method", "liquid particles", "step [ms]", "outcome", "mean of the largest pressure [Pa]",
                                 "theirs, at 1.09 ms [Pa]"], rows)


@entry("figure-2.4", "Largest stable step with the smooth kernel alone and with the blend, a ball that falls")
def figure_2_4(context, results):
    scene = ball_drop(context)
    methods = {"smooth kernel": {**THEIRS, "method.density.kind": "smooth"}, "ours": THEIRS}
    found = ladders(context, results, scene, methods)
    step_table(results, "figure-2.4", scene, found, {"smooth kernel": 1.03e-3, "ours": 1.4e-3})


@entry("figure-2.5", "Largest stable step with the spiky kernel alone and with the blend, a column that falls apart")
def figure_2_5(context, results):
    scene = column(context)
    methods = {"spiky kernel": {**THEIRS, "method.density.kind": "spiky"}, "ours": THEIRS}
    found = ladders(context, results, scene, methods)
    step_table(results, "figure-2.5", scene, found, {"spiky kernel": 0.73e-3, "ours": 1.07e-3})


@entry("figure-2.8", "Water falls on a solid that floats in the air")
def figure_2_8(context, results):
    scene = drop_on_ball(context)
    step = 0.5e-3 * scene.spacing / 12.9e-3
    rows = []
    for name, settings in SOLIDS.items():
        trial = draw(context, results, scene, name, step, settings)
        steps = trial.run.steps()
        rows.append([name, particles_of(trial.run), trial.why or "stable", float(steps["anchored"].mean())])
    results.table("figure-2.8", ["method", "liquid particles", "outcome", "anchors a step"], rows)


@entry("figure-3.4", "Pressures in a square: exact, solids as unknowns, and the unified term")
def figure_3_4(context, results):
    import numpy

    results.folder.mkdir(parents=True, exist_ok=True)
    table = results._new("pressures.csv")
    program = built(context, "sph_ranks_test", "tests")
    execute(context, launched(results.ranks, [program, "--gtest_filter=SquareDomain.*"]),
            env={"TREACLE_SQUARE": str(table)})
    with open(table, newline="") as file:
        rows = [[float(value) for value in row] for row in list(csv.reader(file))[1:]]
    x, y, exact, unified, unknowns = numpy.array(rows).T
    results.table("figure-3.4", ["method", "largest error over the largest pressure", "mean pressure over exact"],
                  [[name, float(abs(p - exact).max() / exact.max()), float(p.mean() / exact.mean())]
                   for name, p in (("solids as unknowns", unknowns), ("unified term", unified))])
    with results.figure("figure-3.4", columns=5, size=(3.4, 3)) as axes:
        pictures = (("exact", exact, "jet"), ("solids as unknowns", unknowns, "jet"),
                    ("exact less it", exact - unknowns, "Reds"), ("unified term", unified, "jet"),
                    ("exact less it", exact - unified, "Reds"))
        for one, (title, p, colours) in zip(axes, pictures):
            most = exact.max() if colours == "jet" else abs(exact - unknowns).max()
            dots = one.scatter(x, y, c=p, s=9, marker="s", cmap=colours, vmin=0, vmax=most)
            one.set(title=title, xticks=[], yticks=[], aspect="equal")
            one.figure.colorbar(dots, ax=one, shrink=0.8)
