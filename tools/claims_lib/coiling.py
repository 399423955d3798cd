"""A poured rope that coils: its onset and its frequency, for the row of `viscosity`."""

import concurrent.futures
import dataclasses
import os

import numpy

from .run import run_scene, scratch
from .table import CommandFailed, Figure

DENSITY, GRAVITY = 1000.0, 9.81
RADIUS, SPACING = 0.01, 0.004  # [m] of the opening, of the particles
LOW = 0.04    # height [m] of the opening over the floor at which a rope does not buckle
SHARE = 0.35  # of the height of fall: where the rope is watched, above what has piled up
WIDE = 1.7    # times a rope's width: a heap
THICK = 3     # spacings, of the slice in which the rope is watched
TURN = 2 * numpy.pi


@dataclasses.dataclass(frozen=True)
class Regime:
    """What balances the viscous force of bending sets how fast a rope coils (Ribe 2004). The viscosity and the speeds are such that
    this balance is the fastest, by two and more, and the coil at least twice as wide as the rope.

    Not here: inertia. Its coil, U / Omega wide, would have to be a fourth of what the height of fall allows and still three radii
    wide. From 600 mm at 2e5 Pa s, 8 and 16 m/s, frequencies are 0.40 and 0.33 of that balance and grow with the power 1.07."""

    name: str
    viscosity: float    # [Pa s]
    height: float       # of the opening [m]
    speeds: tuple       # of the flow through it [m/s]
    length: float       # of rope that is poured [m]
    least_fall: float   # height [m] that the heap has to leave
    exponent: float     # of the flow rate in the frequency

    def balance(self, flow, swings):
        """Omega [1/s] at a flow rate [m3/s], the height of fall and the radius that the rope has, without its factor of order
        one."""
        nu, radius = self.viscosity / DENSITY, RADIUS * swings.section**0.5
        return {"viscous": flow / (swings.fall * radius**2),
                "gravitational": (GRAVITY * flow**3 / (nu * radius**8)) ** 0.25}[self.name]


REGIMES = (Regime("viscous", 2e5, 0.14, (0.15, 0.3, 0.6), 1.4, 0.06, 1),
           Regime("gravitational", 3e4, 0.3, (0.03, 0.06, 0.12), 1.5, 0.15, 3 / 4))

SCENE = """
schema_version: 1
domain:
  min: [0, 0, 0]
  max: [0.32, 0.32, {top}]
  spacing: {spacing}
  boundaries: {{z_min: {{slip: no_slip}}, x_min: {{kind: open, outflow: true}}, x_max: {{kind: open, outflow: true}}, y_min: {{kind: open, outflow: true}}, y_max: {{kind: open, outflow: true}}, z_max: open}}
liquids: [{{name: syrup, density: {density}, viscosity: {viscosity}}}]
inlets:
  - disc: {{centre: [0.16, 0.16, {height}], direction: [0.02, 0.01, -1], radius: {radius}}}
    velocity: {speed}
time: {{end: {end}, cfl: 0.3}}
output: {{interval: {interval}}}
"""


def top_of_heap(x, height):
    """Height [m] of what has piled up on the floor: the highest slice that is wider than a rope's, a disc of the opening's
    radius."""
    slices = numpy.arange(0, height, 1.5 * SPACING)
    top = 0.0
    for low, high in zip(slices, slices[1:]):
        inside = x[(x[:, 2] >= low) & (x[:, 2] < high)][:, :2]
        if len(inside) and numpy.sqrt(inside.var(axis=0).sum()) > WIDE * RADIUS / numpy.sqrt(2):
            top = high
    return top


@dataclasses.dataclass
class Rope:
    """From when it has met the floor on, a number a frame."""

    time: numpy.ndarray     # [s]
    fall: numpy.ndarray     # height of fall onto the heap [m]
    middle: numpy.ndarray   # [n][2] of its slice [m]
    section: numpy.ndarray  # of that slice over the opening's


def watch(run, height):
    rows, met = [], False
    for number, (time, _) in enumerate(run.frames()):
        x = run.frame(number, sorted_by=None)["position"]
        met = met or (len(x) > 0 and x[:, 2].min() < SPACING)
        if not met:
            continue
        top = top_of_heap(x, height)
        near = x[numpy.abs(x[:, 2] - top - SHARE * (height - top)) < THICK * SPACING / 2]
        if len(near):
            section = len(near) * SPACING**2 / (THICK * numpy.pi * RADIUS**2)
            rows.append((time, height - top, *near[:, :2].mean(axis=0), section))
    table = numpy.array(rows).reshape(-1, 5)
    return Rope(table[:, 0], table[:, 1], table[:, 2:4], table[:, 4])


@dataclasses.dataclass(frozen=True)
class Swings:
    count: int         # of half turns, along both axes
    amplitude: float   # [m] along the longer axis
    frequency: float   # [Hz]
    fall: float        # [m], mean
    section: float     # of the rope over the opening's, mean


