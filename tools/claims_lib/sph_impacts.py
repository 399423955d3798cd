"""Rows of `sph` on impacts: a liquid that hits a wall, a body or a liquid loses energy and never gains it."""

import dataclasses
import itertools

import numpy

from .sph_runs import GRAVITY, body_energy, first_energy, liquid_energy, on_ranks, over_cases

MORE = 1.005 # of the energy that came in

FLAT = """
schema_version: 1
title: A slab of water as wide as its box meets the floor
domain: {dimensions: 2, min: [0, 0], max: [0.5, 0.6], spacing: 1 cm}
liquids:
  - {name: water, density: 1000, viscosity: 1 mPa.s, shapes: [{box: {min: [0, 0.05], max: [0.5, 0.35]}}], velocity: [0, -2]}
time: {end: 0.3}
output: {interval: 0.02}
"""

FREE = """
schema_version: 1
title: A block of water with free sides meets the floor
domain: {dimensions: 2, min: [0, 0], max: [1, 1], spacing: 1 cm, gravity: [0, 0]}
liquids:
  - {name: water, density: 1000, viscosity: 1 mPa.s, shapes: [{box: {min: [0.3, 0.1], max: [0.7, 0.5]}}], velocity: [0, -2]}
time: {end: 0.3}
output: {interval: 0.02}
"""

FILM = """
schema_version: 1
title: A box falls on a layer of water
domain: {{min: [0, 0, 0], max: [1, 1, 1], spacing: 4 cm}}
liquids: [{{name: water, density: 1000, shapes: [{{box: {{min: {low}, max: {high}}}}}]}}]
bodies:
  - {{name: c, kind: dynamic, density: 2000, velocity: [0, 0, -2], shape: {{box: {{min: [0.4, 0.4, 0.06], max: [0.6, 0.6, 0.26]}}}}}}
time: {{end: 0.3}}
output: {{interval: 0.05}}
max_lost_fraction: 1
"""

RANGE = """
schema_version: 1
title: A block meets {what}
domain: {{dimensions: {dimensions}, min: {low}, max: {high}, spacing: {spacing}, gravity: {gravity}}}
liquids:
  - {{name: block, density: 1000, viscosity: {viscosity}, velocity: {velocity}, shapes: [{{box: {{min: {block_low}, max: {block_high}}}}}]}}
{others}
method: {{kind: sph}}
time: {{end: {end}}}
output: {{interval: {end}}}
max_lost_fraction: 1
"""

WHATS = ("the floor", "the floor flat", "a pool", "a falling block", "a static body", "a plate that rises", "a dynamic body")
EDGE, GAP = 0.4, 0.1  # of the box, between the block and what it meets [m]


@dataclasses.dataclass(frozen=True)
class Impact:
    dimensions: int
    what: str
    speed: float      # [m/s]
    viscosity: float  # [Pa s]
    layers: int       # particles along the box's edge
    falls: bool       # under gravity

    def text(self):
        return (f"{self.dimensions}D, {self.what}, {self.speed} m/s, {self.viscosity:g} Pa s, {self.layers} across, "
                f"{'with' if self.falls else 'no'} gravity")

    def scene(self):
        up = self.dimensions - 1

        def at(sides, height):
            return [sides] * up + [height]

        def box(low, high):
            return f"[{{box: {{min: {low}, max: {high}}}}}]"

        flat = self.what == "the floor flat"
        inset = 0 if flat else 0.1
        floor = {"a pool": 0.1, "a static body": 0.1, "a plate that rises": 0.1, "a falling block": 0.1, "a dynamic body": 0.2}.get(self.what, 0)
        speed = 0 if self.what == "a plate that rises" else self.speed
        still = f"{{name: other, density: 1000, viscosity: {self.viscosity}, shapes: "
        others = {
            "a pool": f"  - {still}{box(at(0, 0), at(EDGE, 0.1))}}}",
            "a falling block": f"  - {still}{box(at(0.1, 0), at(0.3, 0.1))}, velocity: {at(0, self.speed)}}}",
            "a static body": f"bodies: [{{name: b, shape: {box(at(0.1, -0.1), at(0.3, 0.1))[1:-1]}}}]",
            "a plate that rises": f"bodies: [{{name: b, kind: kinematic, velocity: {at(0, self.speed)}, "
                                  f"shape: {box(at(-0.2, -0.1 - 4 * GAP), at(0.6, 0.1))[1:-1]}}}]",
            "a dynamic body": f"bodies: [{{name: b, kind: dynamic, density: 2000, shape: {box(at(0.15, 0), at(0.25, 0.1))[1:-1]}}}]",
        }.get(self.what, "")
        if self.what == "a dynamic body":
            floor = 0.1
        bottom = floor + GAP
        return RANGE.format(
            what=self.what, dimensions=self.dimensions, low=at(0, 0), high=at(EDGE, 1), spacing=EDGE / self.layers,
            gravity=at(0, -GRAVITY if self.falls else 0), viscosity=self.viscosity, velocity=at(0, -speed),
            block_low=at(inset, bottom), block_high=at(EDGE - inset, bottom + 0.2), others=others,
            end=self.end())

    def end(self):
        """Until well after they have met [s]; a plate that rises has room for no more."""
        return GAP / self.speed + 0.15 if self.falls and self.what != "a plate that rises" else 3 * GAP / self.speed

    def judge(self, run):
        """The largest energy beside what came in, with the work of the body that is driven."""
        steps, axis = run.steps(), self.dimensions - 1
        came = first_energy(run, gravity=GRAVITY if self.falls else 0, axis=axis)
        energy = liquid_energy(steps)
        if self.what == "a dynamic body":
            bodies = run.bodies()
            edge = 0.1
            mass = 2000 * edge**self.dimensions
            gravity = GRAVITY if self.falls else 0
            energy = energy + body_energy(bodies, "b", mass, mass * edge**2 / 6, gravity=gravity, axis="xyz"[axis])
            came += mass * gravity * 0.05
        if self.what == "a plate that rises":
            # All that pushes the liquid up is the plate.
            pushed = steps[f"momentum {'xyz'[axis]}"] + steps["mass"] * (GRAVITY if self.falls else 0) * steps["time"]
            came = numpy.maximum(came + self.speed * pushed, 1e-3 * energy.max()) # at rest there is none
        ratio = float((energy / came).max())
        return f"energy {ratio:.3f} of what came in, at most {steps['max speed'].max():.3g} m/s", ratio <= MORE


