"""Table 6.2 and figures 6.6, 6.7 and 6.8: liquids of the dissertation's real videos, as films of finer runs that have their viscosities."""

from claims_lib import identify_container as containers
from claims_lib.identify_container import Container

from .container_pictures import film_cell, grid_of, shown_frame
from .container_studies import Liquid, study_of
from .entries import entry
from .objectives import draw_convergence, draw_objectives, objective_table
from .studies import once

RANGE = (0.02, 100)  # of the search [Pa s]
SCALE = 0.5          # of the container over that of table 6.1
# Viscosities of table 6.2, usual densities (the dissertation names none).
LIQUIDS = [Liquid("caramel", 0.19, 1330), Liquid("red hand soap", 0.22, 1020), Liquid("chocolate syrup", 1.25, 1300),
           Liquid("purple body soap", 4.74, 1030), Liquid("blue liquid soap", 5.82, 1030), Liquid("honey", 7.86, 1420)]
# Reynolds number, minutes of an iteration, hours of the identification, speeds in the video and in the simulation [cm/s].
THEIRS = {"caramel": (31.6, 26.3, 10.8, 6.1, 6.7), "red hand soap": (27.2, 14.3, 13.9, 5.2, 5.8), "chocolate syrup": (4.8, 15.2, 7.7, 4.5, 5.3),
          "purple body soap": (0.633, 19.4, 11.7, 1.7, 1.5), "blue liquid soap": (0.515, 8.6, 8.0, 1.1, 1.3), "honey": (0.267, 7.5, 9.0, 0.6, 0.6)}
MOST_RUNS = 200                                 # of the dissertation's search, 25 iterations of 8 runs
BY_THEIR_SEARCH = ("chocolate syrup", "honey")  # with --quick
STAND_INS = "synthetic stand-ins of the real videos (in the plane with --quick)"
STUDIES = "real videos"  # what the entries are of


def container(context, liquid):
    """Filmed finer than the finest rung, half a frame off: no run of the search is the film's own, and the answer is that at spacing zero."""
    common = {"scale": SCALE, "density": liquid.density, "phase": 0.5, "answer": "extrapolated"}
    return context.pick(Container(film_cells=14, **common), Container(plane=True, frames=20, rate=25, film_cells=20, **common),
                        Container(plane=True, frames=8, rate=12, film_cells=5, cells=(5,), evaluations=3, noise_runs=0, **common))


def studies(context, results):
    return [study_of(context, results, one, container(context, one), RANGE) for one in context.pick(LIQUIDS, LIQUIDS, LIQUIDS[-1:])]


@entry("table-6.2", f"Viscosities and speeds of the front: {STAND_INS}", quick=500, shares=STUDIES)
def table_6_2(context, results):
    rows = []
    for one in studies(context, results):
        seconds = [trial.seconds for trial in one.trials()]
        filmed, run = (speed and 100 * speed for speed in (one.found["filmed front"], one.found["front of the run"]))
        number = one.liquid.density * one.found["speed"] * one.container.hole / one.liquid.viscosity
        theirs = THEIRS[one.liquid.name]
        rows.append([one.liquid.name, number, one.liquid.viscosity, one.found["value"], one.found["low"], one.found["high"], sum(seconds) / len(seconds) / 60,
                     sum(seconds) / 3600, filmed, run, theirs[0], *theirs[1:]])
    titles = ["Re", "t [min]", "T [h]", "v^ [cm/s]", "v [cm/s]"]
    results.table("table-6.2", ["liquid", "Re", "viscosity [Pa s]", "found [Pa s]", "90 % from", "to", *titles[1:],
                                *(f"theirs: {title}" for title in titles)], rows)
    results.say("v^: of the front in the film's silhouettes; v: in the run with the found viscosity. Films of runs with the dissertation's viscosities, since its "
                "videos are not public; its container's size is not known, so speeds compare with each other, not with theirs. t: mean of a run here, of an iteration there")
    with results.figure("table-6.2") as axes:
        for names, columns, style in (("ours", (8, 9), "o"), ("dissertation", (13, 14), "s")):
            of = [row for row in rows if row[columns[0]] and row[columns[1]]]
            axes.plot([row[columns[0]] for row in of], [row[columns[1]] for row in of], style, markerfacecolor="none", label=names)
        ends = axes.get_xlim()
        axes.plot(ends, ends, "k:", linewidth=1)
        axes.set(xlabel="speed of the front in the film [cm/s]", ylabel="with the found viscosity [cm/s]", xscale="log", yscale="log")
        axes.legend(fontsize=8)


@entry("figure-6.6", f"Films, simulations, pressures and speeds: {STAND_INS}", quick=500, shares=STUDIES)
def figure_6_6(context, results):
    done = studies(context, results)
    results.table("figure-6.6", ["liquid", "viscosity [Pa s]", "found [Pa s]"], [[one.liquid.name, one.liquid.viscosity, one.found["value"]] for one in done])
    grid_of(results, "figure-6.6", [[(f"{one.liquid.name}, film", film_cell(one, shown_frame(one))) for one in done],
                                    *([(f"{one.found['value']:.3g} Pa s: {field}", one.picture("answer", field)) for one in done]
                                      for field in ("liquid", "pressure", "speed"))])


@entry("figure-6.7", f"Objective over viscosity: {STAND_INS}", quick=500, shares=STUDIES)
def figure_6_7(context, results):
    done = studies(context, results)
    objective_table(results, "figure-6.7", done, "one least value each")
    draw_objectives(results, "figure-6.7", done, "film")


def their_search(context, study):
    """E of the runs of section 6.5.5's search, CMA-ES without a logarithm, at the coarsest rung's spacing."""
    name = "their_search"
    keys = {"search.method": "dissertation", "parameters.0.scale": "linear", "search.rungs": "[]", "search.noise_runs": 0,
            "search.evaluations": context.pick(MOST_RUNS, 40, 8)}
    words = [word for key, value in keys.items() for word in ("--set", f"{key}={value}")]
    once(study.folder, name, lambda: containers.identify(context, study.folder, *words, name=name))
    return study.searched(name)


@entry("figure-6.8", f"Convergence of the search, and of the dissertation's CMA-ES for two liquids: {STAND_INS}", quick=590, shares=STUDIES)
def figure_6_8(context, results):
    lines, rows = {}, []
    for one in studies(context, results):
        searches = {"ours": one.searched()}
        if one.liquid.name in BY_THEIR_SEARCH or not context.quick:
            searches["CMA-ES of section 6.5.5"] = their_search(context, one)
        lines[one.liquid.name] = searches
        least = min(min(values) for values in searches.values())
        rows += [[one.liquid.name, label, len(values), min(values), next((k for k, value in enumerate(values, 1) if value <= 1.1 * least), None),
                  "25 to 72 iterations"] for label, values in searches.items()]
    results.curves("figure-6.8-runs", ["liquid", "search", "run", "E"],
                   [[liquid, label, k, value] for liquid, searches in lines.items() for label, values in searches.items() for k, value in enumerate(values, 1)])
    results.table("figure-6.8", ["liquid", "search", "runs of the search", "least E", "runs to within 10 % of the least of both", "theirs"], rows)
    draw_convergence(results, "figure-6.8", lines)
