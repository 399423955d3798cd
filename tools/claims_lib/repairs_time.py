"""Rows of `repairs` on the steps in time: free fall, spin and flight, orders, tanks of water."""

import itertools
import math

import numpy

from .gtest import run_gtest
from .run import run_scene, scratch
from .table import Figure

FALL = """
schema_version: 1
title: A ball of liquid and a rigid one
domain: {{min: [0, 0, 0], max: [1, 1, 1], spacing: {spacing}}}
liquids:
  - {{name: liquid, density: 1000, viscosity: {viscosity}, shapes: [{{sphere: {{centre: [0.3, 0.5, 0.85], radius: 0.1}}}}]}}
bodies:
  - {{name: ball, kind: dynamic, density: 1000, shape: {{sphere: {{centre: [0.7, 0.5, 0.85], radius: 0.1}}}}}}
method: {{kind: {kind}}}
time: {{end: 0.35}}
output: {{interval: 0.35, fields: [velocity], double_precision: true}}
"""

FLIGHT = """
schema_version: 1
title: A ball of liquid that spins and flies
domain:
  min: [-0.3, -0.3, -0.3]
  max: {high}
  spacing: {spacing}
  gravity: [0, 0, 0]
  boundaries: {{x_min: open, x_max: open, y_min: open, y_max: open, z_min: open, z_max: open}}
liquids:
  - name: liquid
    density: 1000
    viscosity: {viscosity}
    velocity: {velocity}
    angular_velocity: [0, 0, 3]
    shapes: [{{sphere: {{centre: [0, 0, 0], radius: 0.1}}}}]
method: {{kind: grid}}
time: {{end: 1}}
output: {{interval: 1, fields: [velocity], double_precision: true}}
"""

TANK = """
schema_version: 1
title: A tank of water
domain: {{dimensions: 2, min: [0, 0], max: [1, 0.6], spacing: {spacing}}}
liquids:
  - {{name: water, density: 1000, viscosity: 1 mPa.s, shapes: [{{box: {{min: [0, 0], max: [{width}, {height}]}}}}]}}
method: {{kind: {kind}}}
time: {{end: 10}}
output: {{interval: 0}}
"""


def free_fall(context):
    wanted = 0.5 * 9.81 * 0.35**2
    worst = {}
    cases = itertools.product(("grid", "sph"), (0.03125, 0.015625), (1, 2, 3))
    for kind, spacing, ranks in context.sample(cases, 3):
        with scratch(context, "fall") as folder:
            scene = folder / "scene.yaml"
            scene.write_text(FALL.format(spacing=spacing, viscosity=1, kind=kind))
            run = run_scene(context, scene, folder / "run", ranks=ranks)
            first, last = run.frame(0), run.frame(-1)
            bodies = run.bodies()
        liquid = float((first["position"][:, 2] - last["position"][:, 2]).mean()) / wanted - 1
        ball = (0.85 - bodies["ball position z"][-1]) / wanted - 1
        for name, error in (("liquid", liquid), ("ball", ball)):
            worst[kind, name] = max(worst.get((kind, name), 0), abs(error))
    text = ", ".join(f"{kind} {name} {error:.1e}" for (kind, name), error in sorted(worst.items()))
    return Figure(text, all(error <= 1e-3 for error in worst.values()))


def flight(context, velocity, viscosity, spacing=0.01):
    """Place of the middle [m] and angular momentum about it along z after 1 s, and the latter at the start."""

    def measure():
        high = [0.3 + math.ceil(10 * v) / 10 for v in velocity]
        with scratch(context, "flight") as folder:
            scene = folder / "scene.yaml"
            scene.write_text(FLIGHT.format(high=high, spacing=spacing, viscosity=viscosity, velocity=list(velocity)))
            run = run_scene(context, scene, folder / "run")
            steps, last = run.steps(), run.frame(-1)
        centre = last["position"].mean(axis=0)
        momentum = numpy.array([steps[f"momentum {axis}"][-1] for axis in "xyz"])
        about = steps["angular momentum z"][-1] - numpy.cross(centre, momentum)[2]
        inertia = 0.4 * steps["mass"][-1] * 0.1**2
        return centre, float(about), 3 * inertia

    return context.once(("flight", tuple(velocity), viscosity, spacing), measure)


def flying_spin(context):
    _, resting, _ = flight(context, (0, 0, 0), 100)
    found, ok = [], True
    for velocity in ((1.3, 0, 0), tuple(1.3 * k / math.sqrt(14) for k in (1, 2, 3))):
        centre, about, _ = flight(context, velocity, 100)
        off = float(numpy.linalg.norm(centre - numpy.array(velocity)))
        found.append(f"{1000 * off:.2f} mm off, L {about / resting - 1:+.1e}")
        ok = ok and off <= 1e-3 and abs(about / resting - 1) <= 1e-3
    return Figure("; ".join(found), ok)


def resting_spin(context):
    kept = {}
    for viscosity in (0, 1, 100, 1e5):
        _, about, first = flight(context, (0, 0, 0), viscosity)
        kept[viscosity] = about / first
    return Figure(", ".join(f"{viscosity:g} Pa s {share:.3f}" for viscosity, share in kept.items()),
                  all(share >= 0.98 for share in kept.values()))


def water_tanks(context, kind="grid"):
    """Columns that collapse and slosh, and water at rest, for 10 s."""
    cases = itertools.product((0.02, 0.01), ((1, 0.3), (0.3, 0.4), (0.5, 0.25)))
    found, ok = [], True
    for spacing, (width, height) in context.sample(cases, 2):
        with scratch(context, "tank") as folder:
            scene = folder / "scene.yaml"
            scene.write_text(TANK.format(kind=kind, spacing=spacing, width=width, height=height))
            steps = run_scene(context, scene, folder / "run").steps()
        energy = steps["kinetic energy"] + steps["potential energy"]
        gained = energy.max() / (0.5 * 1000 * 9.81 * width * height**2) - 1
        speed = steps["max speed"].max() / math.sqrt(2 * 9.81 * height)
        error = steps["density error after" if kind == "grid" else "density error"].max()
        found.append(f"{width} x {height} m, {1000 * spacing:.0f} mm: energy {100 * gained:+.2f} %, speed {speed:.2f}, "
                     f"worst density {error:.1f}")
        ok = ok and gained <= 0.002 and (speed <= 1.05 or width < 1)
    return Figure("; ".join(found), ok)


def orders(context):
    report = run_gtest(context, "grid_order_test", "OrderInTime.*")
    return Figure(report.text(), report.ok and {"standing wave", "vortex", "viscous vortex", "swinging drop"} <= report.properties.keys())


def add_rows(table):
    table.row("free fall", claim="ball of liquid and rigid ball, both methods, default steps, 0.35 s, two spacings, 1 to 3 ranks",
              asked="<= 0.1 % of the way")(free_fall)
    table.row("flying spin", claim="ball of 10 cells radius, 100 Pa s, 3 rad/s, at 1.3 m/s along x and along (1, 2, 3), 1 s",
              asked="<= 1 mm off; L of the resting one to 0.1 %")(flying_spin)
    table.row("resting spin", claim="the same at rest, 0, 1, 100, 1e5 Pa s, after 3 rad", asked=">= 0.98 kept")(resting_spin)
    table.row("order in time", claim="standing wave, Taylor-Green, free fall, swinging drop", asked=">= 1.8, >= 1 for stiff")(orders)
    table.row("tanks of water", claim="10 s, at rest and collapsing, two spacings", asked="energy <= +0.2 %, speed <= 1.05 sqrt(2 g H) "
              "outside of splashes")(water_tanks)
