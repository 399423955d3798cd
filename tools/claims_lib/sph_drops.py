"""Rows of `sph` on surface tension: drops at rest and oscillating."""

import itertools
import math

import numpy

from .scenes import open_domain
from .sph_runs import crossings, on_ranks, over_cases

TENSION = 0.05 # [N/m]

PLANE = """
schema_version: 1
title: A plane drop oscillates
domain:
  dimensions: 2
  min: [-10 mm, -10 mm]
  max: [10 mm, 10 mm]
  spacing: {spacing}
  gravity: [0, 0]
  boundaries: {{x_min: open, x_max: open, y_min: open, y_max: open}}
liquids:
  - {{name: d, density: 1000, viscosity: {viscosity}, surface_tension: 50 mN/m,
     shapes: [{{box: {{min: [-4.5 mm, -3.5 mm], max: [4.5 mm, 3.5 mm]}}}}]}}
method: {{kind: sph, surface_tension: {{model: curvature}}}}
time: {{end: {end}}}
output: {{interval: 1 ms}}
"""

DROP = """
schema_version: 1
title: A drop in free space
{domain}
liquids:
  - {{name: d, density: 1000, viscosity: {viscosity}, surface_tension: {tension}, shapes: [{shape}]}}
method: {{kind: sph, kernel: {kernel}, surface_tension: {{model: curvature}}}}
time: {{end: {end}}}
output: {{interval: {interval}}}
"""

RADIUS = 4e-3 # [m]
LONG = 0.3 # of a capsule: its length over its width, less 1
HALF_PERIOD = 54.4 # of the plane drop, small amplitude, as large as the box [ms]


def shape_of(run):
    """Times, second moments along x less those along y (in space of the axis' mean), and how far the farthest particle is from the middle."""
    time, moments, farthest = [], [], 0.0
    for number, (at, _) in enumerate(run.frames()):
        x = run.frame(number, sorted_by=None)["position"]
        if not len(x):
            break
        x = x - x.mean(axis=0)
        square = (x**2).mean(axis=0)
        time.append(at)
        moments.append(square[0] - (square[1] if not square[2] > 0 else square[1:].mean()))
        farthest = max(farthest, float(numpy.linalg.norm(x, axis=1).max()))
    return numpy.array(time), numpy.array(moments), farthest


def oscillating(spacing, viscosity):
    """The drop is a box at first, whose corners are 5.7 mm from the middle."""
    def measure(context):
        def judge(run):
            steps = run.steps()
            energy = float(steps["kinetic energy"].max())
            lost = int(steps["particles"][0] - steps["particles"][-1])
            time, moments, farthest = shape_of(run)
            passed = crossings(time, moments)
            half = 1e3 * (passed[1] - passed[0]) if len(passed) > 1 else math.nan
            whole = lost == 0 and farthest <= 6.5e-3
            return (f"kinetic energy up to {energy:.2g} J/m, {'whole' if whole else f'NOT whole ({lost} lost, one {1e3 * farthest:.1f} mm away)'}, "
                    + (f"half a period {half:.1f} ms" if len(passed) > 1 else f"{len(passed)} passages in {1e3 * time[-1]:.0f} ms"),
                    energy <= 1.9e-4 and whole and abs(half / HALF_PERIOD - 1) <= 0.04)

        return on_ranks(context, PLANE.format(spacing=spacing, viscosity=viscosity, end=0.09), "drop", judge)

    return measure


def capsule(dimensions):
    """Radius of the round ends of a capsule of the ball's volume whose length is (1 + LONG) times its width [m], and how much more
    surface than the ball it has [m2], in the plane [m]."""
    if dimensions == 2:
        radius = RADIUS / math.sqrt(1 + 4 * LONG / math.pi)
        return radius, (2 * math.pi + 4 * LONG) * radius - 2 * math.pi * RADIUS
    radius = RADIUS / (1 + 1.5 * LONG) ** (1 / 3)
    return radius, 4 * math.pi * ((1 + LONG) * radius**2 - RADIUS**2)


def drop_scene(dimensions, particles, viscosity, kernel, *, long, periods):
    """A ball, or the capsule, and 40 outputs a half period."""
    spacing, half = RADIUS / particles, half_period(dimensions)
    room = spacing * math.ceil(1.8 * particles)
    centre = [0] * dimensions
    shape = f"{{sphere: {{centre: {centre}, radius: {RADIUS}}}}}"
    if long:
        radius, _ = capsule(dimensions)
        shape = f"{{capsule: {{centre: {centre}, axis: {[1, 0, 0][:dimensions]}, radius: {radius}, height: {2 * LONG * radius}}}}}"
    return DROP.format(domain=open_domain(dimensions, [-room] * dimensions, [room] * dimensions, spacing, [0] * dimensions),
                       viscosity=viscosity, tension=TENSION, shape=shape, kernel=kernel, end=2 * periods * half, interval=half / 40)


