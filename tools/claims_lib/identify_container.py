"""Rows of `identify` on a container with a hole: the six viscosities of Table 6.1 of the dissertation."""

import dataclasses
import json
import re
import shutil

import numpy

from .run import RunFolder, built, execute, kept, read_frame
from .table import Figure

# A litre over a hole of 40 mm and a board, whose sides are far enough for what spreads in 100 frames at 30 Hz.
SCENE = """schema_version: 1
title: A liquid flows out of a hole in a container
domain:
  {space}
  spacing: {spacing}
  boundaries: {{{sides}: {{slip: no_slip}}}}
liquids:
  - {{name: liquid, density: {density:g}, viscosity: 10 Pa.s, subtract_bodies: true, shapes: [{liquid}]}}
bodies:
  - name: container
    slip: no_slip
    shape: {{difference: {{from: {outside}, subtract: [{inside}, {hole}]}}}}
method: grid
time: {{end: {end}}}
output: {{interval: {interval}}}
cameras:
  - {{name: phone, {camera}, width: {width}, height: {height}, field_of_view: {view:g} deg}}
"""
STUDY = """schema_version: 1
title: Viscosity from a container with a hole
scenes: [{{name: container, file: part.yaml}}]
parameters:
  - {{name: viscosity, key: liquids.liquid.viscosity, range: [{low:.4g} Pa.s, {high:.4g} Pa.s], scale: log}}
experiments:
  - {{name: clip, masks: masks, camera: phone, time_zero: {zero} s, from: {first} s, to: {last} s, plus_minus: {{time_zero: 2 ms}}}}
search: {{rungs: [{rungs}], answer: {answer}, noise_runs: {noise_runs}, evaluations: {evaluations}}}
"""
# Of Table 6.1: viscosity [Pa s], Reynolds number, errors of viscosity, pressure and velocity [%].
THEIRS = {1: (125, 5.85, 14.1, 1.21), 3: (36.7, 1.93, 6.6, 0.57), 10: (9.5, 1.52, 8.28, 0.56), 30: (2.67, 0.8, 4.34, 0.32), 100: (0.601, 1.35, 3.34, 0.74),
          300: (0.152, 3.23, 15.6, 0.87)}
RANGE = (0.3, 1000)  # of the search [Pa s]
HOLE = 0.04  # [m]
OUTFLOW = "{kind: open, outflow: true}"  # of the board: at 1 Pa s liquid reaches its edges
PICTURE = (640, 360)  # [pixels]
VIEW = 24  # angle over the picture's height [degrees]
CAMERA_IN_SPACE, TARGET_IN_SPACE, CAMERA_IN_PLANE = (0, -0.75, 0.16), (0, 0, 0.05), (0, 0.08, 1)  # [m]
LEAD, STILL = 0.4, 0.2  # of the film: the empty scene, and the liquid at rest [s]


@dataclasses.dataclass(frozen=True)
class Container:
    """A container over a board, how it is filmed, and how its viscosity is searched."""

    plane: bool = False
    scale: float = 1.0         # of all lengths
    density: float = 1000.0    # [kg/m3]
    frames: int = 100
    rate: int = 30             # [1/s]
    phase: float = 0.0         # of the film's frames against the run's start, in intervals: 0 or 0.5
    film_cells: float = 10     # spacings a hole of the run that is filmed
    cells: tuple = (5, 7, 10)  # those of the search's rungs
    answer: str = "finest"     # key of the study
    evaluations: int = 12
    noise_runs: int = 3

    @property
    def end(self):
        return self.frames / self.rate

    @property
    def same_spacing(self):
        """Whether the film's run and those of the finest rung have one spacing."""
        return self.film_cells == self.cells[-1]

    @property
    def interval(self):
        """Of the run's frames [s], among which are the film's: where these lie halfway, falling liquid would gain 2 mm from the one before."""
        return (0.5 if self.phase else 1) / self.rate

    @property
    def hole(self):
        return HOLE * self.scale

    def spacing(self, cells):
        return self.hole / cells


def point(*places):
    return "[" + ", ".join(f"{place:.6g}" for place in places) + "]"


def scaled_point(scale):
    return lambda *places: point(*(scale * place for place in places))


def geometry_in_space(scale):
    """Of SCENE."""
    at = scaled_point(scale)
    return {
        "space": f"min: {at(-0.15, -0.15, 0)}\n  max: {at(0.15, 0.15, 0.2)}",
        "sides": f"x_min: {OUTFLOW}, x_max: {OUTFLOW}, y_min: {OUTFLOW}, y_max: {OUTFLOW}, z_max: open, z_min",
        "liquid": f"{{box: {{min: {at(-0.06, -0.06, 0.085)}, max: {at(0.06, 0.06, 0.18)}}}}}",
        "outside": f"{{box: {{min: {at(-0.06, -0.06, 0.08)}, max: {at(0.06, 0.06, 0.25)}}}}}",
        "inside": f"{{box: {{min: {at(-0.05, -0.05, 0.09)}, max: {at(0.05, 0.05, 0.3)}}}}}",
        "hole": f"{{cylinder: {{centre: {at(0, 0, 0.08)}, axis: [0, 0, 1], radius: {scale * HOLE / 2:.6g}, height: {scale * 0.08:.6g}}}}}",
        "camera": f"position: {at(*CAMERA_IN_SPACE)}, target: {at(*TARGET_IN_SPACE)}, up: [0, 0, 1]",
    }


