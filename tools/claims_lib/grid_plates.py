"""The scene of plates that press liquid through their holes, behind a row of `grid` and figure 5.8."""

import dataclasses
import math

from .run import last_words, read_frame, run_scene
from .table import CommandFailed, Figure

SCENE = "inputs/perforated_plates/scene.yaml"
CORRECTION = "method.grid.correction."
METHODS = {"density": {}, "distance": {CORRECTION + "method": "distance"}, "none": {CORRECTION + "method": "none"}}
# Of the scene [m]: the tank, and the upper side of the uppermost plate where it stops.
TANK_RADIUS, TOP = 0.4, 0.58
HOLES = ("middle_hole", "outer_hole")
COARSE = 0.05  # spacing of a quick run
PLATES, PLATE_HEIGHT, HOLES_A_PLATE, HOLE_RADIUS = 3, 0.08, 7, 0.065


@dataclasses.dataclass(frozen=True)
class Pressed:
    height: float   # over the lower of two holes of the uppermost plate [m]
    end: float      # when the run ended [s]; before the scene's end where the simulation failed
    above: float    # volume over that plate, by the number of particles, over what would be there if all other room were full
    crowded: float  # most particles of a cell, over the 8 of the start


SIMULATION_FAILED = 3  # exit code


def press(context, folder, method, *, ranks=2, settings=None):
    """The run, to its end or to where the simulation failed."""
    run = run_scene(context, context.root / SCENE, folder / method, ranks=ranks, timeout=24 * 3600, expect=None,
                    set={**METHODS[method], **(settings or {})})
    if run.finished.code not in (0, SIMULATION_FAILED):
        raise CommandFailed(f"exit code {run.finished.code}: {last_words(run.finished.output)}")
    return run


def crowding(frame, spacing):
    """Most particles of a cell, over the 8 of the start."""
    import numpy

    cells = numpy.floor(frame["position"] / spacing).astype(int)
    return float(numpy.unique(cells, axis=0, return_counts=True)[1].max() / 8)


def spacing_of(run):
    """[m], of effective.yaml, where every value is in SI."""
    lines = (run.folder / "effective.yaml").read_text().splitlines()
    return next(float(line.split()[1]) for line in lines if line.strip().startswith("spacing:"))


def pressed(run):
    measurements, spacing = run.measurements(), spacing_of(run)
    first, last = (read_frame(run.frames()[k][1]) for k in (0, -1))
    particle = spacing**3 / 8
    plates = PLATES * PLATE_HEIGHT * math.pi * (TANK_RADIUS**2 - HOLES_A_PLATE * HOLE_RADIUS**2)
    room = len(first["position"]) * particle + plates - TOP * math.pi * TANK_RADIUS**2
    above = int((last["position"][:, 2] > TOP).sum()) * particle
    return Pressed(min(float(measurements[hole][-1]) for hole in HOLES), float(measurements["time"][-1]), above / room, crowding(last, spacing))


def reaches_the_top(context, folder):
    """Figure: with the density constraints the liquid comes out above the uppermost plate, and cells keep their particles."""
    settings = {"domain.spacing": COARSE} if context.quick else {}
    runs = {method: press(context, folder, method, settings=settings) for method in METHODS}
    found = {method: pressed(run) for method, run in runs.items()}
    ours = found["density"]
    failed = {method: "" if run.finished.code == 0 else f" (failed at {found[method].end:.2f} s)" for method, run in runs.items()}
    text = "; ".join(f"{method}{failed[method]} {one.height:.3f} m, {100 * one.above:.0f} % of the liquid that has its place there, "
                     f"at most {one.crowded:.2f} times the particles in a cell" for method, one in found.items())
    return Figure(f"plates, whose top is at {TOP:g} m: {text}",
                  not failed["density"] and ours.height > TOP and ours.above > found["none"].above and ours.crowded < found["none"].crowded)
