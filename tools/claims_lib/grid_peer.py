"""A row of `grid` that compares with rlguy/FLIPViscosity3D: --peer flipviscosity3d=PATH of its checkout.

Its example is a bunny that falls into a sphere; flipviscosity3d.cpp is that with other numbers, and is compiled against
the peer's sources as its Makefile would.
"""

import pathlib
import re

import numpy

from .run import execute, run_scene, scratch
from .table import CommandFailed, Figure

NAME = "flipviscosity3d"
RANKS = 2
STEP, GRAVITY = 0.01, 9.81  # [s], of both at most; [m/s2]
STEPS = 24
TOUCH = 0.171               # [s], when the bunny reaches the sphere
VISCOSITIES = (5, 500)      # [Pa s] at 1 kg/m3
RESIDUAL = 1e-8
WANTED = 3                  # times faster
FLAT = 1.25                 # most growth of the time of a liquid cell from 64^3 to 192^3; its cores share their memory

# The peer's mesh of the sphere is round to 1e-7. Its y is up.
SCENE = """
schema_version: 1
title: A bunny of syrup falls into a sphere
domain:
  max: [1, 1, 1]
  gravity: [0, -{gravity}, 0]
  spacing: {spacing}
  boundaries: {{x_min: {{slip: no_slip}}, x_max: {{slip: no_slip}}, y_min: {{slip: no_slip}}, y_max: {{slip: no_slip}},
               z_min: {{slip: no_slip}}, z_max: {{slip: no_slip}}}}
liquids:
  - name: syrup
    density: 1
    viscosity: {viscosity}
    shapes: [{{mesh: {{file: "{bunny}"}}}}]
bodies:
  - {{name: sphere, shape: {{sphere: {{centre: [0.5, 0.5, 0.5], radius: 0.45, inverted: true}}}}, slip: no_slip}}
method: {{kind: grid, grid: {{pressure: {{residual: {residual}}}, viscosity: {{residual: {residual}}}}}}}
time: {{end: {end}, step: {step}}}
output: {{interval: 0}}
"""


def meshes(context):
    folder = pathlib.Path(context.peer(NAME)).resolve() / "sample_meshes"
    if not (folder / "stanford_bunny.ply").exists():
        raise CommandFailed(f"no stanford_bunny.ply in {folder}")
    return folder


def build_peer(context, folder):
    source = pathlib.Path(context.peer(NAME)).resolve() / "src"
    program = folder / NAME
    windows = ["-Derrno_t=int", "-Dfopen_s(file,name,mode)=((*(file)=fopen(name,mode))==nullptr)"]  # its loadOBJ reads no other
    files = [path for path in sorted(source.glob("*.cpp")) if path.name != "main.cpp"]
    execute(context, ["c++", "-O3", "-std=c++11", *windows, f"-I{source}", pathlib.Path(__file__).with_name("flipviscosity3d.cpp"),
                      *files, "-o", program])
    return program


def run_peer(context, program, cells, viscosity, folder):
    """Seconds of each step, and the particles at the first one."""
    output = execute(context, [program, cells, viscosity, STEP, STEPS, meshes(context)], timeout=8 * 3600, cwd=folder).output
    found = re.findall(r"step \d+: ([0-9.]+) s, (\d+) particles", output)
    if len(found) != STEPS:
        raise CommandFailed(f"the peer took {len(found)} steps of {STEPS}")
    return numpy.array([float(seconds) for seconds, _ in found]), int(found[0][1])


def our_steps(context, cells, viscosity, folder):
    """Of one run, for all that use it."""
    return context.once(("bunny in a sphere", cells, viscosity), lambda: run_ours(context, cells, viscosity, folder))


def run_ours(context, cells, viscosity, folder):
    scene = folder / f"scene_{cells}_{viscosity}.yaml"
    scene.write_text(SCENE.format(spacing=1 / cells, viscosity=viscosity, bunny=meshes(context) / "stanford_bunny.ply",
                                  gravity=GRAVITY, residual=RESIDUAL, step=STEP, end=STEP * STEPS))
    return run_scene(context, scene, folder / f"ours_{cells}_{viscosity}", ranks=RANKS, timeout=4 * 3600).steps()


def seconds_of(steps):
    return sum(steps[phase] for phase in ("sort", "transfer", "surface", "pressure", "viscosity", "move", "correct"))


def compare(context, program, cells, viscosity, folder):
    """A line of text, and whether ours is as much faster as required: in the air, and in the sphere."""
    theirs, particles = run_peer(context, program, cells, viscosity, folder)
    steps = our_steps(context, cells, viscosity, folder)
    ours, landed = seconds_of(steps), steps["time"] > TOUCH
    their_landed = STEP * numpy.arange(1, STEPS + 1) > TOUCH
    ratios = [float(theirs[~their_landed].mean() / ours[~landed].mean()), float(theirs[their_landed].mean() / ours[landed].mean())]
    text = (f"{cells}^3, {viscosity} m2/s: {int(steps['particles'][0])} particles and its {particles}, "
            f"in the air {ours[~landed].mean():.2f} s a step and its {theirs[~their_landed].mean():.2f}, {ratios[0]:.1f} times; "
            f"in the sphere {ours[landed].mean():.2f} s and its {theirs[their_landed].mean():.2f}, {ratios[1]:.1f} times, "
            f"{steps['stokes iterations'][landed].mean():.0f} iterations")
    return text, min(ratios) >= WANTED


def growth(context, folder):
    """Microseconds of a step for each liquid cell, in the sphere, from 64^3 to 192^3."""
    costs = {}
    for cells in (48, 64) if context.quick else (64, 128, 192):
        steps = our_steps(context, cells, VISCOSITIES[0], folder)
        landed = steps["time"] > TOUCH
        costs[cells] = 1e6 * float((seconds_of(steps) / steps["pressure unknowns"])[landed].mean())
    text = ", ".join(f"{cost:.1f} at {cells}^3" for cells, cost in costs.items())
    return f"microseconds a liquid cell and step: {text}", max(costs.values()) <= FLAT * costs[min(costs)]


def against_peer(context):
    context.peer(NAME)
    with scratch(context, "peer") as folder:
        program = build_peer(context, folder)
        lines = [compare(context, program, 64 if context.quick else 128, viscosity, folder) for viscosity in VISCOSITIES]
        lines.append(growth(context, folder))
    return Figure("; ".join(text for text, _ in lines), all(ok for _, ok in lines))


def add_rows(table):
    table.row("against FLIPViscosity3D", claim=f"its bunny falls into a sphere, 128^3, {STEPS} steps of {1e3 * STEP:g} ms, 5 and 500 "
              f"m2/s, ours to residuals of {RESIDUAL:g} on {RANKS} ranks, its own limits on one thread",
              asked=f">= {WANTED} times faster in the air and in the sphere; time a liquid cell flat from 64^3 to 192^3")(against_peer)