def geometry_in_plane(scale):
    """Of SCENE."""
    at = scaled_point(scale)
    return {
        "space": f"dimensions: 2\n  min: {at(-0.25, 0)}\n  max: {at(0.25, 0.2)}",
        "sides": f"x_min: {OUTFLOW}, x_max: {OUTFLOW}, y_max: open, y_min",
        "liquid": f"{{box: {{min: {at(-0.06, 0.085)}, max: {at(0.06, 0.18)}}}}}",
        "outside": f"{{box: {{min: {at(-0.06, 0.08)}, max: {at(0.06, 0.25)}}}}}",
        "inside": f"{{box: {{min: {at(-0.05, 0.09)}, max: {at(0.05, 0.3)}}}}}",
        "hole": f"{{box: {{min: {at(-HOLE / 2, 0.04)}, max: {at(HOLE / 2, 0.12)}}}}}",
        "camera": f"position: {at(*CAMERA_IN_PLANE)}, target: {at(0, CAMERA_IN_PLANE[1], 0)}, up: [0, 1, 0]",
    }


def cell_means(frame, spacing):
    """Velocity and pressure as means over the particles of cells of two spacings: {cell: (velocity, pressure)} as arrays."""
    cells = numpy.floor(frame["position"] / (2 * spacing)).astype(int)
    keys, inverse = numpy.unique(cells, axis=0, return_inverse=True)
    inverse = inverse.reshape(-1)
    count = numpy.bincount(inverse)
    values = numpy.column_stack([frame["velocity"], frame["pressure"]])
    means = numpy.column_stack([numpy.bincount(inverse, weights=values[:, k]) / count for k in range(values.shape[1])])
    return {tuple(key): mean for key, mean in zip(keys, means)}


def differences(truth, other, spacing):
    """Relative L2 differences of velocity and pressure over cells that are wet in both, all frames that both have."""
    sums = numpy.zeros(4)
    times = {round(time, 6): path for time, path in RunFolder(other).frames()}
    for time, path in RunFolder(truth).frames():
        if time <= 0 or round(time, 6) not in times:
            continue
        a, b = (cell_means(read_frame(one), spacing) for one in (path, times[round(time, 6)]))
        both = sorted(a.keys() & b.keys())
        x, y = numpy.array([a[key] for key in both]), numpy.array([b[key] for key in both])
        sums += [((x - y)[:, :-1] ** 2).sum(), (x[:, :-1] ** 2).sum(), ((x - y)[:, -1] ** 2).sum(), (x[:, -1] ** 2).sum()]
    return numpy.sqrt(sums[0] / sums[1]), numpy.sqrt(sums[2] / sums[3])


def write_scene(folder, container):
    shape = (geometry_in_plane if container.plane else geometry_in_space)(container.scale)
    text = SCENE.format(spacing=f"{container.spacing(container.cells[0])} m", density=container.density, end=container.end, interval=container.interval,
                        width=PICTURE[0], height=PICTURE[1], view=VIEW, **shape)
    (folder / "scene.yaml").write_text(text)
    # Films are of the whole, and the search runs the part that symmetry leaves.
    (folder / "part.yaml").write_text(text.replace("  boundaries:", f"  symmetry: {'[x]' if container.plane else '[x, y]'}\n  boundaries:"))


def run_at(context, folder, name, container, viscosity, cells, **settings):
    """A run of the container's scene in a folder, of a viscosity [Pa s] and of so many spacings a hole."""
    keys = {"domain.spacing": f"{container.spacing(cells)} m", "liquids.liquid.viscosity": f"{viscosity} Pa.s", **settings}
    words = [word for key, value in keys.items() for word in ("--set", f"{key}={value}")]
    execute(context, [built(context, "treacle"), "run", folder / "scene.yaml", "--out", folder / name, *words], timeout=14400)


def run_elsewhere(context, folder, name, container, viscosity, cells):
    """The same with cells, and with them particles, half a spacing elsewhere: what numerical noise changes."""
    side = (0.25 if container.plane else 0.15) * container.scale + container.spacing(cells) / 2
    run_at(context, folder, name, container, viscosity, cells, **{"domain.min": point(-side, 0) if container.plane else point(-side, -side, 0)})


def film(context, folder, container, run="truth", name="film"):
    execute(context, [built(context, "treacle"), "film", folder / run, "--out", folder / name, "--rate", container.rate, "--lead", LEAD, "--still", STILL,
                      "--phase", container.phase, "--seed", 5])


