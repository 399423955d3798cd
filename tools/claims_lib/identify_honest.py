"""Rows of `identify` on intervals: how often they hold the truth, over films whose camera, noise, blur, exposure and time zero are drawn."""

import concurrent.futures
import dataclasses
import json
import math
import pathlib
import random
import re
import shutil
import statistics

from . import slumping_block
from .run import built, execute, kept
from .table import Figure

PLANE = slumping_block.scene("0.62 s", cameras="")
# Block of 7 x 7 x 4 cm before a wall; runs are halves of it.
SPACE = """schema_version: 1
title: A block of syrup slumps away from a wall
domain:
  min: [0, -0.24, 0]
  max: [0.6, 0.24, 0.12]
  spacing: 6 mm
  symmetry: [y]
  boundaries: {z_min: {slip: no_slip}, x_max: open, y_min: open, y_max: open, z_max: open}
liquids:
  - {name: syrup, density: 1400, viscosity: 10 Pa.s, shapes: [{box: {min: [0, -0.02, 0], max: [0.07, 0.02, 0.07]}}]}
method: grid
time: {end: 0.45 s}
output: {interval: 16 ms}
cameras:
"""
STUDY = """schema_version: 1
title: Viscosity of a slumping block
scenes:
  - {{name: slump, file: scene.yaml}}
parameters:
  - {{name: viscosity, key: liquids.syrup.viscosity, range: [0.1 Pa.s, 1000 Pa.s], scale: log}}
measured:
  - {{key: liquids.syrup.density, value: 1.4 g/cm3, plus_minus: 0.007 g/cm3}}
experiments:
  - {{name: block, masks: masks, camera: front, time_zero: 0.7 s, from: 0.02 s, to: {last} s, plus_minus: {{time_zero: 5 ms}}}}
search: {{rungs: [{rungs}]}}
runs: {{reuse: [{reuse}]}}
"""
CAMERA = ("  - {{name: {name}, position: [{0:.6f}, {1:.6f}, {2:.6f}], target: [{3:.6f}, {4:.6f}, {5:.6f}], up: [{6:.6f}, {7:.6f}, {8:.6f}], "
          "width: 640, height: 360, field_of_view: {9:.5f} deg}}\n")


@dataclasses.dataclass(frozen=True)
class Setting:
    """A scene without its cameras, what the study states of its camera, and the spacings [mm] of the film and the search."""

    scene: str
    eye: tuple
    target: tuple
    up: tuple
    view: float  # field of view [deg]
    last: float  # time of the last frame compared [s]
    film: float
    rungs: tuple

    def camera(self, name, draw=None):
        """The camera that is stated; with draw one that differs by a millimetre, a milliradian and a thousandth of the focal length."""
        by = (lambda deviation: draw.gauss(0, deviation)) if draw else (lambda deviation: 0.0)
        eye = [one + by(1e-3) for one in self.eye]
        target = [one + there - here + by(0.6e-3) for one, there, here in zip(self.target, eye, self.eye)]
        return CAMERA.format(*eye, *target, *[one + by(1e-3) for one in self.up], self.view * (1 + by(1e-3)), name=name)


@dataclasses.dataclass
class Trial:
    """Of one film: the viscosity, its answer with the 90 % interval, s.d. of its logarithm, and that by pixels as if each were independent."""

    truth: float
    value: float
    low: float
    high: float
    deviation: float
    naive: float
    runs: int

    def error(self):
        return math.log(self.value / self.truth)

    def holds(self):
        return self.low <= self.truth <= self.high


def film(context, folder, draw):
    """Masks of a film of the run in the folder's parent."""
    treacle = built(context, "treacle")
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir()
    execute(context, [treacle, "film", folder.parent / "truth", "--out", folder / "film", "--camera", folder.name, "--lead", f"{0.5 + draw.gauss(0, 5e-3):.5f}", "--still", 0.2,
                      "--blur", f"{draw.uniform(0.5, 1.5):.2f}", "--noise", f"{draw.uniform(0.5, 3):.2f}", "--drift", f"{draw.uniform(0, 0.1):.3f}",
                      "--seed", draw.randrange(1, 10**6)])
    execute(context, [treacle, "silhouettes", folder / "film/film.mp4", "--out", folder / "masks", "--no-overlay"])
    shutil.rmtree(folder / "film")


def identified(context, setting, folder, truth, known):
    """What is found from the masks in the folder. known: folders of studies whose runs count."""
    (folder / "scene.yaml").write_text(setting.scene + setting.camera("front"))
    (folder / "study.yaml").write_text(STUDY.format(last=setting.last, rungs=", ".join(f"{rung} mm" for rung in setting.rungs), reuse=", ".join(f'"{one}"' for one in known)))
    shutil.rmtree(folder / "out", ignore_errors=True)
    execute(context, [built(context, "treacle"), "identify", folder / "study.yaml", "--out", folder / "out"], timeout=7200)
    text = (folder / "out/report/result.yaml").read_text()
    low, high = map(float, re.search(r"interval_90: \[(\S+) Pa.s, (\S+) Pa.s", text).groups())
    value, deviation, naive = (float(re.search(rf"{name}: (\S+)", text).group(1)) for name in ("value", "all", "if_pixels_were_independent"))
    return Trial(truth, value, low, high, deviation, naive, int(re.search(r"trials: (\d+)", text).group(1)))


