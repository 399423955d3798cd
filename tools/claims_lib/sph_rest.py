"""Rows of `sph` on liquid under its weight: tanks at rest and sloshing, dam breaks, columns and ropes that hang, bodies let go."""

import functools
import itertools

import numpy

from . import dam_breaks, repairs_time
from .run import run_scene, scratch
from .scenes import open_domain
from .sph_runs import GRAVITY, judged, on_ranks, over_cases, scene_run
from .table import Figure

SETTLED, LAYERS_ACROSS = 0.5, 10 # [s], of a deep tank

TANK = """
schema_version: 1
title: Water at rest
domain: {{min: [0, 0, 0], max: [{width}, {width}, 1.2], spacing: {spacing}}}
liquids:
  - {{name: water, density: 1000, viscosity: 1 mPa.s, shapes: [{{box: {{min: [0, 0, 0], max: [{width}, {width}, 1]}}}}]}}
time: {{end: 2}}
output: {{interval: 0.1}}
"""

# Held at the top between plates that it sticks to.
COLUMN = """
schema_version: 1
title: A stiff column hangs
{domain}
liquids: [{{name: pitch, density: 1000, viscosity: {viscosity}, shapes: [{{box: {{min: {column_low}, max: {column_high}}}}}]}}]
bodies:
{plates}
method: {{kind: sph}}
time: {{end: {end}}}
output: {{interval: {interval}, double_precision: true}}
"""

ROPE = """
schema_version: 1
title: A rope that its weight stretches
domain:
  min: [0, 0, 0]
  max: [0.16, 0.16, 0.34]
  spacing: 4 mm
  boundaries: {{z_min: {{slip: no_slip}}, x_min: open, x_max: open, y_min: open, y_max: open, z_max: open}}
liquids: [{{name: syrup, density: 1000, viscosity: {viscosity}}}]
inlets:
  - {{disc: {{centre: [0.08, 0.08, 0.3], direction: [0, 0, -1], radius: 10 mm}}, velocity: {speed}}}
method: {{kind: sph}}
time: {{end: {end}}}
output: {{interval: 0.02}}
"""

FREE_DROP = """
schema_version: 1
title: A free drop
domain:
  dimensions: 2
  min: [-0.15, -0.15]
  max: [0.15, 0.15]
  spacing: 5 mm
  gravity: [0, 0]
  boundaries: {{x_min: open, x_max: open, y_min: open, y_max: open}}
liquids:
  - {{name: syrup, density: 1000, viscosity: {viscosity}, angular_velocity: [0, 0, {spin}], shapes: [{{sphere: {{centre: [0, 0], radius: 0.1}}}}]}}
method: {{kind: sph}}
time: {{end: 1}}
output: {{interval: 0.1}}
"""

LIGHT = """
schema_version: 1
title: A light disc is let go under water
domain: {{dimensions: 2, min: [-0.4, -0.4], max: [0.4, 0.45], spacing: {spacing}}}
liquids: [{{name: water, density: 1000, viscosity: 1 mPa.s, subtract_bodies: true, shapes: [{{box: {{min: [-0.4, -0.4], max: [0.4, 0.4]}}}}]}}]
bodies: [{{name: b, kind: dynamic, density: {density}, shape: {{sphere: {{centre: [0, 0], radius: 0.05}}}}}}]
method: {{kind: sph}}
time: {{end: 0.04}}
output: {{interval: 0}}
"""


def at_rest(run):
    """What is wrong with a tank at its outputs: the worst of each, and whether all of them are right."""
    bodies, weight = run.bodies(), run.steps()["mass"][0] * GRAVITY
    level, slope, force, speed, seen = [], [], [], [], 0
    for number, (time, _) in enumerate(run.frames()):
        if time < SETTLED - 1e-9:
            continue
        frame = run.frame(number)
        z, p = frame["position"][:, 2], frame["pressure"]
        bulk = (z > 0.2) & (z < 0.8)
        seen += 1
        level.append(2 * z.mean() - 1)
        slope.append(-numpy.polyfit(z[bulk], p[bulk], 1)[0] / (1000 * GRAVITY) - 1)
        step = int(numpy.abs(bodies["time"] - time).argmin())
        force.append(-bodies["z_min pressure force z"][step] / weight - 1)
        speed.append(float(numpy.linalg.norm(frame["velocity"], axis=1).max()))
    if not seen:
        return f"no output from {SETTLED} s on", False
    worst = [float(numpy.abs(one).max()) for one in (level, slope, force)]
    ranges = [f"{100 * min(one):+.2f} .. {100 * max(one):+.2f} %" for one in (level, slope, force)]
    return (f"{seen} outputs, level {ranges[0]}, slope {ranges[1]}, floor force {ranges[2]}, speed {max(speed):.3f} m/s",
            worst[0] <= 0.003 and worst[1] <= 0.02 and worst[2] <= 0.02 and max(speed) <= 0.05 and seen >= 16)


