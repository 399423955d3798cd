"""Rows of `sph` on contact of bodies: sliding over seams, mass ratios, restitution, rolling, steps in time."""

import functools
import itertools
import math

import numpy

from .run import run_scene, scratch
from .sph_runs import GRAVITY, on_ranks, over_cases
from .table import Figure

GLIDE = """
schema_version: 1
title: A frictionless box glides on a slab
domain: {dimensions: 2, min: [-1, -0.5], max: [2, 1], spacing: 2.5 cm}
liquids: [{name: water, density: 1000, shapes: [{box: {min: [1.8, -0.5], max: [2, -0.4]}}]}]
bodies:
  - {name: floor, friction: 0, shape: {box: {min: [-1, -0.2], max: [1.7, 0]}}}
  - {name: b, kind: dynamic, density: 2000, friction: 0, velocity: [1, 0], shape: {box: {min: [-0.9, 0], max: [-0.7, 0.1]}}}
time: {end: 1.5, rule: fixed, step: 0.002}
output: {interval: 0.1}
"""

# A drop of liquid far from all, since a scene has one.
SLIDE = """
schema_version: 1
title: A body moves on static ones
domain: {{dimensions: {dimensions}, min: {low}, max: {high}, spacing: {spacing}, gravity: {gravity}}}
liquids: [{{name: water, density: 1000, shapes: [{{box: {{min: {water_low}, max: {water_high}}}}}]}}]
bodies:
{floor}
  - {{name: b, kind: dynamic, density: 2000, friction: {friction}, velocity: {velocity}, shape: {{{shape}}}}}
time: {{end: {end}, rule: fixed, step: {step}}}
output: {{interval: 0}}
"""

DRY = """
schema_version: 1
title: Bodies on the floor, and water behind walls
domain: {{min: [-1, -1, 0], max: [1, 1, 2], spacing: 5 cm}}
liquids: [{{name: water, density: 1000, shapes: [{{box: {{min: [0.9, 0.9, 0], max: [1, 1, 0.1]}}}}]}}]
bodies:
  - {{name: w1, shape: {{box: {{min: [0.7, 0.7, 0], max: [0.75, 1, 0.4]}}}}}}
  - {{name: w2, shape: {{box: {{min: [0.75, 0.7, 0], max: [1, 0.75, 0.4]}}}}}}
{bodies}
time: {{end: {end}, rule: fixed, step: {step}}}
output: {{interval: 0.1}}
"""

STACK = """  - {{name: b0, kind: dynamic, density: 500, shape: {{box: {{min: [-0.1, -0.1, 0], max: [0.1, 0.1, 0.2]}}}}}}
  - {{name: b1, kind: dynamic, density: {density}, shape: {{box: {{min: [-0.1, -0.1, 0.2], max: [0.1, 0.1, 0.4]}}}}}}"""

BALL = "  - {{name: b, kind: dynamic, density: 2000, restitution: {restitution}, shape: {{sphere: {{centre: [0, 0, 1.1], radius: 0.1}}}}}}"

FLIGHT = "  - {name: b, kind: dynamic, density: 2000, velocity: [0.3, 0.2, 4], angular_velocity: [3, 4, 1], " \
         "shape: {box: {min: [-0.1, -0.2, 0.5], max: [0.1, 0.2, 0.6]}}}"


END = 0.8 # of slides [s]


def place(bodies, name="b"):
    return numpy.array([bodies[f"{name} position {axis}"] for axis in "xyz"])


def glides(along, speed, way):
    """Check of a body that must go on as it does: its speed and the way it comes by, to 1 %."""
    def judge(run):
        bodies = run.bodies()
        moved = place(bodies)
        gone = sum(part * (moved[axis] - moved[axis][0]) for axis, part in enumerate(along))[-1]
        gone += speed[0] * bodies["time"][0] # in the first step
        last = sum(part * bodies[f"b velocity {'xyz'[axis]}"][-1] for axis, part in enumerate(along))
        return (f"{gone:.3f} of {way:.3f} m, {last:.3f} of {speed[-1]:.3f} m/s", abs(gone / way - 1) <= 0.01 and abs(last / speed[-1] - 1) <= 0.01)

    return judge


def glide(context):
    return on_ranks(context, GLIDE, "glide", glides((1, 0, 0), (1, 1), 1.5))


def slab_mesh(path, low, high, cells):
    """Triangles of a box, its top cut into cells: internal edges."""
    (x0, y0, z0), (x1, y1, z1) = low, high
    points, faces, at = [], [], {}

    def point(x, y, z):
        key = (round(x, 9), round(y, 9), round(z, 9))
        if key not in at:
            at[key] = len(points)
            points.append(key)
        return at[key]

    def sheet(origin, one, two):
        for i, j in itertools.product(range(cells), repeat=2):
            a, b, c, d = (point(*(origin[k] + one[k] * s / cells + two[k] * t / cells for k in range(3)))
                          for s, t in ((i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)))
            faces.extend([(a, b, c), (a, c, d)])

    x, y, z = (x1 - x0, 0, 0), (0, y1 - y0, 0), (0, 0, z1 - z0)
    sheet((x0, y0, z1), x, y)
    sheet((x0, y0, z0), y, x)
    sheet((x0, y0, z0), x, z)
    sheet((x0, y1, z0), z, x)
    sheet((x0, y0, z0), z, y)
    sheet((x1, y0, z0), y, z)
    path.write_text("".join(f"v {a} {b} {c}\n" for a, b, c in points) + "".join(f"f {a + 1} {b + 1} {c + 1}\n" for a, b, c in faces))


