"""Rows of `repairs` on what the grid must never do: heap up, stick, drag, lose momentum."""

import itertools
import math

import numpy

from .run import run_scene, scratch
from .scenes import open_domain
from .table import Figure

SPLASH = 0.25  # [s]: the tank seeded off its walls has fallen to them; its jets there, 2.8 m/s, stay with steps of 1 ms
TANK = """
schema_version: 1
title: Water seeded off the walls
domain: {{min: [0, 0, 0], max: [0.36, 0.36, 0.4], spacing: 2 cm}}
liquids:
  - {{name: water, density: 1000, viscosity: 1 mPa.s, subtract_bodies: true, shapes: [{{box: {{min: {low}, max: {high}}}}}]}}
method: {{kind: grid}}
time: {{end: {end}}}
output: {{interval: 0}}
"""

RAMP = """
schema_version: 1
title: A block on a ramp that it slides along
domain:
  dimensions: 2
  min: [0, 0]
  max: [2, 2]
  spacing: 2 cm
  boundaries: {{x_min: open, x_max: open, y_min: open, y_max: open}}
liquids:
  - name: syrup
    density: 1000
    viscosity: {viscosity}
    shapes: [{{box: {{min: [-0.2, -0.15], max: [0.2, 0.15], rotation_angle: -{degrees} deg, translation: {middle}}}}}]
bodies:
  - {{name: ramp, slip: free_slip, {ramp}}}
method: {{kind: grid}}
time: {{end: 0.25}}
output: {{interval: 0}}
"""

DRUM = """
schema_version: 1
title: A free-slip drum turns around liquid at rest
domain: {{dimensions: 2, min: [-0.25, -0.25], max: [0.25, 0.25], spacing: {spacing}, gravity: [0, 0]}}
liquids:
  - {{name: syrup, density: 1000, viscosity: {viscosity}, subtract_bodies: true, shapes: [{{sphere: {{centre: {centre}, radius: 0.2}}}}]}}
bodies:
  - name: drum
    kind: kinematic
    slip: {slip}
    angular_velocity: [0, 0, 12.566]
    shape: {{sphere: {{centre: {centre}, radius: 0.2, inverted: true}}}}
method: {{kind: grid}}
time: {{end: 0.5}}
output: {{interval: 0}}
"""

VESSEL = """
schema_version: 1
title: A ball of liquid in a free-slip vessel
domain: {{min: [-0.25, -0.25, -0.25], max: [0.25, 0.25, 0.25], spacing: {spacing}, gravity: [0, 0, 0]}}
liquids:
  - name: syrup
    density: 1000
    viscosity: {viscosity}
    subtract_bodies: true
    {motion}
    shapes: [{{sphere: {{centre: {centre}, radius: 0.2}}}}]
bodies:
  - {{name: vessel, {kind}, slip: free_slip, shape: {{sphere: {{centre: {centre}, radius: 0.2, inverted: true}}}}}}
method: {{kind: grid}}
time: {{end: {end}}}
output: {{interval: 0}}
"""

HIT = """
schema_version: 1
title: A body hits a blob
{domain}
liquids: [{{name: syrup, density: 1000, viscosity: {viscosity}, shapes: [{{sphere: {{centre: {centre}, radius: 0.3}}}}]}}]
bodies:
  - name: b
    kind: dynamic
    density: 1000
    velocity: {velocity}
    angular_velocity: [0, 0, 5]
    slip: {slip}
    shape: {{box: {{min: {box_low}, max: {box_high}}}}}
method: {{kind: grid}}
time: {{end: 0.3, {step}}}
output: {{interval: 0}}
"""


def run_text(context, text, name, ranks):
    with scratch(context, name) as folder:
        scene = folder / "scene.yaml"
        scene.write_text(text)
        run = run_scene(context, scene, folder / "run", ranks=ranks)
        return run.steps(), (run.bodies() if "bodies:" in text else None)


def heaps(context):
    eighths = [0.0025 * k for k in range(9)]
    cases = [(x, y, z) for x, y, z in itertools.product(eighths, repeat=3)]
    found, short = 0, []
    for number, (x, y, z) in enumerate([(0.005, 0.005, 0.01)] + context.sample(cases, 3, 24)):
        end = 2 if context.quick or number else 10
        steps, _ = run_text(context, TANK.format(low=[x, y, z], high=[0.36 - 0.5 * x, 0.36 - 0.5 * y, 0.28], end=end), "tank", 1 + number % 3)
        error, energy = steps["density error after"].max(), steps["kinetic energy"] + steps["potential energy"]
        speed = steps["max speed"][steps["time"] > SPLASH].max() / math.sqrt(2 * 9.81 * 0.28)
        found = max(found, error)
        if error > 2 or energy.max() > 1.002 * energy[0] or speed > 1.05 or (number == 0 and error > 1):
            short.append(f"off by {x}, {y}, {z}: density error {error:.2f}, speed {speed:.2f}")
    return Figure(f"worst density error {found:.2f}" + "".join(f"; {text}" for text in short), not short)


