"""Rows of `repairs` on small inputs: what leaves the plane, messages, lids, walls that slide, loads and pressures of walls."""

import itertools
import re

import numpy

from .gtest import run_gtest
from .run import RunFolder, run_scene, scratch, treacle
from .table import Figure

METHODS = ("sph", "grid")
RANKS = (1, 2, 3)

PLANE = """schema_version: 1
domain: {{dimensions: 2, min: [-0.25, -0.25], max: [0.25, 0.25], spacing: 1 cm, gravity: [0, 0]}}
liquids: [{{name: w, density: 1000, viscosity: 100, subtract_bodies: true, shapes: [{{sphere: {{centre: [0, 0], radius: 0.2}}}}]{liquid}}}]
bodies: [{{name: drum, kind: kinematic, slip: no_slip, shape: {{sphere: {{centre: [0, 0], radius: 0.2, inverted: true}}}}, {body}}}]
{more}
method: {{kind: {method}}}
time: {{end: 0.1}}
output: {{interval: 0}}
"""
STILL = "angular_velocity: 1"
SHORT_SPIN = "angular_velocity: [0, 12.566]"  # of two numbers: no list of three, whatever the plane
# What leaves the plane: of the liquid, the body, and other blocks; the line of each.
LEAVING = (
    ("", SHORT_SPIN, "", 4), ("", "angular_velocity: [1, 0, 0]", "", 4),
    ("", "velocity: [0, 0, 1]", "", 4), ("", "keyframes: [{time: 1, rotation_axis: [1, 0], rotation_angle: 1}]", "", 4),
    ("", "keyframes: [{time: 1, translation: [0, 0, 1]}]", "", 4), (", velocity: [0, 0, 1]", STILL, "", 3),
    ("", STILL, "inlets: [{velocity: 1, disc: {centre: [0, 0], direction: [0, 0, 1], radius: 5 cm}}]", 5),
)

SHEAR = """schema_version: 1
title: A shear flow
domain:
  dimensions: 2
  max: [0.2, {top}]
  spacing: {spacing}
  gravity: [0, 0]
  boundaries: {{x_min: periodic, x_max: periodic, y_min: {{slip: no_slip}}, y_max: {ceiling}}}
liquids: [{{name: syrup, density: 1000, viscosity: {viscosity}, shapes: [{{box: {{min: [0, 0], max: [0.2, 0.2]}}}}]}}]
{bodies}
method: {{kind: {method}}}
time: {{end: {end}, step: {step}}}
output: {{interval: {end}, fields: [velocity]}}
"""
LID = "bodies: [{name: lid, kind: kinematic, slip: no_slip, velocity: [0.1, 0], shape: {box: {min: [0, 0.2], max: [0.2, 0.26]}}}]"

CAVITY = """schema_version: 1
title: Lid-driven cavity, Re 100
domain:
  dimensions: 2
  max: [1, 1]
  spacing: {spacing}
  gravity: [0, 0]
  boundaries: {{x_min: {{slip: no_slip}}, x_max: {{slip: no_slip}}, y_min: {{slip: no_slip}}, y_max: {{slip: no_slip, velocity: [1, 0]}}}}
liquids: [{{name: liquid, density: 1000, viscosity: 10, shapes: [{{box: {{min: [0, 0], max: [1, 1]}}}}]}}]
method: {{kind: grid}}
time: {{end: {end}, cfl: 1}}
output: {{interval: {end}, fields: [velocity]}}
"""

TANK = """schema_version: 1
title: A tank at rest
domain: {{dimensions: 2, max: [{width}, 0.6], spacing: 2 cm, boundaries: {{x_min: {{slip: {slip}}}, x_max: {{slip: {slip}}}, y_min: {{slip: {slip}}}}}}}
liquids: [{{name: liquid, density: 1000, viscosity: {viscosity}, shapes: [{{box: {{min: [0, 0], max: [{width}, 0.4]}}}}]}}]
method: {{kind: grid}}
time: {{end: 1}}
output: {{interval: 1, fields: [pressure]}}
"""