def slide_scene(dimensions, ground, degrees, friction, folder, *, ball=False):
    """A body on a slope along x, by gravity that leans: floors stay flat, and their seams lie across its way."""
    space = dimensions == 3
    lean = math.radians(degrees)
    gravity = [GRAVITY * math.sin(lean), *([0] if space else []), -GRAVITY * math.cos(lean)]

    def at(x, up, across=0.0):
        return [x, across, up] if space else [x, up]

    def box(low, high):
        return f"{{box: {{min: {low}, max: {high}}}}}"

    def slab(x0, x1):
        return box(at(x0, -0.2, -0.5), at(x1, 0, 0.5))

    if ground == "boxes":
        cuts = numpy.linspace(-1, 3.5, 10)
        shapes = [slab(round(float(a), 6), round(float(b), 6)) for a, b in zip(cuts, cuts[1:])]
    elif ground == "mesh":
        slab_mesh(folder / "slab.obj", (-1, -0.5, -0.2), (3.5, 0.5, 0), 9)
        shapes = [f"{{mesh: {{file: {folder / 'slab.obj'}}}}}"]
    else:
        shapes = [slab(-1, 3.5) if ground == "box" else f"{{plane: {{point: {at(0, 0)}, normal: {at(0, 1)}}}}}"]
    floor = "\n".join(f"  - {{name: floor{number}, friction: {friction}, shape: {shape}}}" for number, shape in enumerate(shapes))
    shape = f"sphere: {{centre: {at(-0.7, 0.1)}, radius: 0.1}}" if ball else box(at(-0.8, 0, -0.1), at(-0.6, 0.1, 0.1))[1:-1]
    return SLIDE.format(
        dimensions=dimensions, low=at(-1, -0.5, -0.5), high=at(4, 1, 0.5), spacing="5 cm" if space else "2.5 cm", gravity=gravity,
        water_low=at(3.8, 0, -0.5), water_high=at(4, 0.1, -0.3), floor=floor, friction=friction,
        velocity=at(1 if not ball else 0, 0), shape=shape, end=END, step=0.002)


def slides(context):
    """Without and with friction, on the flat and on slopes, over seams and internal edges."""
    cases = [case for case in itertools.product((2, 3), ("box", "boxes", "plane", "mesh"), (0, 10, 30), (0, 0.1))
             if (case[0] == 3 or case[1] != "mesh") and (case[2] or not case[3])]

    def judge(run, case):
        lean = math.radians(case[2])
        pull = GRAVITY * (math.sin(lean) - case[3] * math.cos(lean))
        return glides((1, 0, 0), (1, 1 + pull * END), END + pull * END**2 / 2)(run)

    return over_cases(context, context.sample(cases, 6), "slide", lambda case: functools.partial(slide_scene, *case), judge,
                      lambda case: f"{case[0]}D {case[1]}, {case[2]} degrees, friction {case[3]}")


def rolls(context):
    """A disc or ball on a slope rolls at g sin / (1 + k), k its inertia over m r^2, over seams too."""
    cases = context.sample(itertools.product((2, 3), ("box", "boxes", "plane"), (10, 30)), 4)

    def judge(run, case):
        pull = GRAVITY * math.sin(math.radians(case[2])) / (1 + (0.5 if case[0] == 2 else 0.4))
        return glides((1, 0, 0), (0, pull * END), pull * END**2 / 2)(run)

    return over_cases(context, cases, "roll", lambda case: functools.partial(slide_scene, *case, 1, ball=True), judge,
                      lambda case: f"{case[0]}D {case[1]}, {case[2]} degrees")


def rests(run):
    """Neither of two boxes leaves its place by more than a millimetre."""
    bodies = run.bodies()
    start = {"b0": (0, 0, 0.1), "b1": (0, 0, 0.3)}
    moved = {name: float(numpy.abs(place(bodies, name) - numpy.array(middle)[:, None]).max()) for name, middle in start.items()}
    return ", ".join(f"{name} moves by {1000 * way:.2f} mm" for name, way in moved.items()), max(moved.values()) <= 1e-3


def stack_scene(ratio, end=3):
    return DRY.format(bodies=STACK.format(density=500 * ratio), end=end, step=0.002)


def heavy_on_light(context):
    return on_ranks(context, stack_scene(1000), "stack", rests)


def mass_ratios(context):
    cases = context.sample((0.001, 0.01, 0.1, 1, 3, 10, 30, 100, 300, 1000), 3)
    return over_cases(context, cases, "stack", stack_scene, lambda run, _: rests(run), lambda ratio: f"{ratio} to 1")