def deep_tank(layers):
    def measure(context):
        spacing = 1 / layers
        width = LAYERS_ACROSS * spacing
        return on_ranks(context, TANK.format(width=width, spacing=spacing), "tank", at_rest)

    return measure


def stretched(start, rate):
    """Distances over the lower end of a column of what was `start` above it: rate = rho g t / Trouton's viscosity [1/m]."""
    return -numpy.log1p(-rate * start) / rate


def column_scene(dimensions, across, viscosity, end):
    """A column a tenth of a metre wide and five times as long, that hangs out of plates of twice its width."""
    width, length, space = 0.1, 0.5, dimensions == 3
    spacing, half = width / across, width / 2
    room = half + 0.1
    thick = [(-room, -half), (half, room)]
    sides = ["{min: [%g, 0%s], max: [%g, 0.2%s]}" % (low, f", {-room:g}" if space else "", high, f", {room:g}" if space else "")
             for low, high in thick]
    if space:
        sides += ["{min: [%g, 0, %g], max: [%g, 0.2, %g]}" % (-half, low, half, high) for low, high in thick]
    plates = "\n".join(f"  - {{name: plate{number}, slip: no_slip, shape: {{box: {box}}}}}" for number, box in enumerate(sides))

    def at(x, y):
        return [x, y] + ([x] if space else [])

    return COLUMN.format(
        domain=open_domain(dimensions, at(-room, -0.8), at(room, 0.25), spacing, [0, -GRAVITY, 0][:dimensions]),
        viscosity=viscosity, end=end, interval=end / 10, plates=plates,
        column_low=at(-half, -length), column_high=at(half, 0.2))


def trouton(run, dimensions, viscosity, end):
    """Growth of the middle of the column beside that of a thread, at the last output; its width enters at the plates alone."""
    (time, _), first, last = run.frames()[-1], run.frame(0), run.frame(-1)
    if len(run.frames()) < 2 or len(first["id"]) != len(last["id"]):
        return f"at {time:.2f} s {len(first['id']) - len(last['id'])} particles lost, no figure", False
    start = first["position"][:, 1]
    low = start < start.min() + 1e-4
    over = start - start[low].mean()
    now = last["position"][:, 1] - last["position"][low, 1].mean()
    rate = 1000 * GRAVITY * time / ((4 if dimensions == 2 else 3) * viscosity)
    middle = (over > 0.1) & (over < 0.35)
    exact = stretched(over, rate) - over
    grown = numpy.polyfit(exact[middle], now[middle] - over[middle], 1)[0]
    return f"at {time:.2f} of {end:.2f} s stretched {grown:.3f} times as much", abs(grown - 1) <= 0.05 and time > 0.99 * end


def hanging_columns(context):
    cases = itertools.product(((2, 10), (2, 20), (3, 8)), (1e4, 1e5))
    parts, right = [], True
    for number, ((dimensions, across), viscosity) in enumerate([((2, 10), 1e4)] if context.quick else cases):
        end = (1.5 if dimensions == 2 else 1) * viscosity / 1e4
        with scene_run(context, column_scene(dimensions, across, viscosity, end), "column", ranks=1 + number % 3) as (run, fault):
            words, ok = judged(run, fault, lambda run: trouton(run, dimensions, viscosity, end))
        parts.append(f"{dimensions}D, {across} across, {viscosity:g} Pa s: {words}")
        right = right and ok
    return Figure("; ".join(parts), right)


def ropes(context):
    cases = context.sample(itertools.product((100, 1000), (0.1, 0.2, 0.4)), 3)
    return over_cases(context, cases, "rope", lambda case: ROPE.format(viscosity=case[0], speed=case[1], end=0.4 / case[1]), widest_gap,
                      lambda case: f"{case[0]} Pa s, {case[1]} m/s")


def widest_gap(run, _):
    """Along the rope, from when it has met the floor on."""
    widest, met = 0.0, False
    for number, _ in enumerate(run.frames()):
        z = numpy.sort(run.frame(number, sorted_by=None)["position"][:, 2])
        met = met or (len(z) > 0 and z[0] < 4e-3)
        if met:
            widest = max(widest, float(numpy.diff(z).max()))
    return f"gaps up to {1e3 * widest:.1f} mm" if met else "has not met the floor", met and widest <= 8e-3


