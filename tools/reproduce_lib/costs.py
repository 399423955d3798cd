"""What runs cost, from their steps, as the dissertation's tables count it, and how its plots are drawn."""

from claims_lib.iisph import OURS

FRAME = 1 / 60  # [s]
PHASES = ("sort", "neighbours", "density", "forces", *OURS, "pressure force", "move")


def pressure_seconds(steps):
    """Of each step: the pressure solve with all that only it needs."""
    return sum(steps[phase] for phase in OURS)


def total_seconds(steps):
    return sum(steps[phase] for phase in PHASES if phase in steps)


def iterations_over_time(axes, rows, labels, column=0):
    """Draws the rows (..., time [s], iterations) of each label, by a column: each step, and a running mean."""
    import numpy

    for label in labels:
        of = [row[-2:] for row in rows if row[column] == label]
        if not of:
            continue
        time, count = numpy.array(of, dtype=float).T
        window = numpy.ones(max(1, len(of) // 25))
        mean = numpy.convolve(count, window, "same") / numpy.convolve(numpy.ones(len(of)), window, "same")
        line, = axes.plot(time, mean, lw=1.5, label=f"{label}")
        axes.plot(time, count, lw=0.4, alpha=0.4, color=line.get_color())
    axes.set(xlabel="time [s]", ylabel="iterations a step, and their running mean")
    axes.set_ylim(bottom=0)


def bars(axes, names, ours, theirs, title):
    """Pairs of bars by name; None, or 0: nothing was found."""
    places = range(len(names))
    axes.barh([k - 0.2 for k in places], [value or 0 for value in ours], 0.4, color="tab:blue", label="Treacle")
    axes.barh([k + 0.2 for k in places], [value or 0 for value in theirs], 0.4, color="none", edgecolor="black",
              hatch="///", label="dissertation")
    axes.set_yticks(places, names, fontsize=8)
    axes.invert_yaxis()
    axes.set(xlabel=title)
    axes.legend(fontsize=8)
