"""Rows of `identify` on a container with a hole: the six viscosities of Table 6.1 of the dissertation."""

import json
import re
import shutil

import numpy

from .run import RunFolder, built, execute, read_frame, scratch
from .table import Figure

# A litre over a hole of 40 mm and a board, whose sides are far enough for what spreads in 100 frames at 30 Hz.
SCENE = """schema_version: 1
title: A liquid flows out of a hole in a container
domain:
  {space}
  spacing: {spacing}
  boundaries: {{{sides}: {{slip: no_slip}}}}
liquids:
  - {{name: liquid, density: 1000, viscosity: 10 Pa.s, around_bodies: true, shapes: [{liquid}]}}
bodies:
  - name: container
    slip: no_slip
    shape: {{difference: {{from: {outside}, subtract: [{inside}, {hole}]}}}}
method: grid
time: {{end: {end}}}
output: {{interval: {interval}}}
cameras:
  - {{name: phone, {camera}, width: {width}, height: {height}, field_of_view: 24 deg}}
"""
IN_SPACE = {
    "space": "min: [-0.15, -0.15, 0]\n  max: [0.15, 0.15, 0.2]",
    "sides": "x_min: open, x_max: open, y_min: open, y_max: open, z_max: open, z_min",
    "liquid": "{box: {min: [-0.06, -0.06, 0.085], max: [0.06, 0.06, 0.18]}}",
    "outside": "{box: {min: [-0.06, -0.06, 0.08], max: [0.06, 0.06, 0.25]}}",
    "inside": "{box: {min: [-0.05, -0.05, 0.09], max: [0.05, 0.05, 0.3]}}",
    "hole": "{cylinder: {centre: [0, 0, 0.08], axis: [0, 0, 1], radius: 0.02, height: 0.08}}",
    "camera": "position: [0, -0.75, 0.16], target: [0, 0, 0.05], up: [0, 0, 1]",
}
IN_PLANE = {
    "space": "dimensions: 2\n  min: [-0.25, 0]\n  max: [0.25, 0.2]",
    "sides": "x_min: open, x_max: open, y_max: open, y_min",
    "liquid": "{box: {min: [-0.06, 0.085], max: [0.06, 0.18]}}",
    "outside": "{box: {min: [-0.06, 0.08], max: [0.06, 0.25]}}",
    "inside": "{box: {min: [-0.05, 0.09], max: [0.05, 0.3]}}",
    "hole": "{box: {min: [-0.02, 0.04], max: [0.02, 0.12]}}",
    "camera": "position: [0, 0.08, 1], target: [0, 0.08, 0], up: [0, 1, 0]",
}
STUDY = """schema_version: 1
title: Viscosity from a container with a hole
scenes: [{{name: container, file: part.yaml}}]
parameters:
  - {{name: viscosity, key: liquids.liquid.viscosity, range: [0.3 Pa.s, 1000 Pa.s], scale: log}}
experiments:
  - {{name: clip, masks: masks, camera: phone, time_zero: {zero} s, from: {first} s, to: {last} s, plus_minus: {{time_zero: 2 ms}}}}
search: {{rungs: [{rungs}], answer: finest, noise_runs: 3, evaluations: 12}}
"""
# Of Table 6.1: viscosity [Pa s], Reynolds number, errors of viscosity, pressure and velocity [%].
THEIRS = {1: (125, 5.85, 14.1, 1.21), 3: (36.7, 1.93, 6.6, 0.57), 10: (9.5, 1.52, 8.28, 0.56), 30: (2.67, 0.8, 4.34, 0.32), 100: (0.601, 1.35, 3.34, 0.74),
          300: (0.152, 3.23, 15.6, 0.87)}
HOLE = 0.04  # [m]


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


def recovered(context, viscosity):
    """(value, low, high, runs, seconds of all runs over those of a fine one, differences at the answer, differences of particles that lie elsewhere)."""
    treacle = built(context, "treacle")
    plane = context.quick
    cells = (5, 7, 10)
    finest, rungs = HOLE / cells[-1], ", ".join(f"{1000 * HOLE / n:.4g} mm" for n in cells)
    frames, rate = (20 if plane else 100), (25 if plane else 30)
    end = frames / rate
    facts = {**(IN_PLANE if plane else IN_SPACE), "end": end, "interval": 1 / rate, "width": 640, "height": 360}
    with scratch(context, f"container_{viscosity:g}") as folder:
        scene = SCENE.format(spacing=f"{HOLE / cells[0]} m", **facts)
        (folder / "scene.yaml").write_text(scene)
        # The film is of the whole, and the search runs the part that symmetry leaves.
        (folder / "part.yaml").write_text(scene.replace("  boundaries:", f"  symmetry: {'[x]' if plane else '[x, y]'}\n  boundaries:"))
        fine = ["--set", f"domain.spacing={finest} m", "--set", f"liquids.liquid.viscosity={viscosity} Pa.s"]
        side = (0.25 if plane else 0.15) + finest / 2  # cells, and with them particles, lie half a spacing elsewhere
        shifted = f"[{-side}, 0]" if plane else f"[{-side}, {-side}, 0]"
        execute(context, [treacle, "run", folder / "scene.yaml", "--out", folder / "truth", *fine], timeout=14400)
        execute(context, [treacle, "run", folder / "scene.yaml", "--out", folder / "floor", *fine, "--set", f"domain.min={shifted}"], timeout=14400)
        execute(context, [treacle, "film", folder / "truth", "--out", folder / "film", "--rate", rate, "--lead", 0.4, "--still", 0.2, "--seed", 5])
        execute(context, [treacle, "silhouettes", folder / "film/film.mp4", "--out", folder / "masks", "--no-overlay"])
        (folder / "study.yaml").write_text(STUDY.format(zero=0.6, first=1.5 / rate, last=end - 0.5 / rate, rungs=rungs))
        execute(context, [treacle, "identify", folder / "study.yaml", "--out", folder / "out"], timeout=14400)
        text = (folder / "out/report/result.yaml").read_text()
        value = float(re.search(r"value: (\S+)", text).group(1))
        low, high = map(float, re.search(r"interval_90: \[(\S+) Pa.s, (\S+) Pa.s", text).groups())
        ended = [line for line in map(json.loads, (folder / "out/journal.jsonl").read_text().splitlines()) if line.get("status") == "done"]
        execute(context, [treacle, "run", folder / "scene.yaml", "--out", folder / "answer", *fine[:2], "--set", f"liquids.liquid.viscosity={value} Pa.s"],
                timeout=14400)
        seconds = sum(line["seconds"] for line in ended) / max(line["seconds"] for line in ended)
        found, floor = (differences(folder / "truth", folder / name, finest) for name in ("answer", "floor"))
        for name in ("truth", "floor", "answer"):
            shutil.rmtree(folder / name)
    return value, low, high, len(ended), seconds, found, floor


def answers(context):
    """Of each viscosity, once for all rows."""
    viscosities = [10] if context.quick else sorted(THEIRS)
    return context.once("container", lambda: {one: recovered(context, one) for one in viscosities})


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