def ramps(context):
    angles, places = [3 * k + 2 for k in range(20)], [k / 20 for k in range(20)]
    cases = itertools.product(angles, places, (1, 30, 1e3, 1e5, 1e6), ("static", "kinematic"), (1, 2, 3))
    worst, short = 0, []
    for degrees, place, viscosity, kind, ranks in context.sample(cases, 6, 80):
        angle = math.radians(degrees)
        normal, along = (math.sin(angle), math.cos(angle)), (math.cos(angle), -math.sin(angle))
        at = (0.9, 1.2 + 0.02 * place)  # no liquid reaches the ramp's ends
        middle = [x + 0.15 * n for x, n in zip(at, normal)]
        ramp = f"kind: static, shape: {{plane: {{point: {list(at)}, normal: {list(normal)}}}}}"
        if kind == "kinematic":  # carried along its own surface
            below = [x - 0.15 * n + 0.06 * part for x, n, part in zip(at, normal, along)]
            ramp = (f"kind: kinematic, velocity: {[0.5 * part for part in along]}, shape: {{box: {{min: [-0.85, -0.15], max: [0.85, 0.15], "
                    f"rotation_angle: -{degrees} deg, translation: {below}}}}}")
        steps, _ = run_text(context, RAMP.format(viscosity=viscosity, degrees=degrees, middle=middle, ramp=ramp), "ramp", ranks)
        speed = sum(steps[f"momentum {axis}"][-1] * part for axis, part in zip("xy", along)) / steps["mass"][-1]
        error = speed / (9.81 * math.sin(angle) * steps["time"][-1]) - 1
        worst = max(worst, abs(error))
        if abs(error) > 0.05:
            short.append(f"{degrees} degrees, {place} of a cell, {viscosity:g} Pa s: {100 * error:+.1f} %")
    return Figure(f"within {100 * worst:.1f} % of g sin" + "".join(f"; {text}" for text in short), not short)


def drums(context):
    cases = itertools.product((0, 1, 100, 1e5, 1e6), (0.02, 0.01), (0, 0.25, 0.5), (1, 2, 3))
    worst, short = 0, []
    for viscosity, spacing, offset, ranks in context.sample(cases, 4):
        steps, _ = run_text(context, DRUM.format(spacing=spacing, viscosity=viscosity, centre=[offset * spacing, 0.6 * offset * spacing],
                                                 slip="free_slip"), "drum", ranks)
        speed = math.sqrt(2 * steps["kinetic energy"][-1] / steps["mass"][-1]) / (12.566 * 0.2)
        worst = max(worst, speed)
        if speed > 0.05:
            short.append(f"{viscosity:g} Pa s, {spacing} m, {offset} of a cell: {speed:.3f}")
    return Figure(f"liquid at most at {worst:.3f} of the drum's speed" + "".join(f"; {text}" for text in short), not short)


def vessels(context):
    """Spin of liquid that turns at 3 rad/s in a vessel at rest, and of liquid at rest in one that turns at 12.566 rad/s."""
    cases = itertools.product((1, 1e4, 1e5, 1e6), (0.025, 0.0125), (0, 0.25, 0.5), (1, 2, 3))
    kept, dragged, short = 1, 0, []
    for viscosity, spacing, offset, ranks in context.sample(cases, 4, 24):
        middle = [offset * spacing, 0.6 * offset * spacing, -0.3 * offset * spacing]

        def spins(motion, kind, end):
            steps, _ = run_text(context, VESSEL.format(spacing=spacing, viscosity=viscosity, centre=middle, motion=motion, kind=kind, end=end), "vessel", ranks)
            turning = steps["angular momentum z"] - middle[0] * steps["momentum y"] + middle[1] * steps["momentum x"]
            return turning / (0.4 * steps["mass"] * 0.2**2)

        turning = spins(f"angular_velocity: [0, 0, 3]\n    pivot: {{point: {middle}}}", "kind: static", 0.333)
        resting = spins("velocity: [0, 0, 0]", "kind: kinematic, angular_velocity: [0, 0, 12.566]", 0.25)
        keeps, drags = turning[-1] / 3, abs(resting).max() / 12.566
        kept, dragged = min(kept, keeps), max(dragged, drags)
        if not (0.8 if viscosity > 1e5 else 0.95) < max(turning) / 3 < 1.05 or keeps < (0.8 if viscosity > 1e5 else 0.95) or drags > 0.05:
            short.append(f"{viscosity:g} Pa s, {spacing} m, {offset} of a cell: keeps {keeps:.3f}, {drags:.3f} of the vessel's speed")
    return Figure(f"liquid keeps {kept:.3f} of its spin at least; at rest at most {dragged:.3f} of the vessel's speed" + "".join(f"; {text}" for text in short), not short)