@dataclasses.dataclass(frozen=True)
class Liquid:
    """One of the viscosities [Pa s], and the folder of its films."""

    folder: pathlib.Path
    viscosity: float

    def shoot(self, context, setting, films, seeds):
        """Its run at the film's spacing, filmed by each camera; what is there already stays."""
        if (self.folder / "filmed").exists():
            return
        execute(context, [built(context, "treacle"), "run", self.folder / "scene.yaml", "--out", self.folder / "truth", "--overwrite", "--set", f"domain.spacing={setting.film} mm",
                          "--set", "time.cfl=2", "--set", "output.interval=4 ms", "--set", f"liquids.syrup.viscosity={self.viscosity:.6g} Pa.s"], timeout=7200)
        for k in range(films):
            film(context, self.folder / f"film{k}", random.Random(f"{seeds} {k}"))
        shutil.rmtree(self.folder / "truth")
        (self.folder / "filmed").touch()


def trials(context, setting, name, count, films, seed):
    """Films of `count` viscosities of 0.3 to 30 Pa s, `films` each: first one of each viscosity, then a second one. Runs are shared by all:
    films differ, not the liquids' runs."""
    with kept(context, f"honest {name}") as folder:
        liquids = []
        for i in range(count):
            draw = random.Random(f"{seed} {i}")
            liquids.append(Liquid(folder / f"liquid{i}", 0.3 * 100 ** ((i + draw.random()) / count)))
            liquids[i].folder.mkdir(exist_ok=True)
            (liquids[i].folder / "scene.yaml").write_text(setting.scene + "".join(setting.camera(f"film{k}", draw) for k in range(films)))
        with concurrent.futures.ThreadPoolExecutor(2) as lanes:
            list(lanes.map(lambda one: one[1].shoot(context, setting, films, f"{seed} {one[0]}"), enumerate(liquids)))
        found, known = [], []
        for k in range(films):
            for liquid in liquids:
                here = liquid.folder / f"film{k}"
                ready = here / "trial.json"
                if not ready.exists():
                    ready.write_text(json.dumps(dataclasses.asdict(identified(context, setting, here, liquid.viscosity, known))))
                found.append(Trial(**json.loads(ready.read_text())))
                known.append(here / "out")
        return found


def held(found, deviation, wide):
    """How many intervals of so many of a trial's standard deviations hold the truth."""
    return sum(abs(one.error()) < wide * deviation(one) for one in found)


@dataclasses.dataclass(frozen=True)
class Asked:
    """Shares of all that 90 and 50 % intervals should hold, each (least, most), of `of` trials; fewer trials scatter more, by the binomial law."""

    of: int
    ninety: tuple
    fifty: tuple = (0, 1)
    spread: tuple = (0, math.inf)
    mean: float = math.inf
    missed: float = 1  # share of the films of any one viscosity

    def shares(self, ends, probability, total):
        more = 2.8 * math.sqrt(probability * (1 - probability)) * (1 / math.sqrt(total) - 1 / math.sqrt(self.of))
        return ends[0] - more, ends[1] + more

    def slack(self, total):
        return 2 * (1 / math.sqrt(total) - 1 / math.sqrt(self.of))


def figure(found, asked):
    zs = [one.error() / one.deviation for one in found]
    total, inside, within = len(found), sum(one.holds() for one in found), held(found, lambda one: one.deviation, 0.6745)
    spread, mean = statistics.stdev(zs), statistics.fmean(zs)
    width = statistics.median(math.log(one.high / one.low) / 2 for one in found)
    missed = max(statistics.fmean(not one.holds() for one in found if one.truth == truth) for truth in {one.truth for one in found})
    naive = held(found, lambda one: one.naive, 1.645)
    least, most = asked.shares(asked.ninety, 0.9, total)
    fewest, greatest = asked.shares(asked.fifty, 0.5, total)
    slack = asked.slack(total)
    ok = (least <= inside / total <= most and fewest <= within / total <= greatest and asked.spread[0] - slack <= spread <= asked.spread[1] + slack
          and abs(mean) <= asked.mean + slack and missed <= asked.missed and width <= 0.06 and naive / total < least)
    return Figure(f"90 %: {inside} of {total}, 50 %: {within}; z: s.d. {spread:.2f}, mean {mean:+.2f}; half-width {100 * width:.1f} % (median); at worst {100 * missed:.0f} % of a "
                  f"viscosity's films missed; pixels as independent: {naive} of {total}; {statistics.fmean(one.runs for one in found):.1f} trials an answer", ok)


def add_rows(table):
    @table.row("interval honest, in 2D", claim="20 viscosities of 0.3 to 30 Pa s, 10 films each at 2 times the finest rung's resolution",
               asked="90 % holds the truth in 165 to 192 of 200, 50 % in 80 to 120; z: s.d. 0.75 to 1.3, mean within 0.3; half-width <= 6 % (median); no viscosity missed in more "
               "than 5 of its 10; pixels as independent fail")
    def plane(context):
        count, films = (4, 3) if context.quick else (20, 10)
        setting = Setting(PLANE, (0.13, 0.05, 0.6), (0.13, 0.05, 0), (0, 1, 0), 28, 0.56, 1.75, (7, 5, 3.5))
        return figure(trials(context, setting, "plane", count, films, 17), Asked(200, (165 / 200, 192 / 200), (0.4, 0.6), (0.75, 1.3), 0.3, 0.5))

    @table.row("interval honest, in 3D", claim="block of 7 x 7 x 4 cm, 20 viscosities of 0.3 to 30 Pa s, 5 films each at 1.5 mm, search to 3 mm",
               asked="90 % holds the truth in 80 to 97 of 100; half-width <= 6 % (median); pixels as independent fail")
    def space(context):
        count, films = (3, 1) if context.quick else (20, 5)
        film, rungs = (2.25, (8, 6, 4.5)) if context.quick else (1.5, (6, 4.2, 3))
        setting = Setting(SPACE, (0.14, -0.62, 0.2), (0.14, 0, 0.02), (0, 0, 1), 30, 0.4, film, rungs)
        return figure(trials(context, setting, "space", count, films, 23), Asked(100, (0.8, 0.97)))
