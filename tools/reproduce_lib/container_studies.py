"""Containers with a hole that are filmed and whose viscosity is searched: a study is done once, and tables and figures use it."""

import dataclasses
import math
import pathlib
import re
import shutil

from claims_lib import identify_container as containers
from claims_lib.run import Columns, RunFolder, read_frame, treacle

from .studies import drop, once, study_folder

FIELDS = {"liquid": ("none", None), "pressure": ("pressure", "Pa"), "speed": ("speed", "m/s")}  # of pictures: field, unit
SHOWN = (160, 72, 320, 192)  # left, top, width, height of what pictures show [pixels]
AT = 0.55                    # place of their frame among all


@dataclasses.dataclass(frozen=True)
class Liquid:
    name: str
    viscosity: float  # [Pa s]
    density: float    # [kg/m3]


@dataclasses.dataclass(frozen=True)
class Trial:
    """A run of a search."""

    viscosity: float  # [Pa s]
    spacing: float    # [mm]
    objective: float  # E of (6.9), mean over the frames
    seconds: float
    folder: pathlib.Path


@dataclasses.dataclass(frozen=True)
class Study:
    """A film, and what was found in it."""

    folder: pathlib.Path
    liquid: Liquid
    container: containers.Container
    found: dict  # see numbers()

    def trials(self, name="out"):
        """All that ended, in the order of the search's requests."""
        table = Columns(self.folder / name / "table.csv")
        spacings = table["spacing"] if "spacing" in table else [math.nan] * len(table)
        rows = zip(table["run"], table["viscosity"], spacings, table.text("status"), table["seconds"])
        return [Trial(float(viscosity), float(spacing), objective(folder), float(seconds), folder) for run, viscosity, spacing, status, seconds in rows
                for folder in [self.folder / name / "runs" / f"{int(run):04d}"] if status == "done"]

    def searched(self, name="out"):
        """E of the runs that the search requested, in its order: without those around the answer, of other spacings and for the noise."""
        rows = re.findall(r"<tr><td>\d+</td><td>search</td><td>(\d+)</td>", (self.folder / name / "report/index.html").read_text())
        return [objective(self.folder / name / "runs" / f"{int(run):04d}") for run in rows]

    def of_rung(self, cells):
        """Trials of one spacing by their viscosity."""
        spacing = 1e3 * self.container.spacing(cells)
        return sorted((one for one in self.trials() if abs(one.spacing / spacing - 1) < 1e-3), key=lambda one: one.viscosity)

    def best(self):
        """The trial of the finest rung that is most alike."""
        return min(self.of_rung(self.container.cells[-1]), key=lambda one: one.objective)

    def picture(self, run, field):
        """Pixels of a frame of the film's run ("truth") or of that with the identified viscosity ("answer")."""
        return cut(self.folder / f"{run}_{field}.png")


def objective(folder):
    """E (6.9) of a run: half the share of the pixels that differ, mean over the frames."""
    table = Columns(folder / "mismatches_clip.csv")
    return float((table["mismatches"] / (2 * table["compared"])).mean())


def cut(path):
    from matplotlib import image

    left, top, width, height = SHOWN
    return image.imread(path)[top:top + height, left:left + width]


def study_of(context, results, liquid, container, search_range):
    """The study of a liquid, done now or before."""
    folder, found = study_folder(context, results, f"container {liquid.name}", f"{liquid} {container} {search_range}",
                                 lambda folder: measured(context, results, folder, liquid, container, search_range))
    return Study(folder, liquid, container, found)


def measured(context, results, folder, liquid, container, search_range):
    """Films a run, searches its viscosity, runs that again; the results of both runs are taken, and their frames are dropped."""
    containers.write_scene(folder, container)
    once(folder, "truth", lambda: containers.run_at(context, folder, "truth", container, liquid.viscosity, container.film_cells))
    once(folder, "film", lambda: containers.film(context, folder, container))
    once(folder, "masks", lambda: containers.silhouettes(context, folder))
    containers.write_study(folder, container, search_range)
    value, low, high = containers.identify(context, folder)
    once(folder, "answer", lambda: containers.run_at(context, folder, "answer", container, value, container.cells[-1]))
    if container.same_spacing:
        once(folder, "floor", lambda: containers.run_elsewhere(context, folder, "floor", container, liquid.viscosity, container.film_cells))
    once(folder, "answer_film", lambda: containers.film(context, folder, container, "answer", "answer_film"))
    found = {"value": value, "low": low, "high": high, **numbers(folder, container)}
    draw(context, results, folder, container)
    for name in ("truth", "answer", "floor"):
        drop(folder, name)
    return found


