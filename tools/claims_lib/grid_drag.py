"""A row of `grid`: the drag on a ball in a periodic box, and the torque on one that turns."""

import math

from .gtest import run_gtest
from .run import run_scene, scratch
from .table import Figure

LENGTH, RADIUS = 1.0, 0.2           # of the box and of the ball [m]
DENSITY, NU, PULL = 1000, 1.0, 0.1  # [kg/m3], [m2/s], [m/s2]; Reynolds' number is 0.003
STEP = 1.0                          # nu dt / dx^2: pressure and viscosity are solved one after the other
RELAXATIONS = 3                     # times of the approach to steady flow that a run lasts
SIZES = (4, 6)                      # cells a radius; the last one is held to the tolerance
TOLERANCE = 0.05

SCENE = """
schema_version: 1
title: Syrup is pulled past a ball, and past its images
domain:
  max: [{length}, {length}, {length}]
  gravity: [{pull}, 0, 0]
  spacing: {spacing}
  boundaries: {{x_min: periodic, x_max: periodic, y_min: periodic, y_max: periodic, z_min: periodic, z_max: periodic}}
liquids:
  - name: syrup
    density: {density}
    viscosity: {viscosity}
    subtract_bodies: true
    shapes: [{{box: {{min: [0, 0, 0], max: [{length}, {length}, {length}]}}}}]
bodies:
  - {{name: ball, shape: {{sphere: {{centre: [{centre}, {centre}, {centre}], radius: {radius}}}}}, slip: no_slip}}
method: {{kind: grid}}
time: {{end: {end}, rule: fixed, step: {step}}}
output: {{interval: 0}}
"""


def hasimoto():
    """Drag over Stokes' in a simple cubic array, of the mean velocity of box and ball together (Hasimoto 1959)."""
    c = 4 / 3 * math.pi * (RADIUS / LENGTH) ** 3
    return 1 / (1 - 1.7601 * c ** (1 / 3) + c - 1.5593 * c**2)


def drag(context, folder, cells):
    """The same, measured. A pull on the liquid moves it as a gradient of pressure over the whole box does."""
    spacing = RADIUS / cells
    stokes = 6 * math.pi * NU * RADIUS  # over the density
    relaxation = LENGTH**3 / (stokes * hasimoto())
    step = STEP * spacing**2 / NU
    scene = folder / f"scene_{cells}.yaml"
    # Not in the middle: no face lies as its image does.
    scene.write_text(SCENE.format(length=LENGTH, radius=RADIUS, pull=PULL, spacing=spacing, density=DENSITY, viscosity=DENSITY * NU,
                                  centre=0.513 * LENGTH, step=step, end=RELAXATIONS * relaxation))
    steps = run_scene(context, scene, folder / f"run_{cells}", ranks=2, timeout=4 * 3600).steps()
    volume = LENGTH**3 - 4 / 3 * math.pi * RADIUS**3
    mean = steps["momentum x"] / steps["mass"] * volume / LENGTH**3
    # One exponential leads to the steady value (Aitken).
    half = len(mean) // 3
    first, second, last = (float(mean[-1 - k * half]) for k in (2, 1, 0))
    steady = last - (last - second) ** 2 / (last - 2 * second + first)
    return PULL * LENGTH**3 / (stokes * steady)


def periodic_drag(context):
    right = hasimoto()
    with scratch(context, "drag") as folder:
        found = {cells: drag(context, folder, cells) for cells in SIZES}
    torque = run_gtest(context, "grid_viscosity_test", "GridViscousBodies.torque_on_a_sphere_that_turns_within_another_is_right")
    text = ", ".join(f"{cells} cells a radius {value:.3f} ({100 * (value / right - 1):+.1f} %)" for cells, value in found.items())
    return Figure(f"drag over Stokes' in a box of {LENGTH / RADIUS:g} radii: {text}, Hasimoto {right:.3f}; torque: {torque.text()}",
                  abs(found[SIZES[-1]] / right - 1) <= TOLERANCE and torque.ok)
