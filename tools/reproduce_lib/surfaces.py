"""Tables 2.4 and 2.5, figures 2.4 to 2.8: densities, free surfaces and solids, ours and what they replace."""

from claims_lib.surfaces import FINE, RULES, STABLE, THEIRS, Scene, cube_drop, largest_stable, rule_settings, try_step

from .costs import FRAME, bars, pressure_seconds, total_seconds
from .entries import entry
from .pictures import drawn

FINE_SOLIDS = 12.9e-3 # of the dissertation's table 2.5 and figure 2.7 [m]
PICTURES_AT, PICTURE_INTERVAL = (0.15, 0.3), 0.05 # [s]
SPEED = ("speed", "0:4") # what pictures show, and its range

SCENE = """schema_version: 1
title: {title}
domain:
  max: {size}
  spacing: $spacing
  boundaries: {{z_max: {{kind: open, outflow: true}}}}
liquids:
  - name: water
    density: 1000
    shapes:
      - {shape}
{bodies}time: {{end: 0.6, rule: fixed, step: $step}}
output: {{interval: $interval}}
method: {{pressure: {{wall_contact: none}}}} # to count what pressures alone do not hold
max_lost_fraction: 0.001
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


def scene_of(title, size, shape, spacing, body=None):
    bodies = BODY.format(shape=body) if body else ""
    return Scene(title, SCENE.format(title=title, size=size, shape=shape, bodies=bodies), spacing)


def ball_drop(context):
    return scene_of("A ball of water falls", "[0.9, 0.9, 0.9]", "sphere: {centre: [0.45, 0.45, 0.45], radius: 0.26}",
                    context.pick(FINE, 32e-3, 60e-3))


def column(context):
    return scene_of("A column of water falls apart", "[0.9, 0.9, 1.2]", "box: {min: [0, 0, 0], max: [0.35, 0.35, 0.9]}",
                    context.pick(FINE, 32e-3, 60e-3))


def dam_with_post(context):
    return scene_of("Dam break around a post on the floor", "[1.2, 0.55, 1]", "box: {min: [0, 0, 0], max: [0.5, 0.55, 0.6]}",
                    context.pick(FINE_SOLIDS, 30e-3, 60e-3), "box: {min: [0.8, 0.2, -0.05], max: [0.95, 0.35, 0.3]}")


def drop_on_ball(context):
    return scene_of("Water falls on a ball in the air", "[0.9, 0.9, 0.9]",
                    "box: {min: [0.325, 0.325, 0.55], max: [0.575, 0.575, 0.85]}", context.pick(FINE_SOLIDS, 25e-3, 50e-3),
                    "sphere: {centre: [0.45, 0.45, 0.4], radius: 0.13}")


def cost_of(run):
    """Means of the unknowns, particles at p = 0, iterations, and seconds a frame of the pressure solve and in total."""
    steps = run.steps()
    frames = steps["time"][-1] / FRAME
    return (float(steps["poisson"].mean()), float(steps["dirichlet"].mean()), float(steps["pressure iterations"].mean()),
            float(pressure_seconds(steps).sum() / frames), float(total_seconds(steps).sum() / frames))


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


def over(values, one):
    """Of one method over that of ours, None where either is missing."""
    return values[one] / values["ours"] if values.get(one) is not None and values.get("ours") else None


def draw_steps(axes, scene, found, printed, spacing):
    """Steps over the spacing, with which they grow; theirs, printed [s], are at another one [m]."""
    bars(axes, list(found), [best and 1e3 * best.step / (1e2 * scene.spacing) for best in found.values()],
         [1e3 * printed.get(method, 0) / (1e2 * spacing) for method in found],
         "largest stable step over the spacing [ms/cm]")


def step_table(results, name, scene, found, printed, spacing=FINE):
    """Steps beside theirs, printed [s] at a spacing [m], and both over that of ours."""
    ours = {method: best.step if best else 0 for method, best in found.items()}
    results.table(name, ["method", "step [ms]", "over ours", "theirs: step [ms]", "theirs: over ours"],
                  [[method, 1e3 * ours[method], over(ours, method),
                    1e3 * printed[method] if method in printed else None, over(printed, method)] for method in found])
    with results.figure(name, size=(7, 1.6 + 0.35 * len(found))) as axes:
        draw_steps(axes, scene, found, printed, spacing)
        axes.set_title(f"{scene.name}, spacing {1e3 * scene.spacing:.1f} mm, theirs {1e3 * spacing:.1f} mm", fontsize=9)


def draw(context, results, scene, name, step, settings, shown):
    """A run of that step, and its pictures at PICTURES_AT as a row (title, path). shown: a field and its range."""
    trial = try_step(context, scene, results.folder / "runs" / f"picture {name}", step, settings, results.ranks,
                     interval=PICTURE_INTERVAL)
    frames, row = trial.run.frames(), []
    for time in PICTURES_AT:
        number = min(round(time / PICTURE_INTERVAL), len(frames) - 1)
        title = f"{name}, {1e3 * step:.2f} ms, at {frames[number][0]:.2f} s"
        if frames[number][0] < time - PICTURE_INTERVAL / 2:
            title += f": the last before the end, {trial.why}"
        row.append((title, drawn(context, results, trial.run, *shown, number)))
    return trial, row


def cost_table(results, name, scene, found, printed, spacing):
    """Costs of the largest stable steps, beside theirs at a spacing [m]."""
    header = ("liquid particles", "unknowns", "at p = 0", "step [ms]", "iterations", "pressure [s/frame]",
              "total [s/frame]")
    printed_header = ("unknowns [k]", "at p = 0 [k]", "step [ms]", "iterations", "pressure [s/frame]", "total [s/frame]")
    rows, totals = [], {}
    for method, best in found.items():
        ours = [None] * len(header)
        if best is not None:
            poisson, dirichlet, iterations, solve, total = cost_of(best.run)
            ours = [particles_of(best.run), poisson, dirichlet, 1e3 * best.step, iterations, solve, total]
            totals[method] = total
        unknowns, at_zero, step, *rest = printed[method]
        rows.append([method, *ours, unknowns, at_zero, 1e3 * step, *rest])
    results.table(name, ["method", *header, *(f"theirs: {title}" for title in printed_header)], rows)
    with results.figure(name, columns=2, size=(6, 1.6 + 0.35 * len(found))) as (left, right):
        draw_steps(left, scene, found, {method: values[2] for method, values in printed.items()}, spacing)
        theirs = {method: values[5] for method, values in printed.items()}
        bars(right, list(found), [over(totals, one) for one in found], [over(theirs, one) for one in found],
             "seconds a frame over ours, each at its largest step")


def kernel_steps(context, results, name, scene, kernel, printed):
    """Largest stable steps with one of the two kernels alone and with the blend of both. printed: theirs [s]."""
    methods = {f"{kernel} kernel": {**THEIRS, "method.density.kind": kernel}, "ours": THEIRS}
    step_table(results, name, scene, ladders(context, results, scene, methods),
               dict(zip(methods, printed)))


def with_solids(context, results, name, scene, step, shown, header, values):
    """Pictures of both ways with solids in runs of one step, and a table: values(method, Trial) of each."""
    rows, pictures = [], []
    for method, settings in SOLIDS.items():
        trial, row = draw(context, results, scene, method, step, settings, shown)
        rows.append([method, particles_of(trial.run), 1e3 * step, trial.why or "stable", *values(method, trial)])
        pictures.append(row)
    results.table(name, ["method", "liquid particles", "step [ms]", "outcome", *header], rows)
    results.pictures(name, pictures)


@entry("table-2.4", "Largest stable step and cost of each free-surface rule, a cube of water that falls", quick=170)
def table_2_4(context, results):
    methods = {name: rule_settings(name) for name in TABLE_2_4}
    scene = cube_drop(context)
    cost_table(results, "table-2.4", scene, ladders(context, results, scene, methods), TABLE_2_4, FINE)


@entry("figure-2.6", "Largest stable step of each free-surface rule, with and without clamped sources", quick=300)
def figure_2_6(context, results):
    scene = cube_drop(context)
    methods = {name: rule_settings(name) for name in RULES}
    found = ladders(context, results, scene, methods)
    step_table(results, "figure-2.6", scene, found, FIGURE_2_6)
    step = (found["ours"].step if found["ours"] else scene.steps()[-1])
    shown = ("ours", "source-term-based", "density-based", "surface-based")[:context.pick(4, 4, 1)]
    results.pictures("pictures", [draw(context, results, scene, name, step, methods[name], SPEED)[1] for name in shown])


@entry("table-2.5", "Largest stable step and cost with solids as unknowns and with ours, dam break around a solid", quick=120)
def table_2_5(context, results):
    scene = dam_with_post(context)
    cost_table(results, "table-2.5", scene, ladders(context, results, scene, SOLIDS), TABLE_2_5, FINE_SOLIDS)


@entry("figure-2.7", "Pressures with solids as unknowns and with ours, dam break around a solid", quick=140)
def figure_2_7(context, results):
    scene = dam_with_post(context)
    theirs = {"solids as unknowns": 1.88e4, "ours": 2.32e4}  # the dissertation's section 2.5.4

    def values(method, trial):
        pressures = [trial.run.frame(k)["pressure"].max() for k in range(1, len(trial.run.frames()))]
        return float(sum(pressures) / len(pressures)), theirs[method]

    # Theirs for solids as unknowns: both are stable with it.
    with_solids(context, results, "figure-2.7", scene, 0.51e-3 * scene.spacing / FINE_SOLIDS,
                ("pressure", "0:6000"), ("mean of the largest pressure [Pa]", "theirs, at 1.09 ms [Pa]"), values)


@entry("figure-2.4", "Largest stable step with the smooth kernel alone and with the blend, a ball that falls", quick=120)
def figure_2_4(context, results):
    kernel_steps(context, results, "figure-2.4", ball_drop(context), "smooth", (1.03e-3, 1.4e-3))


@entry("figure-2.5", "Largest stable step with the spiky kernel alone and with the blend, a column that falls apart",
       quick=120)
def figure_2_5(context, results):
    kernel_steps(context, results, "figure-2.5", column(context), "spiky", (0.73e-3, 1.07e-3))


@entry("figure-2.8", "Water falls on a solid that floats in the air", quick=25)
def figure_2_8(context, results):
    scene = drop_on_ball(context)
    with_solids(context, results, "figure-2.8", scene, 0.5e-3 * scene.spacing / FINE_SOLIDS, SPEED,
                ("largest speed [m/s]", "theirs"),
                lambda method, trial: (float(trial.run.steps()["max speed"].max()),
                                       "stable" if method == "ours" else "not shown"))
