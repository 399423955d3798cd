"""Rows of `repairs` on the scene: liquids that start with a spin, shapes made of shapes, meshes."""

import itertools

import numpy

from .gtest import run_gtest
from .run import run_scene, scratch, treacle
from .table import Figure

SPIN = """
schema_version: 1
title: A ball that starts with a spin
domain: {{{domain}, spacing: {spacing}, gravity: {gravity}}}
liquids:
  - name: syrup
    density: 1000
    viscosity: {viscosity}
    shapes: [{{sphere: {{centre: {centre}, radius: 0.1}}}}]
    angular_velocity: {spin}
method: {{kind: {kind}}}
time: {{end: 0.2}}
output: {{interval: 0.2, double_precision: true}}
"""
IN_PLANE = {"domain": "dimensions: 2, max: [0.4, 0.4]", "gravity": "[0, 0]", "centre": "[0.2, 0.2]", "spin": "[0, 0, 3]"}
IN_SPACE = {"domain": "max: [0.4, 0.4, 0.4]", "gravity": "[0, 0, 0]", "centre": "[0.2, 0.2, 0.2]", "spin": "[1, 2, 2]"}
OMEGA = {"plane": (0, 0, 3), "space": (1, 2, 2)}

CORNER = """
schema_version: 1
title: Cut at the domain
domain: {{max: [0.4, 0.4, 0.4], spacing: 0.02}}
liquids:
  - {{name: water, density: 1000, shapes: [{{sphere: {{centre: [0, 0, 0.2], radius: 0.15, clip: true}}}}]}}
bodies:
  - {{name: buoy, kind: dynamic, density: 500, shape: {{cylinder: {{centre: [0.4, 0.4, 0.3], axis: [0, 0, 1], radius: 0.15, height: 0.15, clip: true}}}}}}
method: {{kind: {kind}}}
time: {{end: 50 ms}}
output: {{interval: 0}}
"""


def turn(frame):
    arm = frame["position"] - frame["position"].mean(0)
    return numpy.cross(arm, frame["velocity"]).sum(0)


def spin(context):
    cases = context.sample(itertools.product(("sph", "grid"), (("plane", IN_PLANE), ("space", IN_SPACE)), (0.001, 1, 1000), (1, 2, 3)), 3)
    at_start, kept = 0, 1
    for kind, (name, words), viscosity, ranks in cases:
        with scratch(context, "spin") as folder:
            scene = folder / "scene.yaml"
            scene.write_text(SPIN.format(kind=kind, viscosity=viscosity, spacing=0.01 if name == "plane" else 0.02, **words))
            run = run_scene(context, scene, folder / "run", ranks=ranks)
            first, last = run.frame(0), run.frame()
        centre = numpy.array([0.2, 0.2, 0.2 if name == "space" else 0])
        right = numpy.cross(OMEGA[name], first["position"] - centre)
        at_start = max(at_start, float(numpy.abs(first["velocity"] - right).max()))
        kept = min(kept, float(numpy.linalg.norm(turn(last)) / numpy.linalg.norm(turn(first))))
    return Figure(f"{len(cases)} runs: velocities at the start to {at_start:.1e} m/s, after 0.6 rad {kept:.4f} of the angular momentum",
                  at_start < 1e-9 and kept > 0.98)


def figures(context, program, name_filter):
    report = run_gtest(context, program, name_filter)
    return Figure(report.text(), report.ok)


def joined(context):
    return figures(context, "scene_joined_shapes_test", "JoinedShapes.*")


def clip(context):
    said = []
    for kind in ("sph", "grid"):
        with scratch(context, "clip") as folder:
            scene = folder / "scene.yaml"
            scene.write_text(CORNER.format(kind=kind))
            text = treacle(context, "check", scene, ranks=0).output
            run_scene(context, scene, folder / "run", ranks=2)
        said.append("75 % of its" in text and text.count("is cut at the domain (clip)") == 2)
    return Figure(f"said by {sum(said)} of 2 methods, both run", all(said))


def add_rows(table):
    table.row("spinning liquid", claim="a ball of liquid with `angular_velocity`, both methods, in 2D and 3D, 1e-3 to 1e3 Pa s, "
              "1 to 3 ranks", asked="w x r at the start; 0.98 of L after 0.6 rad")(spin)
    table.row("joined shapes", claim="pipes, hollow bodies, vessels with holes: distances against their formulas, volume and "
              "inertia, layers of the surface, flush faces, 2D and 3D", asked="1e-3 of the size; 5e-4 and 1e-3")(joined)
    table.row("clip", claim="a quarter of a ball of liquid and of a dynamic cylinder in corners, both methods",
              asked="runs; `check` says how much is cut")(clip)
    table.row("map coordinates", claim="a sphere of 10 m at (5e5, 5e6)", asked="refused with the cure")(
        lambda context: figures(context, "scene_mesh_parts_test", "MeshParts.MapCoordinates*"))
    table.row("overlapping parts", claim="volume, mass and distances of closed parts that overlap, with cavities, 2D and 3D",
              asked="those of the union")(
        lambda context: figures(context, "scene_mesh_parts_test", "MeshParts.ThatOverlap*:MeshParts.InThePlane*:MeshParts.Cavities*"))
    table.row("mesh defects", claim="duplicate triangles, inner walls, holes, parts turned inside out",
              asked="the reason by its name")(
        lambda context: figures(context, "scene_mesh_parts_test", "MeshParts.WhatIsWrong*"))
