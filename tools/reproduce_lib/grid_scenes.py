"""Figures 5.4, 5.6 and 5.8: the volume fractions, and the correction of places, on their scenes."""

from claims_lib import grid_plates
from claims_lib.run import read_frame, run_scene

from .entries import entry
from .pictures import drawn

FRACTIONS = {"independent": "particles float under the dragon", "supersampled": "particles float under the dragon",
             "consistent": "none float"}


def scene(context, name):
    return context.root / f"inputs/{name}/scene.yaml"


def floating(frame, before, interval, spacing):
    """Particles in the air, with fewer than three others in the 27 cells about them, that gain less than half of the speed
    that free fall would give them between two frames."""
    import numpy

    index = {id: k for k, id in enumerate(before["id"])}
    cells = numpy.floor(frame["position"] / spacing).astype(int)
    counts = {}
    for cell in map(tuple, cells):
        counts[cell] = counts.get(cell, 0) + 1
    around = [(x, y, z) for x in (-1, 0, 1) for y in (-1, 0, 1) for z in (-1, 0, 1)]
    found = 0
    for k, cell in enumerate(cells):
        near = sum(counts.get((cell[0] + x, cell[1] + y, cell[2] + z), 0) for x, y, z in around)
        if near > 3 or frame["position"][k, 2] < 2 * spacing or frame["id"][k] not in index:
            continue
        gained = before["velocity"][index[frame["id"][k]], 2] - frame["velocity"][k, 2]
        found += gained < 0.5 * 9.81 * interval
    return found


@entry("figure-5.4", "A ball of syrup on a dragon, by the volume fractions", quick=540)
def figure_5_4(context, results):
    settings = {"output.interval": 0.025, "output.fields": "[id, velocity]"}
    settings["domain.spacing"] = context.pick(0.005, 0.02, 0.03)
    if context.smallest:
        settings["time.end"] = 0.05
    rows, pictures = [], []
    for fractions, theirs in FRACTIONS.items():
        run = run_scene(context, scene(context, "dragon_ball"), context.scratch / fractions, ranks=results.ranks,
                        set={"method.grid.fractions": fractions, **settings}, timeout=48 * 3600)
        frames = run.frames()
        counts = []
        for (_, one), (_, next_) in zip(frames[:-1], frames[1:]):
            counts.append(floating(read_frame(next_), read_frame(one), settings["output.interval"], settings["domain.spacing"]))
        steps = run.steps()
        rows.append([fractions, max(counts), sum(counts) / len(counts), float(steps["surface"].mean()),
                     float(steps["viscosity iterations"].mean()), theirs])
        pictures.append((fractions, drawn(context, results, run, "speed", "0:2.5", len(frames) - 1)))
    results.table("figure_5.4", ["fractions", "floating particles, most", "mean of the frames", "surface and fractions [s/step]",
                                 "viscous iterations", "theirs"], rows)
    results.pictures("figure_5.4", [pictures])


CORRECTION = "method.grid.correction."
OWN = {CORRECTION + "neighbour_constraints": "false"}
# Theirs: seconds a frame of table D.1, with 50 iterations at most.
PILE_UP = {
    "distance": ({CORRECTION + "method": "distance"}, 75.6),
    "own constraints": ({**OWN}, 29.7),
    "own constraints, scaled": ({**OWN, CORRECTION + "scale_max": 5}, 11.7),
    "all constraints": ({}, None),
}


@entry("figure-5.6", "Iterations and densities of the correction of places where bunnies pile up", quick=480)
def figure_5_6(context, results):
    from .costs import FRAME

    settings = {"output.interval": 0.1, CORRECTION + "dead_band": 0, "domain.spacing": context.pick(0.01, 0.025, 0.05)}
    if context.smallest:
        settings["time.end"] = 0.02
    rows, curves = [], []
    with results.figure("figure_5.6", columns=2) as axes:
        for name, (method, theirs) in PILE_UP.items():
            run = run_scene(context, scene(context, "pile_up"), context.scratch / name.replace(" ", "_").replace(",", ""),
                            ranks=results.ranks, set={**settings, **method}, timeout=48 * 3600)
            steps = run.steps()
            time, iterations, density = steps["time"], steps["correction iterations"], 1 + steps["density error after"]
            curves += [[name, *map(float, line)] for line in zip(time, iterations, density)]
            axes[0].plot(time, iterations, label=name)
            axes[1].plot(time, density, label=name)
            rows.append([name, float(iterations.mean()), float(density.max()), float(density.mean()),
                         float(steps["correct"].sum() / time[-1] * FRAME), theirs])
        axes[0].set(xlabel="time [s]", ylabel="iterations of a correction")
        axes[1].set(xlabel="time [s]", ylabel="largest density after it, over the rest density")
        axes[0].legend(fontsize=8)
    results.table("figure_5.6", ["method", "iterations", "largest density", "its mean", "correction [s/frame]",
                                 "dissertation [s/frame]"], rows)
    results.curves("figure_5.6_curves", ["method", "time [s]", "iterations", "largest density over rest density"], curves)


REACHES = {"none": "no", "distance": "no; with 50 iterations yes, less than by density", "density": "yes"}


@entry("figure-5.8", "Plates press liquid through their holes, by the correction of places", quick=480)
def figure_5_8(context, results):
    settings = {"domain.spacing": grid_plates.COARSE if context.quick else 0.01}
    if context.smallest: # coarser plates would have no holes
        settings["time.end"] = 0.005
    rows, curves, pictures = [], [], []
    with results.figure("figure_5.8") as axes:
        for method, theirs in list(REACHES.items())[context.pick(0, 0, -1):]:
            run = grid_plates.press(context, context.scratch, method, ranks=results.ranks, settings=settings)
            found, spacing = grid_plates.pressed(run), grid_plates.spacing_of(run)
            crowding = [(time, grid_plates.crowding(read_frame(path), spacing)) for time, path in run.frames()]
            curves += [[method, time, most] for time, most in crowding]
            axes.plot(*zip(*crowding), label=method)
            rows.append([method, found.height, 100 * found.above, found.crowded, theirs])
            pictures.append((method, drawn(context, results, run, "speed", "0:1", len(run.frames()) - 1)))
        axes.set(xlabel="time [s]", ylabel="most particles of a cell, over 8")
        axes.legend(fontsize=8)
    results.table("figure_5.8", ["method", f"height, of {grid_plates.TOP:g} to reach [m]", "volume above the plates [%]",
                                 "most particles of a cell over 8", "theirs: reaches the top"], rows)
    results.curves("figure_5.8_curves", ["method", "time [s]", "most particles of a cell over 8"], curves)
    results.pictures("figure_5.8_pictures", [pictures])
