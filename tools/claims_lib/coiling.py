"""A poured rope that coils: its onset and its frequency, for the row of `viscosity`."""

import numpy

from .run import run_scene, scratch
from .table import Figure

RADIUS, SPACING, HEIGHT = 0.01, 0.004, 0.14  # [m] of the opening, of the particles, of the opening over the floor
SLICE = 0.35  # of the height: where the rope is watched, above what has piled up
LENGTH = 10  # of rope that is poured, in heights

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


def pour(context, folder, speed, viscosity):
    end = LENGTH * HEIGHT / speed
    folder.mkdir(parents=True)
    scene = folder / "scene.yaml"
    scene.write_text(SCENE.format(top=HEIGHT + 0.04, spacing=SPACING, viscosity=viscosity, height=HEIGHT, radius=RADIUS,
                                  speed=speed, end=end, interval=0.004 / speed))
    run = run_scene(context, scene, folder / "run", ranks=0, timeout=4 * 3600)
    return swings(*watch(run, SLICE * HEIGHT, SPACING))
