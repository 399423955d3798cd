"""Table E.1, figures E.2 and E.3: viscosities from velocity fields around balls that fall."""

import dataclasses
import shutil

from claims_lib import identify_piv as piv
from claims_lib.run import Columns, RunFolder, treacle

from .entries import entry
from .studies import drop, once, study_folder

BALLS = {"plastic": piv.PLASTIC, "steel": piv.STEEL}
# Largest speed [m/s], Reynolds number, viscosity found [Pa s], its error [%].
THEIRS = {"plastic": (0.04, 0.47, 0.96, 6.80), "steel": (0.12, 1.07, 1.12, 8.73)}
FIELD_SHOWN = 8  # place among the fields
FIELDS = "synthetic fields of PIV around a ball that falls"
STUDIES = "velocity fields"  # what the entries are of


def sizes_of(context):
    return context.pick(piv.Sizes(8, (3, 4, 5)), piv.Sizes(3.5, (2, 2.5, 3)), piv.Sizes(2, (1.5,), step=0.8, evaluations=3, noise_runs=0))


def study(context, results, name):
    """Folder of the fields and of the search for a ball, and its numbers."""
    ball, sizes = dataclasses.replace(BALLS[name], end=context.pick(BALLS[name].end, BALLS[name].end, 0.08)), sizes_of(context)
    return study_folder(context, results, f"ball {name}", f"{ball} {sizes}", lambda folder: measured(context, results, folder, ball, sizes))


def measured(context, results, folder, ball, sizes):
    piv.write_scene(folder, ball, sizes)
    once(folder, "truth", lambda: piv.run_at(context, folder, "truth", ball, ball.viscosity, sizes.film))
    noise = folder / "noise.txt"
    once(folder, "fields", lambda: noise.write_text(piv.measure(context, folder, ball, sizes)))
    value, low, high, words, trials = piv.identify(context, folder, ball, sizes, noise.read_text())
    once(folder, "answer", lambda: piv.run_at(context, folder, "answer", ball, value, sizes.rungs[-1]))
    speed = -float(RunFolder(folder / "truth").bodies()["ball velocity z"].min())
    for run in ("truth", "answer"):
        draw(context, results, folder, run, ball, speed)
        shutil.copy(folder / run / "bodies.csv", folder / f"{run}_bodies.csv")
        drop(folder, run)
    return {"value": value, "low": low, "high": high, "words": words, "trials": trials, "speed": speed}


def draw(context, results, folder, run, ball, speed):
    """Section through the ball's axis at half of the time."""
    into = folder / f"{run}_pictures"
    treacle(context, "render", folder / run, "--camera", "automatic", "--field", "speed", "--range", f"0:{speed:.4g}", "--cut", f"y={300 * ball.radius:.6g} cm",
            "--frames", 16, "--no-movie", "--size", "640x960", "--out", into, ranks=results.ranks)
    next(into.glob("*.png")).rename(folder / f"{run}.png")
    shutil.rmtree(into)


def names(context):
    return list(BALLS)[:context.pick(2, 2, 1)]


@entry("table-E.1", f"Viscosities from {FIELDS}", quick=480, shares=STUDIES)
def table_e_1(context, results):
    rows = []
    for name in names(context):
        ball, (_, found) = BALLS[name], study(context, results, name)
        number = piv.reynolds(dataclasses.replace(ball, speed=found["speed"]))
        rows.append([name, piv.LIQUID_DENSITY, ball.viscosity, 1e3 * ball.radius, ball.density, found["speed"], number, found["value"], found["low"], found["high"],
                     100 * abs(found["value"] / ball.viscosity - 1), found["trials"], *THEIRS[name]])
    titles = ["largest speed [m/s]", "Re", "found [Pa s]", "error [%]"]
    results.table("table-E.1", ["ball", "liquid [kg/m3]", "viscosity [Pa s]", "radius [mm]", "ball [kg/m3]", *titles[:3], "90 % from", "to", titles[3], "runs",
                                *(f"theirs: {title}" for title in titles)], rows)
    results.say("fields of runs in a box of 6 x 6 x 12 radii, whose walls slow the ball: the dissertation's container has no stated size")


