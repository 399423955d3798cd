"""Table D.1: what the parts of a frame cost on the scenes of chapter 5."""

import dataclasses

from claims_lib.run import run_scene

from .costs import FRAME, bars
from .entries import entry

CORRECTION, COUPLING, FRACTIONS = "method.grid.correction.", "method.grid.coupling", "method.grid.fractions"
NONE, DISTANCE = ({CORRECTION + "method": name} for name in ("none", "distance"))
# Columns of steps.csv behind theirs: volume fractions, pressure, viscosity, density, rest.
PARTS = {"volume": ("surface",), "pressure": ("pressure",), "viscosity": ("viscosity",), "density": ("correct",),
         "rest": ("sort", "transfer", "move")}


@dataclasses.dataclass(frozen=True)
class Case:
    figure: str
    scene: str
    width: float     # of a cell of the dissertation's grid [m]
    settings: dict
    particles: float # theirs, thousands
    theirs: tuple    # seconds a frame on 24 cores: of PARTS, and in all


def coupled(figure, scene, width, particles, settings, one_way, weak, strong):
    """The same scene with the three couplings."""
    times = {"one_way": one_way, "weak": weak, "strong": strong}
    return [Case(f"{figure} {name}", scene, width, {COUPLING: name, **settings}, particles, theirs)
            for name, theirs in times.items()]


def falling(figure, viscosity, *times):
    return coupled(figure, "falling_ball", 0.01, 2405.0, {"liquids.syrup.viscosity": viscosity}, *times)


def gears(part, viscosity, *theirs):
    return Case(f"5.9 {part}", "gears", 0.0025, {"liquids.syrup.viscosity": viscosity}, 1805.0, theirs)


CASES = (
    Case("5.1 strong", "honey_dipper", 0.00125, {}, 2798.2, (8.9, 1.8, 20.4, 9.0, 5.7, 45.7)),
    Case("5.4 left", "dragon_ball", 0.005, {FRACTIONS: "independent"}, 800.5, (11.0, 4.7, 49.5, 5.5, 19.4, 90.2)),
    Case("5.4 middle", "dragon_ball", 0.005, {FRACTIONS: "supersampled"}, 800.5, (11.0, 5.7, 47.1, 5.3, 19.9, 89.0)),
    Case("5.4 right", "dragon_ball", 0.005, {}, 800.5, (12.5, 5.2, 51.7, 5.4, 19.6, 94.5)),
    *coupled("5.5", "bunny_pool", 0.01, 3721.8, {}, (12.3, 3.3, 32.7, 23.8, 32.6, 104.7), (15.3, 4.1, 44.0, 33.3, 40.3, 137.0),
             (11.2, 3.0, 42.2, 21.3, 26.7, 104.4)),
    Case("5.6 distance", "pile_up", 0.01, DISTANCE, 344.2, (12.9, 0.6, 5.9, 75.6, 3.8, 98.8)),
    Case("5.6 right", "pile_up", 0.01, {}, 344.2, (11.7, 0.6, 5.6, 11.7, 3.5, 33.1)),
    *falling("5.7, D.3", 1e3, (3.3, 1.3, 10.6, 16.9, 9.2, 40.7), (3.0, 1.2, 9.6, 16.2, 3.5, 33.5), (2.7, 1.1, 9.7, 7.3, 2.9, 23.7)),
    Case("5.8 left", "perforated_plates", 0.01, NONE, 1891.5, (43.4, 6.6, 38.6, 0.0, 71.5, 160.1)),
    Case("5.8 middle", "perforated_plates", 0.01, {**DISTANCE, CORRECTION + "iterations": 3}, 1891.5,
         (42.3, 9.3, 46.5, 39.3, 74.2, 211.6)),
    Case("5.8 right", "perforated_plates", 0.01, {}, 1891.5, (39.8, 8.6, 43.6, 22.1, 72.9, 187.1)),
    gears("left", 10, 152.1, 13.5, 81.8, 11.5, 82.8, 341.8),
    gears("middle", 100, 129.6, 11.0, 95.4, 9.4, 69.9, 315.2),
    gears("right", 1000, 84.8, 6.7, 101.1, 9.6, 45.1, 247.1),
    Case("5.10", "rotating_drum", 0.01, {}, 2756.6, (30.0, 5.5, 70.8, 28.4, 43.5, 178.2)),
    Case("5.11", "smoothie_glass", 0.01, {}, 258.5, (17.1, 1.5, 11.9, 16.1, 10.8, 57.4)),
    *falling("D.1", 10, (4.4, 1.8, 9.7, 21.0, 12.5, 49.5), (3.0, 1.2, 6.4, 16.3, 5.7, 32.6), (2.8, 1.1, 5.9, 15.1, 4.1, 29.0)),
    *falling("D.2", 100, (4.3, 1.7, 9.3, 22.3, 10.2, 47.8), (3.0, 1.2, 7.6, 16.0, 3.5, 31.3), (2.8, 1.2, 7.7, 8.1, 2.9, 22.8)),
    *falling("D.4", 1e4, (3.7, 1.4, 13.2, 17.6, 10.5, 46.3), (3.1, 1.1, 11.3, 16.8, 3.7, 36.0), (2.6, 1.0, 11.8, 6.9, 2.7, 24.9)),
    *falling("D.5", 1e5, (3.6, 1.6, 20.0, 18.0, 9.3, 52.5), (3.2, 1.2, 13.1, 17.6, 3.8, 39.0), (2.8, 1.0, 11.8, 7.4, 2.9, 25.8)),
)
QUICK_WIDTHS = 4  # a quick run's cells, over those of the dissertation
QUICK_END = 0.12  # [s]
SMALLEST_WIDTHS, SMALLEST_END = 6, 0.01
SMALLEST = ("5.4 right", "5.6 right", "5.7, D.3 strong")


def cases(context):
    """All, or of the smallest size those whose start takes little."""
    return [case for case in CASES if not context.smallest or case.figure in SMALLEST]


def run(context, results, case):
    settings = {"output.interval": 0, "domain.spacing": case.width, **case.settings}
    if context.quick:
        settings |= {"time.end": context.pick(None, QUICK_END, SMALLEST_END),
                     "domain.spacing": context.pick(None, QUICK_WIDTHS, SMALLEST_WIDTHS) * case.width}
    name = case.figure.replace(" ", "_").replace(",", "")
    return run_scene(context, context.root / f"inputs/{case.scene}/scene.yaml", context.scratch / name, ranks=results.ranks,
                     set=settings, timeout=96 * 3600)


@entry("table-D.1", "Seconds a frame of the parts of a step on the scenes of chapter 5", quick=540)
def table_d_1(context, results):
    rows = []
    for case in cases(context):
        finished = run(context, results, case)
        steps = finished.steps()
        frames = float(steps["time"][-1]) / FRAME
        parts = [float(sum(steps[column] for column in columns).sum()) / frames for columns in PARTS.values()]
        rows.append([case.figure, float(steps["particles"][0]) / 1000, case.particles, *parts, sum(parts), *case.theirs])
    names = [*PARTS, "total"]
    results.table("table_D.1", ["figure", "particles [1000]", "dissertation", *(f"{name} [s/frame]" for name in names),
                                *(f"{name}, dissertation" for name in names)], rows)
    with results.figure("table_D.1", size=(6, 9)) as axes:
        per_million = [[1000 * row[8] / row[1], 1000 * row[14] / row[2]] for row in rows]
        bars(axes, [row[0] for row in rows], *zip(*per_million), "total seconds a frame and million particles")