def silhouettes(context, folder):
    execute(context, [built(context, "treacle"), "silhouettes", folder / "film/film.mp4", "--out", folder / "masks", "--no-overlay"])


def write_study(folder, container, search_range=RANGE):
    rungs = ", ".join(f"{1000 * container.spacing(n):.4g} mm" for n in container.cells)
    (folder / "study.yaml").write_text(STUDY.format(
        zero=LEAD + STILL, first=1.5 / container.rate, last=container.end - 0.5 / container.rate, rungs=rungs, answer=container.answer,
        noise_runs=container.noise_runs, evaluations=container.evaluations, low=search_range[0], high=search_range[1]))


def identify(context, folder, *arguments, name="out"):
    """Viscosity that the study of a folder finds, and its 90 % interval [Pa s]."""
    execute(context, [built(context, "treacle"), "identify", folder / "study.yaml", "--out", folder / name, *arguments], timeout=14400)
    text = (folder / name / "report/result.yaml").read_text()
    low, high = map(float, re.search(r"interval_90: \[(\S+) Pa.s, (\S+) Pa.s", text).groups())
    return float(re.search(r"value: (\S+)", text).group(1)), low, high


def once_each(folder, stages):
    """Calls the stages, pairs of a name and what makes that path, but those that are done; a path of a stage that was stopped goes first."""
    for name, make in stages:
        done = folder / f"{name}.done"
        if not done.exists():
            shutil.rmtree(folder / name, ignore_errors=True)
            make()
            done.touch()


def recovered(context, viscosity, folder):
    """(value, low, high, runs, seconds of all runs over those of a fine one, differences at the answer, differences of particles that lie elsewhere)."""
    container = Container(plane=True, frames=20, rate=25) if context.quick else Container()
    finest = container.spacing(container.cells[-1])
    folder.mkdir(exist_ok=True)
    write_scene(folder, container)
    write_study(folder, container)
    once_each(folder, [("truth", lambda: run_at(context, folder, "truth", container, viscosity, container.film_cells)),
                       ("floor", lambda: run_elsewhere(context, folder, "floor", container, viscosity, container.film_cells)),
                       ("film", lambda: film(context, folder, container)),
                       ("masks", lambda: silhouettes(context, folder))])
    value, low, high = identify(context, folder)
    ended = [line for line in map(json.loads, (folder / "out/journal.jsonl").read_text().splitlines()) if line.get("status") == "done"]
    once_each(folder, [("answer", lambda: run_at(context, folder, "answer", container, value, container.cells[-1]))])
    seconds = sum(line["seconds"] for line in ended) / max(line["seconds"] for line in ended)
    found, floor = (differences(folder / "truth", folder / name, finest) for name in ("answer", "floor"))
    shutil.rmtree(folder)
    return value, low, high, len(ended), seconds, found, floor


def all_recovered(context):
    """The answers by viscosity; those that were there when a call was stopped are not computed again."""
    found = {}
    with kept(context, "container") as root:
        for viscosity in [10] if context.quick else sorted(THEIRS):
            known = root / f"{viscosity:g}.json"
            if not known.exists():
                known.write_text(json.dumps(recovered(context, viscosity, root / f"{viscosity:g}")))
            found[viscosity] = json.loads(known.read_text())
    return found


def answers(context):
    """Of each viscosity, once for all rows."""
    return context.once("container", lambda: all_recovered(context))


def add_rows(table):
    @table.row("Table 6.1", claim="six viscosities from shaded, noisy video; film and finest rung at 10 cells a hole (--quick: in the plane, 10 Pa s)",
               asked="errors <= 2 % of viscosity (theirs: up to 5.85), <= 5 % of pressure (15.6), <= 1 % of velocity (1.2)")
    def errors(context):
        good, texts = True, []
        for viscosity, (value, low, high, _, _, found, floor) in answers(context).items():
            error = value / viscosity - 1
            good &= abs(error) <= 0.02 and found[0] <= 0.01 and found[1] <= 0.05
            texts.append(f"{viscosity:g} Pa s: {value:.4g} [{low:.4g}, {high:.4g}], {100 * error:+.2f} % (theirs {THEIRS[viscosity][1]}), velocity {100 * found[0]:.2f} "
                         f"(particles elsewhere {100 * floor[0]:.2f}) %, pressure {100 * found[1]:.2f} ({100 * floor[1]:.2f}) %")
        return Figure("; ".join(texts), good)

    @table.row("cost of an answer of Table 6.1", claim="runs, and seconds of all over those of one at the finest rung", asked="<= 20 runs, <= 6 fine runs")
    def cost(context):
        costs = {viscosity: (one[3], one[4]) for viscosity, one in answers(context).items()}
        return Figure("; ".join(f"{viscosity:g} Pa s: {runs} runs, {seconds:.1f} fine runs" for viscosity, (runs, seconds) in costs.items()),
                      all(runs <= 20 and seconds <= 6 for runs, seconds in costs.values()))
