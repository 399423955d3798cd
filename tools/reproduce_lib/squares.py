"""Figures 3.4 and 3.5: pressures in a square, one layer of particles, by tests that write what they solve for."""

import csv

from claims_lib.run import built, execute, launched

from .entries import entry

PASCALS_SHOWN = 1e-3  # plots are in kPa


def pressures(context, results, name, test, variable):
    """Rows of the file that a test of sph_ranks_test writes when a variable names it; each a dict of texts."""
    table = results.new(f"{name}.csv")
    program = built(context, "sph_ranks_test", "tests")
    execute(context, launched(results.ranks, [program, f"--gtest_filter={test}.*"]), env={variable: str(table)})
    with open(table, newline="") as file:
        return list(csv.DictReader(file))


def columns(rows, *names):
    import numpy

    return [numpy.array([float(row[name]) for row in rows]) for name in names]


def draw(axes, places, p, title, *, most, colours="jet", least=0):
    dots = axes.scatter(*places, c=PASCALS_SHOWN * p, s=14, marker="s", cmap=colours, vmin=PASCALS_SHOWN * least,
                        vmax=PASCALS_SHOWN * most)
    axes.set(title=title, xticks=[], yticks=[], aspect="equal")
    axes.figure.colorbar(dots, ax=axes, shrink=0.8, label="kPa")


@entry("figure-3.4", "Pressures in a square: exact, solids as unknowns, and the unified term", quick=2)
def figure_3_4(context, results):
    rows = pressures(context, results, "pressures", "SquareDomain", "TREACLE_SQUARE")
    x, y, exact, unified, unknowns = columns(rows, "x [d]", "y [d]", "exact [Pa]", "unified [Pa]",
                                             "solids as unknowns [Pa]")
    results.table("figure-3.4", ["method", "largest error over the largest pressure", "mean pressure over exact",
                                 "theirs"],
                  [[name, float(abs(p - exact).max() / exact.max()), float(p.mean() / exact.mean()), theirs]
                   for name, p, theirs in (("solids as unknowns", unknowns, "too low everywhere"),
                                           ("unified term", unified, "no error to be seen"))])
    with results.figure("figure-3.4", columns=5, size=(3.6, 3)) as axes:
        pictures = (("exact", exact, "jet"), ("solids as unknowns", unknowns, "jet"),
                    ("exact less these", exact - unknowns, "Reds"), ("unified term", unified, "jet"),
                    ("exact less these", exact - unified, "Reds"))
        for one, (title, p, colours) in zip(axes, pictures):
            most = exact.max() if colours == "jet" else abs(exact - unknowns).max()
            draw(one, (x, y), p, title, most=most, colours=colours)


# What the dissertation's pressures are like beside those of its grid.
FIGURE_3_5 = {"in order": None, "out of order": "larger", "closer": "smaller"}


@entry("figure-3.5", "Pressures on particles and on the grid beside them, before and after the best lambda", quick=2)
def figure_3_5(context, results):
    import numpy

    rows = pressures(context, results, "pressures", "Correspondence", "TREACLE_CORRESPONDENCE")
    line, drawn = [], []
    for name, theirs in FIGURE_3_5.items():
        x, y, particles, grid = columns([row for row in rows if row["particles stand"] == name], "x [d]", "y [d]",
                                        "particles [Pa]", "grid [Pa]")
        factor = float(particles @ grid / (grid @ grid))
        error = [float(numpy.linalg.norm(particles - share * grid) / numpy.linalg.norm(particles))
                 for share in (1, factor)]
        line.append([name, factor, *error, theirs])
        drawn.append((name, (x, y), particles, grid, factor))
    results.table("figure-3.5", ["particles stand", "best lambda", "difference before", "difference with it",
                                 "theirs: particles beside the grid"], line)
    with results.figure("figure-3.5", columns=5, rows=2, size=(3.6, 3)) as axes:
        for row, (name, places, particles, grid, factor) in zip(axes, drawn[1:]):
            most, apart = max(particles.max(), grid.max()), abs(particles - grid).max()
            for one, p, title in ((row[0], grid, "grid"), (row[1], particles, f"particles, {name}"),
                                  (row[3], factor * grid, f"grid, lambda = {factor:.2f}")):
                draw(one, places, p, title, most=most)
            for one, p in ((row[2], grid), (row[4], factor * grid)):
                draw(one, places, particles - p, "particles less it", most=apart, least=-apart, colours="bwr")
