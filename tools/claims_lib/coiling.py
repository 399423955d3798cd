"""A poured rope that coils: its onset and its frequency, for the row of `viscosity`."""

import numpy

from .run import run_scene, scratch
from .table import Figure

RADIUS, SPACING = 0.01, 0.004  # [m] of the opening, of the particles
HEIGHT, LOW = 0.14, 0.04  # [m] of the opening over the floor: high enough to buckle, and not
VISCOSITY = 2000  # [Pa s]
SHARE = 0.35  # of the height of fall: where the rope is watched, above what has piled up
WIDE = 1.7    # times a rope's width: a heap
LEAST = 0.06  # height of fall that counts, above those at which a rope only thickens [m]
TURN = 2 * numpy.pi

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


def watch(run, height):
    """From when the rope has met the floor on: times, the heights that it falls from onto the heap, and its middles at a share
    of them."""
    times, falls, middles, met = [], [], [], False
    for number, (time, _) in enumerate(run.frames()):
        x = run.frame(number, sorted_by=None)["position"]
        met = met or (len(x) > 0 and x[:, 2].min() < SPACING)
        if not met:
            continue
        top = top_of_heap(x, height)
        near = x[numpy.abs(x[:, 2] - top - SHARE * (height - top)) < 1.5 * SPACING]
        if len(near):
            times.append(time)
            falls.append(height - top)
            middles.append(near[:, :2].mean(axis=0))
    return numpy.array(times), numpy.array(falls), numpy.array(middles)


def swings(times, falls, middles):
    """Amplitude [m] of the motion along its longer axis; from its passages through the middle its frequencies [Hz], one from
    each passage to the next, and the mean heights of fall [m] meanwhile, where these are LEAST or more."""
    moved = middles - middles.mean(axis=0)
    axis = numpy.linalg.eigh(moved.T @ moved)[1][:, -1]
    along = numpy.convolve(moved @ axis, numpy.ones(5) / 5, mode="valid")
    clock, fall = times[2:-2], falls[2:-2]
    amplitude = numpy.sqrt(2) * along.std()
    passages, side = [], 0
    for number, value in enumerate(along):
        if abs(value) < 0.3 * amplitude:  # noise about the middle is no passage
            continue
        if side and numpy.sign(value) != side:
            passages.append(number)
        side = numpy.sign(value)
    swung = [(0.5 / (clock[last] - clock[first]), fall[first:last].mean()) for first, last in zip(passages, passages[1:])]
    high = numpy.array([swing for swing in swung if swing[1] >= LEAST]).reshape(-1, 2)
    return amplitude, high[:, 0], high[:, 1]


def pour(context, folder, height, speed, length):
    """Swings of a rope poured from a height [m], that many heights of it."""
    scene = folder / f"rope_{height}_{speed}.yaml"
    scene.write_text(SCENE.format(top=height + 0.04, spacing=SPACING, viscosity=VISCOSITY, height=height, radius=RADIUS,
                                  speed=speed, end=length * height / speed, interval=0.004 / speed))
    return swings(*watch(run_scene(context, scene, folder / scene.stem, ranks=0, timeout=4 * 3600), height))


def coiling(context):
    """In the viscous regime a rope swings at Omega ~ Q / (H a^2), that is, at its speed over the height: Omega H at an exponent
    of 1 of the flow rate, where H is what the heap leaves of the height. It must be higher than some five times its width to
    buckle at all (Cruickshank & Munson 1981)."""
    speeds = (0.2, 0.4) if context.quick else (0.15, 0.3, 0.6)
    with scratch(context, "coiling") as folder:
        still, _, _ = pour(context, folder, LOW, speeds[-1], 4)
        found = [pour(context, folder, HEIGHT, speed, 10) for speed in speeds]
    steady = still < 0.25 * RADIUS
    text = f"from {1e3 * LOW:.0f} mm {'steady' if steady else 'NOT steady'}, {1e3 * still:.1f} mm; from {1e3 * HEIGHT:.0f} mm: "
    text += ", ".join(
        f"at {speed} m/s {len(rates)} swings by {1e3 * amplitude:.0f} mm"
        + (f", {rates.mean():.2f} Hz over {1e3 * falls.mean():.0f} mm, 2 pi f H / U {TURN * (rates * falls).mean() / speed:.2f}"
           if len(rates) else "") for speed, (amplitude, rates, falls) in zip(speeds, found))
    if not all(len(rates) >= 2 for _, rates, _ in found):
        return Figure(text + "; too few swings to tell a frequency", False)
    exponent = numpy.polyfit(numpy.log(speeds), numpy.log([(rates * falls).mean() for _, rates, falls in found]), 1)[0]
    return Figure(f"{text}: exponent of f H {exponent:.2f}", bool(steady and abs(exponent - 1) <= 0.2))


def add_rows(table):
    table.row("coiling", claim="a poured rope buckles and coils from a height on, and the faster the more is poured",
              asked="viscous regime, 5 particles across, rho g H^2 / (mu U) < 0.7: frequency times height of fall by flow rate "
                    "to the power 1 +- 20 %; steady from twice its width")(coiling)
