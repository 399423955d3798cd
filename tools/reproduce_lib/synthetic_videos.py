"""Table 6.1 and figures 6.2, 6.4, 6.5 and 6.12: the six viscosities that films of runs were made with."""

from claims_lib.identify_container import THEIRS, Container

from .container_pictures import compared_frame, grid_of, overview
from .container_studies import Liquid, study_of
from .entries import entry
from .objectives import draw_objectives, objective_table

DENSITY = 1000  # [kg/m3]
RANGE = (0.3, 1000)  # of the search [Pa s]
IN_PLANE = "in the plane with --quick"
STUDIES = "synthetic videos"  # what the entries are of


def container(context):
    """The film and the finest rung have the same spacing, as the dissertation's films and searches come of one solver."""
    return context.pick(Container(density=DENSITY), Container(plane=True, density=DENSITY, frames=20, rate=25),
                        Container(plane=True, density=DENSITY, frames=8, rate=12, film_cells=5, cells=(5,), evaluations=3, noise_runs=0))


def study(context, results, viscosity):
    return study_of(context, results, Liquid(f"{viscosity:g} Pa s", viscosity, DENSITY), container(context), RANGE)


def studies(context, results):
    return [study(context, results, one) for one in context.pick(sorted(THEIRS), sorted(THEIRS), [10])]


def reynolds(one):
    """By the hole and the mean speed of what flows through it."""
    return one.liquid.density * one.found["speed"] * one.container.hole / one.liquid.viscosity


@entry("table-6.1", f"Viscosities found in synthetic videos of a container with a hole ({IN_PLANE})", quick=400, shares=STUDIES)
def table_6_1(context, results):
    rows, floors = [], []
    for one in studies(context, results):
        true, found = one.liquid.viscosity, one.found
        number, *errors = THEIRS[true]
        rows.append([true, reynolds(one), found["value"], found["low"], found["high"], 100 * abs(found["value"] / true - 1), 100 * found["pressure"],
                     100 * found["velocity"], len(one.trials()), number, *errors])
        floors.append([true, 100 * found["pressure floor"], 100 * found["velocity floor"]])
    titles = ["Re", "error of viscosity [%]", "of pressure [%]", "of velocity [%]"]
    results.table("table-6.1", ["viscosity [Pa s]", "Re", "found [Pa s]", "90 % from", "to", *titles[1:], "runs",
                                *(f"theirs: {title}" for title in titles)], rows)
    results.say("Re by the hole and the mean speed in it; the dissertation does not say by what its own is")
    results.say("what the same viscosity differs by when particles lie half a spacing elsewhere:")
    results.table("table-6.1-floor", ["viscosity [Pa s]", "pressure [%]", "velocity [%]"], floors)
    with results.figure("table-6.1", columns=3) as panels:
        for axes, ours, theirs, title in zip(panels, (5, 6, 7), (10, 11, 12), titles[1:]):
            axes.plot([row[0] for row in rows], [row[ours] for row in rows], "o-", label="ours")
            axes.plot([row[0] for row in rows], [row[theirs] for row in rows], "s--", markerfacecolor="none", label="dissertation")
            axes.set(xlabel="viscosity [Pa s]", ylabel=title if "error" in title else f"error {title}", xscale="log", ylim=(0, None))
        panels[0].legend(fontsize=8)


@entry("figure-6.5", f"Objective over viscosity for the synthetic videos of table 6.1 ({IN_PLANE})", quick=400, shares=STUDIES)
def figure_6_5(context, results):
    done = studies(context, results)
    objective_table(results, "figure-6.5", done, "least close to the true viscosity")
    draw_objectives(results, "figure-6.5", done, "true")


@entry("figure-6.12", f"Surfaces, pressures and speeds of the films' runs and of those with the found viscosities ({IN_PLANE})", quick=400, shares=STUDIES)
def figure_6_12(context, results):
    done = studies(context, results)
    results.table("figure-6.12", ["viscosity [Pa s]", "found [Pa s]", "error [%]", "theirs [%]"],
                  [[one.liquid.viscosity, one.found["value"], 100 * abs(one.found["value"] / one.liquid.viscosity - 1), THEIRS[one.liquid.viscosity][1]]
                   for one in done])
    names = {"truth": "film", "answer": "found"}
    grid_of(results, "figure-6.12", [[(f"{names[run]}, {(one.liquid.viscosity if run == 'truth' else one.found['value']):.3g} Pa s: {field}",
                                       one.picture(run, field)) for one in done] for field in ("liquid", "pressure", "speed") for run in names])


@entry("figure-6.4", f"A synthetic film, its simulation, both silhouettes and where they differ ({IN_PLANE})", quick=75, shares=STUDIES)
def figure_6_4(context, results):
    one = study(context, results, 10)
    share = compared_frame(results, "figure-6.4", one)
    results.table("figure-6.4", ["viscosity [Pa s]", "found [Pa s]", "pixels that differ, over those of the liquid [%]", "theirs"],
                  [[one.liquid.viscosity, one.found["value"], 100 * share, "thin lines along the contour"]])


@entry("figure-6.2", f"From a synthetic film to a viscosity: the stages of the identification ({IN_PLANE})", quick=75, shares=STUDIES)
def figure_6_2(context, results):
    one = study(context, results, 10)
    overview(results, "figure-6.2", one)
    results.table("figure-6.2", ["stage", "what it leaves"], [
        ["film", "film/film.mp4"], ["silhouettes", f"{len(list((one.folder / 'masks').glob('mask_*.png')))} masks"],
        ["simulations", f"{len(one.trials())} runs at {', '.join(f'{1e3 * one.container.spacing(n):.3g}' for n in one.container.cells)} mm and near these"],
        ["answer", f"{one.found['value']:.4g} Pa s, 90 % interval {one.found['low']:.4g} to {one.found['high']:.4g}; the film has {one.liquid.viscosity:g}"]])