def plane(context):
    cases = context.sample(itertools.product(LEAVING, METHODS, RANKS), 6)
    wrong = []
    for (liquid, body, more, line), method, ranks in cases:
        with scratch(context, "plane") as folder:
            (folder / "scene.yaml").write_text(PLANE.format(liquid=liquid, body=body, more=more, method=method))
            done = treacle(context, "run", folder / "scene.yaml", "--out", folder / "run", ranks=ranks, expect=None)
            reason = "of which the first two are 0" if body == SHORT_SPIN else "; the scene is plane"
            said = re.findall(rf"scene\.yaml:{line}: .*{reason}.*", done.output)
            if done.code != 2 or len(said) != 1 or (folder / "run").exists():
                wrong.append(f"{body or liquid or more}, {method}, {ranks} ranks: code {done.code}, {len(said)} messages")
    for method in METHODS:
        with scratch(context, "plane") as folder:
            for name, spin in (("number", "3"), ("list", "[0, 0, 3]")):
                (folder / f"{name}.yaml").write_text(PLANE.format(liquid="", body=f"angular_velocity: {spin}", more="", method=method))
                run_scene(context, folder / f"{name}.yaml", folder / name)
            turned = [turn_of(folder / name) for name in ("number", "list")]
            if not abs(turned[0] - 0.3) < 1e-9 or turned[0] != turned[1]:
                wrong.append(f"angular_velocity: 3, {method}: turned by {turned}")
    return Figure(f"{len(cases)} refused, a number is taken" if not wrong else "; ".join(wrong), not wrong)


def turn_of(folder):
    """The drum's rotation at the end [rad]."""
    return float(RunFolder(folder).bodies()["drum rotation z"][-1])


def messages(context):
    reports = [run_gtest(context, "base_text_test", "Text.NumbersThatDifferAreToldApart"),
               run_gtest(context, "base_document_test", "Yaml.ATabInTheIndentationIsNamed"),
               run_gtest(context, "sph_formulas_test", "CellGrid.NamesAPeriodAndItsLeast*")]
    return Figure("; ".join(report.text() for report in reports), all(report.ok for report in reports))


def shear(context, cases, scene):
    worst, short = {}, []
    for method, ranks, size in cases:
        with scratch(context, "shear") as folder:
            (folder / "scene.yaml").write_text(scene(method, size))
            run = run_scene(context, folder / "scene.yaml", folder / "run", ranks=ranks)
            frame, bodies = run.frame(), run.bodies()
        slope = frame["velocity"][:, 0] - 0.1 * frame["position"][:, 1] / 0.2
        mover = "lid" if "lid viscous force x" in bodies else "y_max"
        drags = [-bodies[f"{mover} viscous force x"][-1], bodies["y_min viscous force x"][-1]]
        error = max(float(numpy.abs(slope).max()) / 0.1, *(abs(drag / (size[1] * 0.1) - 1) for drag in drags))
        worst[method] = max(worst.get(method, 0), error)
        if not error < 0.03:
            short.append(f"{method}, {ranks} ranks, {size}: {100 * error:.1f} %")
    return Figure(", ".join(f"{method} {100 * error:.2f} %" for method, error in worst.items()) + "".join(f"; {text}" for text in short), not short)


SIZES = ((0.01, 100), (0.005, 100), (0.01, 1e4))


def scene_of(lid):
    def make(method, size):
        spacing, viscosity = size
        return SHEAR.format(top=0.26 if lid else 0.2, ceiling="wall" if lid else "{slip: no_slip, velocity: [0.1, 0]}", spacing=spacing,
                            viscosity=viscosity, bodies=LID if lid else "", method=method, end=1 if viscosity < 1e3 else 0.1, step="10 ms")
    return make


def lids(context):
    return shear(context, context.sample(itertools.product(METHODS, RANKS, SIZES), 3), scene_of(True))


def sliding_walls(context):
    return shear(context, context.sample(itertools.product(METHODS, RANKS, SIZES), 3), scene_of(False))


