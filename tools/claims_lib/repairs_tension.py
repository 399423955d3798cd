"""Rows of `repairs` on the grid's surface tension: drops at rest and oscillating."""

import itertools
import random

import numpy

from .gtest import run_gtest
from .run import run_scene, scratch
from .scenes import open_domain
from .table import Figure

TENSION, DENSITY, RADIUS = 0.072, 1000, 1e-3

DROP = """
schema_version: 1
title: A drop in free space
{domain}
liquids:
  - name: water
    density: 1000
    viscosity: {viscosity}
    surface_tension: 0.072
    velocity: {velocity}
    shapes: [{{sphere: {{centre: {centre}, radius: 1 mm}}}}]
method: {{kind: grid}}
time: {{end: {end}}}
output: {{interval: 0}}
"""


def drop_scene(dimensions, cells, viscosity, offset, speed, end):
    """A drop whose middle is `offset` cells off the lattice, with room to fly by its speed along x."""
    spacing = RADIUS / cells
    half = spacing * int(numpy.ceil(1.4 * cells + 3))
    way = spacing * int(numpy.ceil(speed * end / spacing))
    domain = open_domain(dimensions, [-half] * dimensions, [half + way] + [half] * (dimensions - 1), spacing, [0] * dimensions)
    return DROP.format(
        domain=domain, viscosity=viscosity, end=end,
        velocity=[speed] + [0] * (dimensions - 1), centre=[offset * spacing * k for k in (1, 0.7, 0.4)[:dimensions]])


def small_drop(context):
    """A drop of 1 mm at rest, 8 cells a radius, 5 mPa s, 24 ms: its kinetic energy falls."""
    end = 0.008 if context.quick else 0.024
    with scratch(context, "drop") as folder:
        scene = folder / "scene.yaml"
        scene.write_text(drop_scene(3, 8, 0.005, 0, 0, end))
        steps = run_scene(context, scene, folder / "run", ranks=2).steps()
    energy = steps["kinetic energy"]
    early, late = energy[: len(energy) // 4].max(), energy[-len(energy) // 4:].max()
    fastest = steps["max speed"][-len(energy) // 4:].max()
    return Figure(f"kinetic energy {early:.1e} J, in the last quarter {late:.1e} J; at most {fastest:.2g} m/s then",
                  bool(late < early and fastest < 0.01 * TENSION / 0.005))


def drops_at_rest(context):
    cases = [(2, cells, viscosity, offset, speed) for cells, viscosity, offset, speed in
             itertools.product((4, 8, 16, 32), (0, 0.001, 0.01, 0.1), (0, 0.37), (0, 0.3))]
    cases += [(3, cells, viscosity, offset, 0) for cells, viscosity, offset in itertools.product((4, 8), (0, 0.001, 0.01, 0.1), (0, 0.37))]
    if context.quick:
        cases = random.Random(27).sample([case for case in cases if case[0] == 2 and case[1] < 16], 4)
    worst, short = 0, []
    for dimensions, cells, viscosity, offset, speed in cases:
        period = 2 * numpy.pi / numpy.sqrt((6 if dimensions == 2 else 8) * TENSION / (DENSITY * RADIUS**3))
        with scratch(context, "rest") as folder:
            scene = folder / "scene.yaml"
            scene.write_text(drop_scene(dimensions, cells, viscosity, offset, speed, 2 * period))
            steps = run_scene(context, scene, folder / "run", ranks=random.Random(cells).choice((1, 2, 3))).steps()
        mass = steps["mass"][-1]
        momentum = sum(steps[f"momentum {axis}"] ** 2 for axis in "xyz"[:dimensions])
        energy = steps["kinetic energy"] - momentum / (2 * mass)
        quarter = len(energy) // 4
        grown = energy[-quarter:].max() / energy[:quarter].max()
        speeds = numpy.sqrt(2 * energy[-quarter:].max() / mass)
        limit = 0.01 * TENSION / viscosity if viscosity > 0 else numpy.inf
        worst = max(worst, grown)
        if grown > 1 or speeds > limit:
            short.append(f"{dimensions}D, {cells} cells, {viscosity} Pa s, offset {offset}, {speed} m/s: energy times {grown:.2f}, "
                         f"{speeds:.2g} m/s")
    return Figure(f"{len(cases) - len(short)} of {len(cases)} drops; energy at most {worst:.2f} times the first"
                  + "".join(f"; {text}" for text in short), not short)


def oscillations(context):
    reports = {ranks: run_gtest(context, "grid_tension_test", "Drops.*", ranks=ranks) for ranks in ((1,) if context.quick else (1, 2, 3))}
    return Figure("; ".join(f"{ranks} ranks: {report.text()}" for ranks, report in reports.items()),
                  all(report.ok and report.ran >= 3 for report in reports.values()))


def add_rows(table):
    table.row("small drop", claim="a drop of 1 mm at rest, grid, 8 cells a radius, 5 mPa s", asked="kinetic energy falls")(small_drop)
    table.row("drops at rest", claim="plane, 4 to 32 cells a radius, and in space, 4 and 8, 0 to 100 mPa s, on and off the lattice, at rest and "
              "at 0.3 m/s, 1 to 3 ranks", asked="energy about the middle <= its first; mean speed <= 0.01 sigma/mu")(drops_at_rest)
    table.row("oscillating drops", claim="frequency, plane and space, 4 and 8 cells; the same on 1 to 3 ranks",
              asked="within 4 % of Lamb's")(oscillations)
