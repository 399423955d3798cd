"""Plots of E (6.9) over viscosity, by the runs that searches made."""


def objective_table(results, name, studies, theirs):
    """Of the finest rung: the least E and where; of the first: how E grows to the ends. Points go into NAME-points.csv."""
    points, rows = [], []
    for one in studies:
        for cells in one.container.cells:
            points += [[one.liquid.name, trial.spacing, trial.viscosity, trial.objective] for trial in one.of_rung(cells)]
        coarse, best = one.of_rung(one.container.cells[0]), one.best()
        least = min(trial.objective for trial in coarse)
        rows.append([one.liquid.name, one.liquid.viscosity, one.found["value"], min(coarse, key=lambda trial: trial.objective).viscosity, best.viscosity,
                     least, best.objective, *(end.objective / least for end in (coarse[0], coarse[-1])), theirs])
    results.curves(f"{name}-points", ["liquid", "spacing [mm]", "viscosity [Pa s]", "E"], points)
    results.table(name, ["liquid", "viscosity [Pa s]", "found [Pa s]", "least E at, coarsest [Pa s]", "finest [Pa s]", "least E, coarsest", "finest",
                         "E at the lowest over least", "at the highest", "theirs"], rows)


def draw_rungs(axes, study):
    """E over viscosity, a line a rung, with the interval and the answer."""
    for cells in study.container.cells:
        trials = study.of_rung(cells)
        axes.plot([trial.viscosity for trial in trials], [trial.objective for trial in trials], "o-", markersize=4,
                  label=f"{1e3 * study.container.spacing(cells):.3g} mm")
    axes.axvspan(study.found["low"], study.found["high"], color="k", alpha=0.12, linewidth=0)
    axes.axvline(study.found["value"], color="k", linewidth=1, linestyle=":", label=f"found, {study.found['value']:.3g} Pa s")
    axes.set(xlabel="viscosity [Pa s]", ylabel="E (6.9)", xscale="log", yscale="log")


def draw_objectives(results, name, studies, label):
    """A panel a study; label: what the liquid's own viscosity is called."""
    import numpy

    columns = min(3, len(studies))
    with results.figure(name, columns=columns, rows=-(-len(studies) // columns), size=(4.2, 3.2)) as panels:
        for axes, one in zip(numpy.ravel(panels), studies):
            draw_rungs(axes, one)
            axes.axvline(one.liquid.viscosity, color="k", linewidth=1, label=f"{label}, {one.liquid.viscosity:g} Pa s")
            axes.set_title(one.liquid.name)
            axes.legend(fontsize=6)


def draw_convergence(results, name, lines):
    """Least E until each run of a search. lines: {panel: {label: list of E}}."""
    import numpy

    columns = min(3, len(lines))
    with results.figure(name, columns=columns, rows=-(-len(lines) // columns), size=(4.2, 3.2)) as panels:
        for axes, (title, searches) in zip(numpy.ravel(panels), lines.items()):
            for label, values in searches.items():
                axes.step(range(1, len(values) + 1), numpy.minimum.accumulate(values), where="post", label=label)
            axes.set(title=title, xlabel="runs of the search", ylabel="least E (6.9) until then", yscale="log")
            axes.legend(fontsize=7)