def nearest(position):
    """Distance of each particle to its nearest neighbour [m]."""
    away = numpy.linalg.norm(position[:, None] - position[None], axis=2)
    numpy.fill_diagonal(away, numpy.inf)
    return away.min(axis=1)


def unclumped(run, _):
    found = numpy.quantile(nearest(run.frame(-1)["position"]), 0.01) / 5e-3
    return f"closest {found:.2f} spacings apart", found >= 0.7


def free_drops(context):
    cases = context.sample(itertools.product((0.001, 1, 100, 1e4), (0, 3)), 2)
    return over_cases(context, cases, "drop", lambda case: FREE_DROP.format(viscosity=case[0], spin=case[1]), unclumped,
                      lambda case: f"{case[0]:g} Pa s, {case[1]} rad/s")


def let_go(run, case):
    """A disc of a share s of the liquid's density starts at g (1 - s)/(s + C), C = (b^2 + a^2)/(b^2 - a^2) in a tank of radius b."""
    wall = (8**2 + 1) / (8**2 - 1)
    bodies = run.bodies()
    exact = GRAVITY * (1 - case[0]) / (case[0] + wall)
    ratios = [bodies.at("b velocity y", time) / (exact * time) for time in (0.005, 0.01, 0.02, 0.04)]
    return (f"speed beside that of its added mass at 5, 10, 20, 40 ms {', '.join(f'{one:.2f}' for one in ratios)}",
            all(abs(one - 1) <= 0.1 for one in ratios))


def light_bodies(context):
    cases = context.sample(itertools.product((0.1, 0.3, 0.5, 0.9), (0.01, 0.005)), 2)
    return over_cases(context, cases, "light", lambda case: LIGHT.format(density=1000 * case[0], spacing=case[1]), let_go,
                      lambda case: f"density {case[0]}, {case[1]} m")


def broken_dam(context, name, end):
    """What a run of an input measured: time, front [m], height [m]."""
    with scratch(context, name) as folder:
        run = run_scene(context, context.root / "inputs" / name / "scene.yaml", folder / "run",
                        set={"time.end": end, "output.interval": 0})
        values = run.measurements()
        return values["time"], values["front"], values["height"]


def martin_moyce(context):
    time, front, height = broken_dam(context, "martin_moyce", 0.405)
    width = dam_breaks.MARTIN_MOYCE_WIDTH
    return dam_breaks.martin_moyce(time, front / width, height / (2 * width), front_within=0.06, height_within=0.06)


def koshizuka_oka(context):
    time, front, _ = broken_dam(context, "koshizuka_oka", 0.3)
    return dam_breaks.koshizuka_oka(time, front / dam_breaks.KOSHIZUKA_OKA_WIDTH, within=0.06)


def add_rows(table):
    for layers in (20, 50, 100):
        table.row(f"deep_tank, {layers} layers", claim=f"1 m of water at rest, each output from {SETTLED} to 2 s; 1, 2, 3 ranks",
                  asked="level 0.3 %, slope 2 %, floor force 2 % of the weight, speed <= 0.05 m/s")(deep_tank(layers))
    table.row("tanks of water", claim="0.3 m at rest, and columns that collapse and slosh, 10 s, two spacings",
              asked="energy <= +0.2 %, speed <= 1.05 sqrt(2 g H) outside of splashes")(functools.partial(repairs_time.water_tanks, kind="sph"))
    table.row("Martin & Moyce", claim="front and height of the column",
              asked="within 6 % (front after a shift of T of at most 0.15)")(martin_moyce)
    table.row("Koshizuka & Oka", claim="front of the column", asked="within 6 %")(koshizuka_oka)
    table.row("hanging column", claim="2D of 10 and 20 particles across, 3D of 8, 1e4 and 1e5 Pa s, until the top is stretched by a fifth",
              asked="Trouton's law within 5 %")(hanging_columns)
    table.row("ropes", claim="100 and 1000 Pa s from 0.3 m, 5 particles across, 0.1 to 0.4 m/s, 1 to 3 ranks",
              asked="hang together: no gap above two spacings")(ropes)
    table.row("free drops", claim="40 particles across, 1 mPa s to 1e4 Pa s, at rest and turning, 1 s, 1 to 3 ranks",
              asked="no clumps: 99 % of particles >= 0.7 spacings apart")(free_drops)
    table.row("light bodies", claim="a disc of 0.1 to 0.9 of the liquid's density let go in it, 5 and 10 particles a radius, 1 to 3 ranks",
              asked="starts with its added mass: speed ± 10 % at 5, 10, 20, 40 ms")(light_bodies)