def half_period(dimensions):
    """Of the second mode without viscosity (Rayleigh 1879) [s]."""
    return math.pi / math.sqrt((6 if dimensions == 2 else 8) * TENSION / (1000 * RADIUS**3))


def cases_of(context, viscosities):
    cases = list(itertools.product((2,), (8, 12, 20, 40), viscosities, ("cubic_spline", "wendland_c2")))
    cases += list(itertools.product((3,), (8, 12, 20), viscosities, ("cubic_spline", "wendland_c2")))
    return [case for case in cases if not context.quick or case[1] <= (20 if case[0] == 2 else 8)]


def case_text(case):
    return f"{case[0]}D, {case[1]} a radius, {case[2]} Pa s, {case[3]}"


def rests(run, case):
    """A ball cut from a lattice has a rough surface, and hence a little too much of it."""
    dimensions, end = case[0], run.frames()[-1][0]
    steps = run.steps()
    surface = TENSION * (2 * math.pi * RADIUS if dimensions == 2 else 4 * math.pi * RADIUS**2)
    energy = steps["kinetic energy"] / surface
    second = steps["time"] > end / 2
    early, late = energy[~second].max(), energy[second].max()
    lost = int(steps["particles"][0] - steps["particles"][-1])
    pressure = []
    for number, (time, _) in enumerate(run.frames()):
        frame = run.frame(number, sorted_by=None)
        inner = numpy.linalg.norm(frame["position"], axis=1) < 0.6 * RADIUS
        if time > end / 2 and inner.any():
            pressure.append(float(frame["pressure"][inner].mean()) * RADIUS / TENSION / (dimensions - 1))
    _, _, farthest = shape_of(run)
    steady = max(pressure) - min(pressure) <= 0.1 and abs(numpy.mean(pressure) - 1) <= 0.1
    return (f"kinetic energy up to {early:.1e} of the surface's, later {late:.1e}, {lost} lost, pressure {min(pressure):.2f} .. "
            f"{max(pressure):.2f} of Laplace's",
            early <= 0.02 and late <= early and lost == 0 and farthest <= 1.15 * RADIUS and steady)


def drops_at_rest(context):
    """For two half periods."""
    cases = context.sample(cases_of(context, (0, 0.001, 0.01, 0.1)), 3)
    return over_cases(context, cases, "rest", lambda case: drop_scene(*case, long=False, periods=1), rests, case_text)


def oscillates(run, case):
    dimensions, steps = case[0], run.steps()
    energy = float(steps["kinetic energy"].max()) / (TENSION * capsule(dimensions)[1])
    lost = int(steps["particles"][0] - steps["particles"][-1])
    time, moments, farthest = shape_of(run)
    passed = crossings(time, moments)
    # A whole one: at rest the moments are not quite equal, so that one half is longer than the other.
    found = (passed[2] - passed[0]) / (2 * half_period(dimensions)) if len(passed) > 2 else math.nan
    swing = f"{found:.3f} of Rayleigh's" if len(passed) > 2 else f"not within {1e3 * time[-1]:.1f} ms"
    return (f"kinetic energy up to {energy:.2f} of the surface's excess, {lost} lost, farthest {farthest / RADIUS:.2f} radii, a period {swing}",
            energy <= 1.15 and lost == 0 and farthest <= 1.6 * RADIUS and abs(found - 1) <= 0.04)


def drops_oscillate(context):
    """From capsules of the same volume; their excess of surface is all the energy there is. Viscosity changes their frequency by
    less than 1 %."""
    cases = context.sample(cases_of(context, (0, 0.001, 0.01)), 3)
    return over_cases(context, cases, "swing", lambda case: drop_scene(*case, long=True, periods=1.75), oscillates, case_text)


def add_rows(table):
    asked = "kinetic energy <= 1.9e-4 J/m, whole, half period 54.4 ms ± 4 %"
    table.row("oscillating_drop_sph", claim="a plane drop of 9 x 7 mm, 0.125 mm, 2 mPa s; 1, 2, 3 ranks", asked=asked)(oscillating(0.125e-3, 2e-3))
    table.row("oscillating_drop_thin_sph", claim="the same at 0.25 mm, 0.5 mPa s; 1, 2, 3 ranks", asked=asked)(oscillating(0.25e-3, 0.5e-3))
    table.row("drops at rest", claim="plane, 8 to 40 particles a radius, and in space, 8 to 20, 0 to 100 mPa s, both kernels, 1 to 3 ranks",
              asked="kinetic energy <= 2 % of the surface's and not growing, none lost, pressure Laplace's ± 10 %, steady to 0.1")(drops_at_rest)
    table.row("oscillating drops", claim="the same, 0 to 10 mPa s, from capsules",
              asked="kinetic energy <= 1.15 of the surface's excess (the lattice is rough), none lost, frequency ± 4 %")(drops_oscillate)