def numbers(folder, container):
    """Speed in the hole, speeds of the front [m/s]; of runs of one spacing, relative differences of pressure and velocity (floor: particles elsewhere)."""
    found = {"speed": speed_in_hole(folder / "truth", container)}
    for name, run in {"": "answer", " floor": "floor"}.items() if container.same_spacing else ():
        velocity, pressure = containers.differences(folder / "truth", folder / run, container.spacing(container.film_cells))
        found |= {f"velocity{name}": float(velocity), f"pressure{name}": float(pressure)}
    found["filmed front"], found["front of the run"] = front_speeds(folder, container)
    return found


def speed_in_hole(folder, container):
    """Mean over the frames in which the hole is wet [m/s]."""
    up, means = (1 if container.plane else 2), []
    for time, path in RunFolder(folder).frames():
        frame = read_frame(path)
        place = frame["position"]
        inside = abs(place[:, up] - 0.085 * container.scale) < 0.005 * container.scale
        inside &= (place[:, :1 if container.plane else 2] ** 2).sum(axis=1) < (container.hole / 2) ** 2
        if time > 0 and inside.any():
            means.append(-float(frame["velocity"][inside, up].mean()))
    return sum(means) / len(means) if means else 0.0


def seen_from_camera(container):
    """Row of the board below the hole, and pixels a metre there."""
    width, height = containers.PICTURE
    focal = height / 2 / math.tan(math.radians(containers.VIEW / 2))
    if container.plane:
        _, level, distance = containers.CAMERA_IN_PLANE
        return height / 2 + focal * level / distance, focal / (distance * container.scale)
    _, back, level = containers.CAMERA_IN_SPACE
    drop = level - containers.TARGET_IN_SPACE[2]
    length = math.hypot(back, drop)
    depth, below = (back ** 2 + level * drop) / length, -back * (level - drop) / length
    return height / 2 + focal * below / depth, focal / (depth * container.scale)


def foot(path, container):
    """Half the width of what lies on the board in a mask [m], 0 before anything does."""
    import numpy
    from matplotlib import image

    row, scale = seen_from_camera(container)
    hole = container.hole * scale
    band = image.imread(path)[int(row - 0.2 * hole):int(row + 0.1 * hole) + 1] > 0.5
    columns = numpy.flatnonzero(band.any(axis=0))
    return (columns[-1] - columns[0] + 1) / 2 / scale if len(columns) else 0.0


def run_frames(folder):
    """Frame of the run that each frame of the film shows, -1 before it begins."""
    table = Columns(folder / "film/film.csv")
    return {int(number): int(of_run) for number, of_run in zip(table["frame"], table["run frame"])}


def front_speeds(folder, container):
    """Mean speed [m/s] of the front on the board: in the film's silhouettes, and in exact ones of the run, over the frames in which both spread."""
    widest = 0.8 * containers.PICTURE[0] / 2 / seen_from_camera(container)[1]
    names = [f"mask_{number:06d}.png" for number, of_run in run_frames(folder).items() if of_run > 0]
    pairs = [(foot(folder / "masks" / name, container), foot(folder / "answer_film" / name, container)) for name in names]
    spreading = [k for k, pair in enumerate(pairs) if min(pair) > 0.6 * container.hole and max(pair) < widest]
    if len(spreading) < 2:
        return None, None
    first, last = spreading[0], spreading[-1]
    return tuple((pairs[last][k] - pairs[first][k]) * container.rate / (last - first) for k in range(2))


def drawn_frame(container):
    return round(AT * container.end / container.interval)


def draw(context, results, folder, container):
    """A frame of the film's run and of the answer's, each by its surface, pressure and speed, coloured alike."""
    number = drawn_frame(container)
    frame = RunFolder(folder / "truth").frame(number)
    ends = {"pressure": (0, spread(frame["pressure"])), "speed": (0, spread((frame["velocity"] ** 2).sum(axis=1) ** 0.5))}
    for run in ("truth", "answer"):
        for name, (field, _) in FIELDS.items():
            look = ["--range", "{:.4g}:{:.4g}".format(*ends[name])] if name in ends else ["--style", "surface"]
            if name in ends and not container.plane:
                look += ["--cut", "y=0 cm"]
            into = folder / f"{run}_pictures"
            treacle(context, "render", folder / run, "--field", field, "--frames", number, *look, "--no-movie", "--out", into, ranks=results.ranks)
            next(into.glob("*.png")).rename(folder / f"{run}_{name}.png")
            shutil.rmtree(into)


def spread(values):
    import numpy

    return max(float(numpy.percentile(values, 98)), 1e-9)