def never_above(first, axis, gravity):
    def judge(run):
        steps = run.steps()
        came, energy = first_energy(run, gravity=gravity), liquid_energy(steps)
        return (f"energy at most {energy.max():.4g} of {came:.1f} J/m, fastest {steps['max speed'].max():.3g} m/s",
                abs(came / first - 1) < 0.005 and energy.max() <= MORE * came)

    return judge


def flat_impact(context):
    def judge(run):
        text, ok = never_above(594.3, 1, GRAVITY)(run)
        steps = run.steps()
        rebound = float((steps["momentum y"] / steps["mass"]).max())
        return f"{text}, rebound {100 * rebound:.1f} cm/s", ok and rebound <= 0.05

    return on_ranks(context, FLAT, "flat", judge)


def flat_impact_free(context):
    return on_ranks(context, FREE, "free", never_above(320, 1, 0))


def impacts(context):
    cases = [Impact(*case) for case in itertools.product((2,), WHATS, (0.5, 1, 2, 5, 10), (0, 1e-3, 1, 1000), (10, 20, 40, 80), (True, False))]
    cases += [Impact(*case) for case in itertools.product((3,), WHATS, (0.5, 1, 2, 5, 10), (0, 1e-3, 1, 1000), (10, 16, 20, 32), (True, False))]
    if context.quick:
        cases = [case for case in cases if case.layers <= (40 if case.dimensions == 2 else 16)]
    return over_cases(context, context.sample(cases, 8, 120), "impact", Impact.scene, lambda run, case: case.judge(run), Impact.text)


def film(low, high, first):
    """A layer of water, or a few stray particles, under a box that falls."""
    def measure(context):
        def judge(run):
            bodies, steps = run.bodies(), run.steps()
            mass = 2000 * 0.2**3
            came = first_energy(run, axis=2) + mass * (0.5 * 2**2 + GRAVITY * 0.16)
            energy = liquid_energy(steps) + body_energy(bodies, "c", mass, mass * 0.2**2 / 6)
            up = float(bodies["c velocity z"].max())
            return (f"energy at most {energy.max():.1f} of {came:.1f} J, the box up at {max(up, 0):.2f} m/s",
                    abs(came / first - 1) < 0.005 and energy.max() <= MORE * came and up <= 0.05)

        return on_ranks(context, FILM.format(low=low, high=high), "film", judge)

    return measure


def add_rows(table):
    table.row("flat_impact", claim="a slab of water, as wide as the box, meets the floor at 2 m/s; 1, 2, 3 ranks",
              asked="energy <= 594 J/m + 0.5 %, rebound <= 5 cm/s")(flat_impact)
    table.row("flat_impact_free", claim="the same with free sides, no gravity; 1, 2, 3 ranks", asked="energy <= 320 J/m + 0.5 %")(flat_impact_free)
    table.row("impacts", claim="2D and 3D, 0.5 to 10 m/s, 0 to 1000 Pa s, four spacings, on walls, static, driven and dynamic bodies, liquid on "
              "liquid, with and without gravity, 1 to 3 ranks", asked="E(t) <= E(0) + work of bodies, to 0.5 %")(impacts)
    table.row("body_on_film", claim="a box falls on one layer of water; 1, 2, 3 ranks",
              asked="energy <= 64.9 J + 0.5 %, no rebound (5 cm/s)")(film([0, 0, 0], [1, 1, 0.04], 64.9))
    table.row("body on stray particles", claim="the same on four particles; 1, 2, 3 ranks",
              asked="energy never above its first by 0.5 %, no rebound (5 cm/s)")(film([0.44, 0.44, 0], [0.52, 0.52, 0.04], 57.16))
