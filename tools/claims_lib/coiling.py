"""A poured rope that coils: its onset and its frequency, for the row of `viscosity`."""

import numpy

from .run import run_scene, scratch
from .table import Figure

RADIUS, SPACING = 0.01, 0.004  # [m] of the opening, of the particles
HEIGHT, LOW = 0.14, 0.04  # [m] of the opening over the floor: high enough to buckle, and not
VISCOSITY = 2000  # [Pa s]
SLICE = 0.35  # of the height: where the rope is watched, above what has piled up

SCENE = """
schema_version: 1
domain:
  min: [0, 0, 0]
  max: [0.24, 0.24, {top}]
  spacing: {spacing}
  boundaries: {{z_min: {{slip: no_slip}}, x_min: open, x_max: open, y_min: open, y_max: open, z_max: open}}
liquids: [{{name: syrup, density: 1000, viscosity: {viscosity}}}]
inlets:
  - disc: {{centre: [0.12, 0.12, {height}], direction: [0.02, 0.01, -1], radius: {radius}}}
    velocity: {speed}
time: {{end: {end}, cfl: 0.3}}
output: {{interval: {interval}}}
"""


def watch(run, height, spacing):
    """Times and middles of the rope in a slice a few spacings thick at a height, after it has met the floor."""
    times, middles, met = [], [], False
    for number, (time, _) in enumerate(run.frames()):
        x = run.frame(number, sorted_by=None)["position"]
        met = met or (len(x) > 0 and x[:, 2].min() < spacing)
        near = x[numpy.abs(x[:, 2] - height) < 1.5 * spacing] if len(x) else x
        if met and len(near):
            times.append(time)
            middles.append(near[:, :2].mean(axis=0))
    return numpy.array(times), numpy.array(middles)


def swings(times, middles):
    """Frequency [Hz] of the motion along its longer axis, from its passages through the middle, its amplitude [m], and
    how many of them there are. The first quarter, in which it sets in, does not count."""
    times, middles = times[len(times) // 4:], middles[len(times) // 4:]
    moved = middles - middles.mean(axis=0)
    axis = numpy.linalg.eigh(moved.T @ moved)[1][:, -1]
    along = numpy.convolve(moved @ axis, numpy.ones(5) / 5, mode="valid")
    clock = times[2:-2]
    amplitude = numpy.sqrt(2) * along.std()
    passages, side = [], 0
    for t, value in zip(clock, along):
        if abs(value) < 0.3 * amplitude:  # noise about the middle is no passage
            continue
        if side and numpy.sign(value) != side:
            passages.append(t)
        side = numpy.sign(value)
    if len(passages) < 3:
        return 0.0, amplitude, len(passages)
    return (len(passages) - 1) / (2 * (passages[-1] - passages[0])), amplitude, len(passages)


def pour(context, folder, height, speed, length):
    """Frequency [Hz], amplitude [m] and passages of a rope poured from a height [m], that many heights of it."""
    scene = folder / f"rope_{height}_{speed}.yaml"
    scene.write_text(SCENE.format(top=height + 0.04, spacing=SPACING, viscosity=VISCOSITY, height=height, radius=RADIUS,
                                  speed=speed, end=length * height / speed, interval=0.004 / speed))
    run = run_scene(context, scene, folder / scene.stem, ranks=0, timeout=4 * 3600)
    return swings(*watch(run, SLICE * height, SPACING))


def coiling(context):
    """In the viscous regime a rope swings at Omega ~ Q / (H a^2), that is, at its speed over the height: at an exponent of 1
    of the flow rate. It must be higher than some five times its width to buckle at all (Cruickshank & Munson 1981)."""
    speeds = (0.2, 0.4) if context.quick else (0.15, 0.3, 0.6)
    length = 14 if context.quick else 20
    with scratch(context, "coiling") as folder:
        still = pour(context, folder, LOW, speeds[-1], 4)
        found = [pour(context, folder, HEIGHT, speed, length) for speed in speeds]
    steady = still[1] < 0.25 * RADIUS
    swinging = all(passages >= 3 for _, _, passages in found)
    text = f"from {1e3 * LOW:.0f} mm {'steady' if steady else 'NOT steady'}, {1e3 * still[1]:.1f} mm; from {1e3 * HEIGHT:.0f} mm: "
    text += ", ".join(f"{f:.2f} Hz by {1e3 * amplitude:.0f} mm at {speed} m/s" for speed, (f, amplitude, _) in zip(speeds, found))
    if not swinging:
        return Figure(text + "; too few swings to tell a frequency", False)
    exponent = numpy.polyfit(numpy.log(speeds), numpy.log([f for f, _, _ in found]), 1)[0]
    return Figure(f"{text}: exponent {exponent:.2f}", bool(steady and abs(exponent - 1) <= 0.2))


def add_rows(table):
    table.row("coiling", claim="a poured rope buckles and coils from a height on, and the faster the more is poured",
              asked="viscous regime, 5 particles across, rho g H^2 / (mu U) < 0.7: frequency by flow rate to the power "
                    "1 +- 20 %; steady from twice its width")(coiling)