def peaks(height):
    """Tops of a flight, each by a parabola through its highest three values."""
    tops = [k for k in range(1, len(height) - 1) if height[k] >= height[k - 1] and height[k] > height[k + 1]]
    found = []
    for k in tops:
        a, b, c = height[k - 1], height[k], height[k + 1]
        found.append(float(b + (a - c) ** 2 / (8 * (2 * b - a - c))))
    return found


def bounce(restitution):
    """Peaks at e^2, e^4 .. of the first height, those above a centimetre."""
    def judge(run):
        bodies = run.bodies()
        height = bodies["b position z"] - 0.1
        energy = GRAVITY * height + 0.5 * sum(bodies[f"b velocity {axis}"] ** 2 for axis in "xyz")
        wanted = [restitution ** (2 * (k + 1)) for k in range(5)]
        wanted = [one for one in wanted if one > 0.01]
        found = [one for one in peaks(height) if one > 0.005][:len(wanted)]
        gained = float(energy.max()) / GRAVITY - 1
        ok = len(found) >= min(len(wanted), 4) and all(abs(one / two - 1) <= 0.01 for one, two in zip(found, wanted)) and gained <= 0.001
        return f"peaks {', '.join(f'{one:.3f}' for one in found) or 'none'} m, energy at most {100 * gained:+.2f} %", ok

    return judge


def ball_scene(restitution, step=0.002):
    return DRY.format(bodies=BALL.format(restitution=restitution), end=5 if restitution > 0.5 else 2, step=step)


def ball_restitution_1(context):
    return on_ranks(context, ball_scene(1.0), "ball", bounce(1.0))


def restitutions(context):
    cases = context.sample(itertools.product((0, 0.25, 0.5, 0.75, 0.9, 1), (0.004, 0.002, 0.0007)), 4)
    return over_cases(context, cases, "ball", lambda case: ball_scene(*case), lambda run, case: bounce(case[0])(run),
                      lambda case: f"restitution {case[0]}, steps of {1e3 * case[1]:g} ms")


def flight_at(context, step, end=0.8):
    """Place and angular velocity of a box that flies and tumbles."""
    with scratch(context, "flight") as folder:
        scene = folder / "scene.yaml"
        scene.write_text(DRY.format(bodies=FLIGHT, end=end, step=step))
        bodies = run_scene(context, scene, folder / "run").bodies()
    return place(bodies)[:, -1], numpy.array([bodies[f"b angular velocity {axis}"][-1] for axis in "xyz"])


def orders(context):
    """Of the place to the parabola, and of the angular velocity by how runs with halved steps differ."""
    steps = [0.008, 0.004, 0.002]
    exact = numpy.array([0.3 * 0.8, 0.2 * 0.8, 0.55 + 4 * 0.8 - GRAVITY * 0.8**2 / 2])
    found = [flight_at(context, step) for step in steps]
    off = [float(numpy.linalg.norm(place - exact)) for place, _ in found]
    turned = [float(numpy.linalg.norm(one[1] - two[1])) for one, two in zip(found, found[1:])]
    least = 1e-9
    falls = max(off) < least or math.log2(off[-2] / off[-1]) >= 1.8
    turns = max(turned) < least or math.log2(turned[0] / turned[1]) >= 1.8
    return Figure(f"off the parabola by {', '.join(f'{one:.1e}' for one in off)} m at steps of 8, 4, 2 ms; angular velocity changes by "
                  f"{', '.join(f'{one:.1e}' for one in turned)} rad/s as they are halved", falls and turns)


def add_rows(table):
    table.row("glide", claim="a box without friction glides on a flat static body; 1, 2, 3 ranks", asked="1.5 m at 1.5 s, 1 m/s, to 1 %")(glide)
    table.row("sliding", claim="2D and 3D, on a box, nine boxes, a plane, a mesh, 0 to 30 degrees, with and without friction, 1 to 3 ranks",
              asked="way and speed to 1 %")(slides)
    table.row("rolling", claim="disc and ball, on a box, nine boxes, a plane, 10 and 30 degrees, 1 to 3 ranks", asked="way and speed to 1 %")(rolls)
    table.row("heavy_on_light", claim="a box on one of a thousandth of its density, dry, 3 s; 1, 2, 3 ranks",
              asked="rests, within 1 mm")(heavy_on_light)
    table.row("mass ratios", claim="a box on another, 0.001 to 1000 times its density, 3 s, 1 to 3 ranks", asked="rest, within 1 mm")(mass_ratios)
    table.row("ball_restitution_1", claim="a ball that bounces without loss, 5 s; 1, 2, 3 ranks", asked="peaks 1.000 m ± 1 %, no gain above 0.1 %")(
        ball_restitution_1)
    table.row("restitution", claim="0 to 1, steps of 0.7, 2, 4 ms, 1 to 3 ranks", asked="peaks e^2 .. to 1 %, no gain above 0.1 %")(restitutions)
    table.row("rigid motion", claim="a box that flies and tumbles, steps of 8, 4, 2 ms", asked="second order")(orders)