def gripping_drum(context):
    """Rate of the liquid by its angular momentum over its moment of inertia where its particles are."""
    with scratch(context, "drum") as folder:
        (folder / "scene.yaml").write_text(DRUM.format(spacing=0.01, viscosity=100, centre=[0, 0], slip="no_slip"))
        frame = run_scene(context, folder / "scene.yaml", folder / "run", ranks=2, set={"output.interval": 0.5}).frame()
    x, v = frame["position"], frame["velocity"]
    squares = (x**2).sum(axis=1)
    rate = (x[:, 0] * v[:, 1] - x[:, 1] * v[:, 0]).sum() / squares.sum()
    inertia = squares.mean() / (0.5 * 0.2**2)
    return Figure(f"{rate:.3f} rad/s, moment of inertia {inertia:.3f} of a full drum's", abs(rate / 12.566 - 1) < 0.015 and abs(inertia - 1) < 0.03)


def hits(context):
    cases = itertools.product((2, 3), ("no_slip", "free_slip", "slip_length\n    slip_length: 20 mm"), (0, 1, 100, 1e5), ("step: 1 ms", "step: 5 ms", "cfl: 3"), (1, 2, 3))
    linear = angular = 0
    for dimensions, slip, viscosity, step, ranks in context.sample(cases, 4, 24):
        space = dimensions == 3
        steps, bodies = run_text(context, HIT.format(
            domain=open_domain(dimensions, [-1] * dimensions, [1] * dimensions, "50 mm" if space else "20 mm", [0] * dimensions), viscosity=viscosity,
            centre=[0] * dimensions, velocity=[1.5] + [0] * (dimensions - 1), slip=slip, box_low=[-0.6, 0.05, -0.1][:dimensions],
            box_high=[-0.4, 0.15, 0.1][:dimensions], step=step), "hit", ranks)
        mass = 1000 * 0.2 * 0.1 * (0.2 if space else 1)
        inertia = mass * (0.2**2 + 0.1**2) / 12
        body = numpy.array([mass * bodies[f"b velocity {axis}"] for axis in "xyz"])
        place = numpy.array([bodies[f"b position {axis}"] for axis in "xyz"])
        turning = inertia * bodies["b angular velocity z"] + place[0] * body[1] - place[1] * body[0]
        total = numpy.array([steps[f"momentum {axis}"] for axis in "xyz"]) + body
        about = steps["angular momentum z"] + turning
        exchanged = abs(body[0] - body[0][0]).max()
        first = -0.1 * 1.5 * mass + 5 * inertia
        if not exchanged > 0.02 * 1.5 * mass:
            return Figure(f"{viscosity:g} Pa s, {slip}: the body has met nothing", False)
        linear = max(linear, abs(total - numpy.array([[1.5 * mass], [0], [0]])).max() / exchanged)
        angular = max(angular, abs(about - first).max() / abs(first))
    return Figure(f"linear {linear:.1e} of what is exchanged, angular {100 * angular:.2f} %", linear <= 1e-10 and angular <= 0.01)


def add_rows(table):
    table.row("nothing piles up", claim="a tank of water seeded 0 to 1 cell off its walls along each axis, 1 to 3 ranks; 10 s of `tank_off_the_wall`",
              asked="density error bounded, < 1 in the scene; nothing above 1.05 sqrt(2 g H) after the splash, 0.25 s")(heaps)
    table.row("ramps", claim="free-slip ramps of 2 to 59 degrees, 20 places within a cell, 1 to 1e6 Pa s, 1 to 3 ranks", asked="g sin within 5 %")(ramps)
    table.row("free-slip drums", claim="12.57 rad/s around liquid at rest, 0 to 1e6 Pa s, places within a cell, 1 to 3 ranks",
              asked="the liquid stays")(drums)
    table.row("free-slip vessels", claim="balls of liquid, 1 to 1e6 Pa s, two spacings, places within a cell, 1 to 3 ranks: 3 rad/s in a vessel at rest, and at "
              "rest in one at 12.57 rad/s", asked="keeps 0.95 of its spin after 1 rad, 0.8 at 1e6 Pa s, and gains none; at rest <= 5 % of the vessel's")(vessels)
    table.row("no-slip drum", claim="12.57 rad/s, steps of 11 ms", asked="12.57 rad/s inside within 1.5 %, moment of inertia within 3 %")(gripping_drum)
    table.row("momentum of all", claim="a body hits a blob, plane and space, any slip, 0 to 1e5 Pa s, steps of 1 ms, 5 ms and cfl 3, 1 to 3 ranks",
              asked="linear 1e-10 of what is exchanged, angular 1 %")(hits)