def cavity(context):
    """Ghia, Ghia and Shin 1982, Re 100: the extremes along the middle lines."""
    cells = 32 if context.quick else 64
    with scratch(context, "cavity") as folder:
        (folder / "scene.yaml").write_text(CAVITY.format(spacing=1 / cells, end=15))
        frame = run_scene(context, folder / "scene.yaml", folder / "run").frame()
    x, u = frame["position"], frame["velocity"]
    found = []
    for axis in (0, 1):
        near = numpy.abs(x[:, axis] - 0.5) < 1 / cells
        place = numpy.floor(x[near, 1 - axis] * cells).astype(int)
        mean = numpy.bincount(place, u[near, axis], cells) / numpy.bincount(place, minlength=cells)
        found += [float(mean.min()), float(mean.max())]
    low_u, _, low_v, high_v = found
    errors = [abs(low_u / -0.2109 - 1), abs(low_v / -0.2453 - 1), abs(high_v / 0.1753 - 1)]
    return Figure(f"{cells} cells: u_min {low_u:.4f}, v_min {low_v:.4f}, v_max {high_v:.4f}", max(errors) < 0.05)


def tanks(context):
    worst = {"floor": 0.0, "sides": 0.0, "slope": 0.0, "at the floor": 0.0}
    cases = context.sample(itertools.product((0.4, 0.41), ((0, "free_slip"), (100, "no_slip")), RANKS), 4)
    for width, (viscosity, slip), ranks in cases:
        with scratch(context, "tank") as folder:
            (folder / "scene.yaml").write_text(TANK.format(width=width, viscosity=viscosity, slip=slip))
            run = run_scene(context, folder / "scene.yaml", folder / "run", ranks=ranks)
            frame, bodies, mass = run.frame(), run.bodies(), run.steps()["mass"][-1]
        late = bodies["time"] > 0.5
        load = {name: numpy.mean(bodies[f"{name} pressure force {axis}"][late] + bodies[f"{name} viscous force {axis}"][late])
                for name, axis in (("y_min", "y"), ("x_min", "x"), ("x_max", "x"))}
        level = mass / (1000 * width)
        push = 0.5 * 9810 * level**2
        y, p = frame["position"][:, 1], frame["pressure"]
        slope, floor = numpy.polyfit(y[y < level - 0.04], p[y < level - 0.04], 1)
        for name, error in (("floor", -load["y_min"] / (9.81 * mass) - 1), ("sides", -load["x_min"] / push - 1),
                            ("sides", load["x_max"] / push - 1), ("slope", -slope / 9810 - 1), ("at the floor", floor / (9810 * level) - 1)):
            worst[name] = max(worst[name], abs(float(error)))
    return Figure(", ".join(f"{name} {100 * error:.2f} %" for name, error in worst.items()), max(worst.values()) < 0.01)


def add_rows(table):
    table.row("plane scenes", claim="what would leave the plane, by velocity, key frame or inlet, both methods, 1 to 3 ranks",
              asked="refused with file:line, exit code 2; angular_velocity: 3 is about z")(plane)
    table.row("messages", claim="numbers that differ are told apart; a tab is named",
              asked="all cases")(messages)
    table.row("lids", claim="a lid as long as the period over a shear flow, both methods, 1 to 3 ranks, two spacings, 100 and 1e4 Pa s",
              asked="profile and drag within 3 %")(lids)
    table.row("sliding walls", claim="Couette flow below a wall with a velocity, both methods, 1 to 3 ranks, two spacings, 100 and 1e4 Pa s",
              asked="profile and drag within 3 %")(sliding_walls)
    table.row("cavity", claim="lid-driven cavity by a wall with a velocity, grid, Re 100", asked="extremes of Ghia et al. within 5 % at 64 cells; with --quick at 32")(cavity)
    table.row("loads and pressures of walls", claim="a tank at rest on the grid, walls on and off the cells' faces, with and without viscosity, 1 to 3 ranks",
              asked="floor carries the weight, sides rho g h^2/2, pressures in frames, all within 1 %")(tanks)
