"""Rows of `repairs` on the grid's solves: systems without rows, jumps of viscosity, walls."""

import itertools

import numpy

from .gtest import gtest_on_ranks
from .run import run_scene, scratch
from .table import Figure

INLET = """
schema_version: 1
title: A plane inlet into air
domain:
  dimensions: 2
  min: [-16 mm, -4 mm]
  max: [16 mm, 128 mm]
  spacing: 2 mm
  boundaries: {{x_min: {{kind: open, outflow: true}}, x_max: {{kind: open, outflow: true}}, y_min: {{kind: open, outflow: true}}, y_max: {{kind: open, outflow: true}}}}
liquids: [{{name: syrup, density: 1000, viscosity: {viscosity}}}]
inlets:
  - {{disc: {{centre: [0, 0.12], direction: [0, -1], radius: 10 mm}}, velocity: {speed} m/s}}
method: {{kind: grid, grid: {{stokes: {{solve: {solve}}}}}}}
time: {{end: 0.1, cfl: {cfl}}}
output: {{interval: 0}}
"""


LAYERS = """
schema_version: 1
title: Two layers of unlike viscosity in a channel
domain:
  dimensions: 2
  min: [0, -0.1]
  max: [{length}, 0.1]
  spacing: {spacing}
  gravity: [10, 0]
  boundaries: {{x_min: periodic, x_max: periodic, y_min: {{slip: no_slip}}, y_max: {{slip: no_slip}}}}
liquids:
  - {{name: thick, density: 1000, viscosity: {thick}, shapes: [{{box: {{min: [0, -0.1], max: [{length}, {height}]}}}}]}}
  - {{name: thin, density: 1000, viscosity: 10, shapes: [{{box: {{min: [0, {height}], max: [{length}, 0.1]}}}}]}}
method: {{kind: grid}}
time: {{end: 3}}
output: {{interval: 3, fields: [velocity, liquid]}}
"""


def empty_systems(context):
    solve = gtest_on_ranks(context, "solve_test", "EmptySystems.*", at_least=8)
    steps = gtest_on_ranks(context, "grid_step_test", "EmptySteps.*", at_least=4)
    return Figure(f"solve layer {solve.measured}; steps {steps.measured}", solve.ok and steps.ok)


def plane_inlet(context):
    cases = context.sample(itertools.product((0.001, 1, 60, 1e5), (0.05, 0.2, 1), (0.3, 1, 3),
                                               ("automatic", "split", "together"), (1, 2, 3)), 8)
    short = []
    for viscosity, speed, cfl, solve, ranks in cases:
        with scratch(context, "inlet") as folder:
            scene = folder / "scene.yaml"
            scene.write_text(INLET.format(viscosity=viscosity, speed=speed, cfl=cfl, solve=solve))
            steps = run_scene(context, scene, folder / "run", ranks=ranks).steps()
        # Two layers a cell, twenty particles wide.
        wanted = 20 * speed * 0.1 / 0.001
        particles = steps["particles"][-1] + steps["flowed out"][-1]
        if abs(particles - wanted) > 40:
            short.append(f"{viscosity:g} Pa s, {speed} m/s, cfl {cfl}, {solve}, {ranks} ranks: {particles:g} of {wanted:g}")
    return Figure(f"{len(cases) - len(short)} of {len(cases)} jets" + "".join(f"; {text}" for text in short), not short)


def largest_of_layers(thick, thin, height):
    """Largest velocity in the channel of LAYERS [m/s]: the stress is c - rho g (y - height), no slip at both walls."""
    force, below, above = 1e4, height + 0.1, 0.1 - height
    c = (force * above**2 / (2 * thin) - force * below**2 / (2 * thick)) / (below / thick + above / thin)
    y = numpy.linspace(-below, above, 20001)
    u = numpy.where(y < 0, (-force * (y**2 - below**2) / 2 + c * (y + below)) / thick,
                    (force * (above**2 - y**2) / 2 - c * (above - y)) / thin)
    return float(u.max())


def viscosity_jumps(context):
    tests = gtest_on_ranks(context, "grid_flow_test", "LayersOfLiquids.*", at_least=3)
    cases = context.sample(itertools.product((1, 10, 1e3, 1e6), (0, 0.25, 0.5, 0.75), (40, 80), (1, 2, 3)), 4)
    worst, short = {}, []
    for ratio, offset, cells, ranks in cases:
        spacing = 0.2 / cells
        with scratch(context, "layers") as folder:
            scene = folder / "scene.yaml"
            scene.write_text(LAYERS.format(length=10 * spacing, spacing=spacing, thick=10 * ratio, height=offset * spacing))
            frame = run_scene(context, scene, folder / "run", ranks=ranks).frame()
        # The lattice of particles puts the layers' meeting at a multiple of half a cell.
        height = 0.2 * float(numpy.mean(frame["liquid"] == 0)) - 0.1
        error = float(frame["velocity"][:, 0].max()) / largest_of_layers(10 * ratio, 10, height) - 1
        worst[cells] = max(worst.get(cells, 0), abs(error))
        if abs(error) > 0.02:
            short.append(f"{ratio:g}:1, offset {offset}, {cells} cells: {100 * error:+.1f} %")
    text = ", ".join(f"{cells} across {100 * error:.1f} %" for cells, error in sorted(worst.items()))
    return Figure(f"{tests.measured}; {text}" + "".join(f"; {found}" for found in short), tests.ok and not short)


def add_rows(table):
    table.row("empty systems", claim="no liquid, no pressure row, no stress, on one rank or on all, every preconditioner, "
              "1 to 4 ranks", asked="steps go on")(empty_systems)
    table.row("plane inlet", claim="a jet into air, 1e-3 to 1e5 Pa s, 0.05 to 1 m/s, cfl 0.3 to 3, 1 to 3 ranks",
              asked="all that the inlet gives, within two layers")(plane_inlet)
    table.row("viscosity jumps", claim="largest velocity of two layers in a channel, viscosities 1:1 to 1e6:1, meeting anywhere "
              "within a cell, 1 to 3 ranks; layers along the axes and at angles to them converge",
              asked="2 % at 40 across; order >= 1.8 and >= 1.5")(viscosity_jumps)