@entry("figure-E.2", f"Velocities measured, those that are valid, simulated ones and the differences: {FIELDS}", quick=240, shares=STUDIES)
def figure_e_2(context, results):
    import numpy
    from matplotlib import patches

    folder, found = study(context, results, "plastic")
    table = best_fields(folder)
    number = sorted(set(table["field"]))[FIELD_SHOWN]
    of = table["field"] == number
    x, y, u, v, simulated_u, simulated_v = (table[name][of] for name in ("x", "y", "measured u", "measured v", "simulated u", "simulated v"))
    raw = Columns(folder / f"fields/field_{int(number):04d}.csv")
    panels = {"measured": (1e-3 * raw["x"], 1e-3 * raw["y"], raw["u"], raw["v"]), "valid": (x, y, u, v), "simulated": (x, y, simulated_u, simulated_v),
              "difference": (x, y, u - simulated_u, v - simulated_v)}
    both = numpy.isfinite(simulated_u) & numpy.isfinite(u)
    norm = [float(numpy.sqrt(numpy.mean(a[both] ** 2 + b[both] ** 2))) for a, b in (panels["valid"][2:], panels["difference"][2:])]
    results.table("figure-E.2", ["field", "vectors", "valid", "root mean square [m/s]", "of the differences [m/s]", "ratio [%]", "theirs"],
                  [[int(number), len(raw), int(of.sum()), *norm, 100 * norm[1] / norm[0], "small beside the field"]])
    with results.figure("figure-E.2", columns=4, size=(3.4, 5)) as axes:
        for one, (title, (right, up, a, b)) in zip(axes, panels.items()):
            one.quiver(1e3 * right, 1e3 * up, a, b, numpy.hypot(a, b), cmap="jet", scale=12 * found["speed"], clim=(0, found["speed"]), width=0.006)
            one.add_patch(patches.Circle(ball_in_sheet(folder, int(number)), 1e3 * piv.PLASTIC.radius, facecolor="none", edgecolor="k"))
            one.set(title=title, xlabel="x in the sheet [mm]", ylabel="height in the sheet [mm]", aspect="equal")


def ball_in_sheet(folder, field):
    """Centre of the plastic ball in the sheet's axes at the time of a field [mm]."""
    height = Columns(folder / "truth_bodies.csv").at("ball position z", Columns(folder / "fields/times.csv")["time"][field])
    left, bottom = 0.6 * piv.PLASTIC.radius, 3 * piv.PLASTIC.radius
    return 1e3 * (3 * piv.PLASTIC.radius - left), 1e3 * (height - bottom)


def best_fields(folder):
    """Vectors measured and simulated of the trial whose differences are least."""
    tables = [Columns(path) for path in sorted((folder / "out/runs").glob("*/fields_ball.csv"))]
    return min(tables, key=mean_square)


def mean_square(table):
    import numpy

    return float(numpy.nanmean((table["measured u"] - table["simulated u"]) ** 2 + (table["measured v"] - table["simulated v"]) ** 2))


@entry("figure-E.3", f"A ball that falls: the run of the fields, and with the found viscosity ({FIELDS})", quick=240, shares=STUDIES)
def figure_e_3(context, results):
    import numpy

    folder, found = study(context, results, "plastic")
    ball, runs = BALLS["plastic"], {run: Columns(folder / f"{run}_bodies.csv") for run in ("truth", "answer")}
    times = numpy.linspace(0, runs["truth"]["time"][-1], 51)
    heights = {run: numpy.interp(times, table["time"], table["ball position z"]) for run, table in runs.items()}
    apart = float(abs(heights["truth"] - heights["answer"]).max())
    results.curves("figure-E.3-heights", ["time [s]", "height, run of the fields [m]", "with the found viscosity [m]"], zip(times, *heights.values()))
    results.table("figure-E.3", ["found [Pa s]", "falls by [mm]", "apart by at most [mm]", "over the radius [%]", "theirs"],
                  [[found["value"], 1e3 * float(numpy.ptp(heights["truth"])), 1e3 * apart, 100 * apart / ball.radius, "in good agreement"]])
    results.say("the found viscosity is that at spacing zero; in the run with it, coarser than that of the fields, the drag is less by what its spacing misses")
    from matplotlib import image

    labels = {"truth": f"run of the fields, {ball.viscosity} Pa s", "answer": f"found, {found['value']:.3g} Pa s"}
    with results.figure("figure-E.3", columns=3, size=(3.4, 4.6)) as panels:
        for axes, run in zip(panels, labels):
            axes.set_axis_off()
            axes.set_title(labels[run], fontsize=9)
            axes.imshow(image.imread(folder / f"{run}.png"))
        for run, style in (("truth", "-"), ("answer", "--")):
            panels[2].plot(times, 1e3 * heights[run], style, label=labels[run])
        panels[2].set(xlabel="time [s]", ylabel="height of the ball [mm]")
        panels[2].legend(fontsize=7)