def passages(along, amplitude):
    """Frames at which it has passed its middle to the other side."""
    found, side = [], 0
    for number, value in enumerate(along):
        if abs(value) < 0.3 * amplitude:  # noise about the middle is no passage
            continue
        if side and numpy.sign(value) != side:
            found.append(number)
        side = numpy.sign(value)
    return found


def swings(rope, settled, least_fall):
    """Half turns along both axes of the motion, from one passage through the middle to the next, from a time on, before which the
    rope falls over for the first time, and while the heap leaves enough of the height."""
    kept = (rope.time >= settled) & (rope.fall >= least_fall)
    if kept.sum() < 20:
        raise CommandFailed(f"the rope was seen {kept.sum()} times, too few to tell whether it swings")
    moved = rope.middle[kept] - rope.middle[kept].mean(axis=0)
    smooth = [numpy.convolve(moved @ axis, numpy.ones(5) / 5, mode="valid") for axis in numpy.linalg.eigh(moved.T @ moved)[1].T]
    amplitudes = [numpy.sqrt(2) * along.std() for along in smooth]
    clock = rope.time[kept][2:-2]
    count, seconds = 0, 0.0
    for along, amplitude in zip(smooth, amplitudes):
        found = passages(along, amplitude)
        if amplitude < 0.4 * max(amplitudes) or len(found) < 2: # folds in a plane do not turn
            continue
        count += len(found) - 1
        seconds += clock[found[-1]] - clock[found[0]]
    return Swings(count, max(amplitudes), 0.5 * count / seconds if count else 0.0, rope.fall[kept].mean(), rope.section[kept].mean())


def pour(context, folder, regime, speed):
    scene = folder / f"{regime.name}_{regime.height}_{speed}.yaml"
    scene.write_text(SCENE.format(top=regime.height + 0.04, spacing=SPACING, density=DENSITY, viscosity=regime.viscosity,
                                  height=regime.height, radius=RADIUS, speed=speed, end=regime.length / speed,
                                  interval=SPACING / speed))
    run = run_scene(context, scene, folder / scene.stem, ranks=0, timeout=4 * 3600)
    return swings(watch(run, regime.height), 2 * regime.height / speed, regime.least_fall)


def describe(regime, speeds, found):
    """Words, and whether the exponent of the flow rate is the regime's, at equal heights of fall and radii."""
    flows = [numpy.pi * RADIUS**2 * speed for speed in speeds]
    text = f"{regime.name}, {regime.viscosity:g} Pa s from {1e3 * regime.height:.0f} mm: " + ", ".join(
        f"{speed} m/s {one.count} swings by {1e3 * one.amplitude:.0f} mm"
        + (f", {one.frequency:.3g} Hz ({TURN * one.frequency / regime.balance(flow, one):.2f} of the balance)"
           if one.count else "") for speed, flow, one in zip(speeds, flows, found))
    if not all(one.count >= 2 for one in found):
        return f"{text}; too few swings to tell a frequency", False
    exponent = numpy.polyfit(numpy.log(flows), numpy.log([one.frequency / regime.balance(1, one) for one in found]), 1)[0]
    return f"{text}: exponent {exponent:.2f} of {regime.exponent:.2f}", abs(exponent / regime.exponent - 1) <= 0.2


def coiling(context):
    """A rope must be higher than some five times its width to buckle at all (Cruickshank & Munson 1981)."""
    viscous = REGIMES[0]
    speeds = {regime.name: regime.speeds[1:] if context.quick else regime.speeds for regime in REGIMES}
    low = dataclasses.replace(viscous, height=LOW, length=8 * LOW, least_fall=0.0)
    with scratch(context, "coiling") as folder, concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        # A rope has few particles: each run is one of several at once, on a rank of its own. The longest come first.
        still = pool.submit(pour, context, folder, low, viscous.speeds[-1])
        runs = {(regime.name, speed): pool.submit(pour, context, folder, regime, speed)
                for regime in reversed(REGIMES) for speed in speeds[regime.name]}
        amplitude = still.result().amplitude
        parts = [describe(regime, speeds[regime.name], [runs[regime.name, speed].result() for speed in speeds[regime.name]])
                 for regime in REGIMES]
    steady = amplitude < 0.25 * RADIUS
    text = f"from {1e3 * LOW:.0f} mm {'steady' if steady else 'NOT steady'}, {1e3 * amplitude:.1f} mm; "
    return Figure(text + "; ".join(words for words, _ in parts), bool(steady and all(ok for _, ok in parts)))


def add_rows(table):
    table.row("coiling", claim="a poured rope, 5 particles across, buckles and coils from a height on, and the faster the more is "
              "poured", asked="frequency by flow rate to the power 1 and 3/4, at equal heights of fall and radii, in the viscous and in the "
              "gravitational regime, ± 20 % each; steady from twice its width")(coiling)
