"""Rows of `seeing` on surfaces from particles."""

import contextlib
import os
import re

from . import library_surface
from .gtest import run_gtest
from .run import run_scene, scratch, treacle
from .table import Figure

BLOCK = """
schema_version: 1
title: A block of water collapses
domain:
  min: [0, 0, 0]
  max: [2, 1, 2]
  spacing: {spacing}
liquids:
  - name: water
    density: 1000
    viscosity: 1 mPa.s
    shapes: [{{box: {{min: [0, 0, 0], max: [1, 1, 1]}}}}]
time: {{end: {end}}}
output: {{interval: {end}, checkpoint_interval: 0}}
"""
FRAME = 1 / 30  # s


@contextlib.contextmanager
def with_environment(**values):
    """Variables of the environment, which are taken back afterwards."""
    before = {key: os.environ.get(key) for key in values}
    os.environ.update({key: str(value) for key, value in values.items()})
    try:
        yield
    finally:
        for key, value in before.items():
            if value is None:
                del os.environ[key]
            else:
                os.environ[key] = value


def figures(context, name_filter, **environment):
    if context.quick:
        environment["TREACLE_QUICK"] = 1
    with with_environment(**environment):
        report = run_gtest(context, "surface_test", name_filter, ranks=1)
    return report


def balls(context):
    report = figures(context, "SurfaceFigures.DISABLED_BallsFrom3To20")
    return Figure(report.text(), report.ok)


def layers(context):
    report = figures(context, "Surface.OfABlockLiesOnFloorAndWalls:Surface.OfALayerAtRestIsFlat:Surface.LiesOnSolids*")
    off = [float(report.properties[key]) for key in ("block_off_spacings", "layer_off_spacings")]
    mean = abs(float(report.properties["disordered_layer_mean_height_off"]))
    return Figure(report.text(), report.ok and report.ran == 3 and max(off + [mean]) <= 0.1)


def sheets(context):
    report = figures(context, "SurfaceFigures.DISABLED_SheetsAndThreads")
    return Figure(report.text(), report.ok)


def ranks(context):
    reports = {n: run_gtest(context, "surface_test", "Surface.DoesNotDependOnTheRanks", ranks=n) for n in (1, 2, 3, 4, 8)}
    return Figure("; ".join(f"{n} ranks: {report.text()}" for n, report in reports.items()),
                  all(report.ok for report in reports.values()))


def cost(context):
    """Surface and silhouette at 1280 x 720 against the steps of 1/30 s, one rank."""
    texts, ok = [], True
    for edge in (24,) if context.quick else (64, 100):
        report = figures(context, "SurfaceFigures.DISABLED_Cost", TREACLE_EDGE=edge)
        seen = sum(float(report.properties[key]) for key in ("surface_seconds", "silhouette_seconds"))
        with scratch(context, "cost") as folder:
            scene = folder / "scene.yaml"
            scene.write_text(BLOCK.format(spacing=1 / edge, end=FRAME if edge < 100 else FRAME / 4))
            steps = run_scene(context, scene, folder / "run", ranks=1).steps()
        phases = [title.split("[")[0].strip() for title in steps.header if title.endswith("[s]")]
        seconds = sum(steps[name].sum() for name in phases if name not in ("time", "dt"))
        seconds *= FRAME / steps["time"][-1]
        texts.append(f"{edge}^3: surface {report.properties['surface_seconds']} s (processor {report.properties['surface_processor_seconds']} s), silhouette {report.properties['silhouette_seconds']} s, "
                     f"steps of a frame {seconds:.2f} s, share {seen / seconds:.3f}")
        ok = ok and report.ok and seen <= seconds / 3
    return Figure("; ".join(texts), ok)


def iso_shift(context):
    report = figures(context, "SurfaceFigures.DISABLED_IsoShift")
    return Figure("for the surface 0.1 spacings " + "; ".join(
        f"{way}: container of 50 x 75 {float(report.properties['container_percent_' + way]):+.2f} %, heap of radius 12 {float(report.properties['heap_percent_' + way]):+.2f} %"
        for way in ("outwards", "inwards")), report.ok)


def export(context):
    """The command: the same surface on 1 and 3 ranks, closed, in every format."""
    with scratch(context, "export") as folder:
        scene = folder / "scene.yaml"
        scene.write_text(BLOCK.format(spacing=1 / 12, end=0.05))
        run = folder / "run"
        run_scene(context, scene, run, ranks=2)
        lines = []
        for ranks_used, form in ((1, "ply"), (3, "ply"), (2, "vtp"), (2, "obj")):
            done = treacle(context, "export", run, "--to", "surface", "--format", form, "--out", folder / f"{form}{ranks_used}",
                           ranks=ranks_used)
            lines.append(re.findall(r"vertices (\d+), triangles (\d+), volume (\S+)", done.output))
    same = all(line == lines[0] for line in lines)
    return Figure(f"{lines[0]}, the same in 4 exports: {same}", same and bool(lines[0]))


BALLS = """
schema_version: 1
title: Balls of water at rest
domain:
  min: [-60, -60, -60]
  max: [60, 60, 60]
  spacing: 1
  gravity: [0, 0, 0]
liquids:
  - name: water
    density: 1000
    viscosity: 1
    shapes: [{{sphere: {{centre: [0.21, 0.13, 0.37], radius: {radius}}}}}]
time: {{end: 1 ms, step: 0.1 ms}}
output: {{interval: 0.1 ms, checkpoint_interval: 0}}
"""
FRAMES = 10  # of a sequence, past the first


def exported(context, run, frames):
    """What `export --to surface` prints and the seconds that it takes, files and start with it."""
    with scratch(context, "mesh") as folder:
        return treacle(context, "export", run, "--to", "surface", "--frames", frames, "--check", "--out", folder / "mesh", ranks=1)


def library(context):
    """A frame of a sequence, its files too, against the library's splat and marching cubes alone; one core each."""
    texts, ok = [], True
    for radius in (3, 6) if context.quick else (3, 6, 12, 24):
        with scratch(context, "library") as folder:
            scene = folder / "scene.yaml"
            scene.write_text(BALLS.format(radius=radius))
            run = run_scene(context, scene, folder / "run", ranks=1)
            points = run.frame(0)["position"]
            first, all_frames = exported(context, run.folder, "0"), exported(context, run.folder, f"0:{FRAMES}")
        theirs = [library_surface.make(points, 1.0) for _ in range(3)]
        seconds, their_seconds = (all_frames.seconds - first.seconds) / FRAMES, min(one.seconds for one in theirs)
        volume = float(re.search(r"volume ([-+.\de]+)", first.output)[1])
        errors = [abs(one / len(points) - 1) for one in (volume, theirs[0].volume)]
        texts.append(f"{len(points)} particles: volume error {100 * errors[0]:.2f} % in {seconds:.3f} s, library's "
                     f"{100 * errors[1]:.2f} % in {their_seconds:.3f} s")
        ok = ok and errors[0] <= errors[1] and (radius < 12 or seconds <= 2 * their_seconds)
    return Figure("; ".join(texts), ok)


def add_rows(table):
    table.row("surface of balls", claim="a ball, and two that touch, 3 to 20 particles a radius, turned and off the lattice",
              asked="volume within 1 %, centre within 0.02 spacings, every edge twice")(balls)
    table.row("surface at rest", claim="flat layer; block on a floor between walls; liquid around a solid",
              asked="within 0.1 spacings, no gap")(layers)
    table.row("sheets and threads", claim="a sheet one particle thick, a thread of two, turned",
              asked="one surface, volume within 10 %")(sheets)
    table.row("iso shift", claim="area of liquid in the plane when the surface is taken 0.1 spacings farther out or in",
              asked="printed; 0.1 spacings of the free surface's length")(iso_shift)
    table.row("surface by ranks", claim="the mesh on 1, 2, 3, 4 and 8 ranks, with walls, a period and a solid",
              asked="the same triangles, vertices to 1e-12")(ranks)
    table.row("surface export", claim="export --to surface: ply, vtp, obj on 1 to 3 ranks", asked="the same figures")(export)
    table.row("surface against a library", claim="a frame of a ball of 3 to 24 particles a radius, files too; VTK's SPH splat on the same grid and its flying edges",
              asked="volume error not larger; from 12 on, time within 2 times")(library)
    table.row("cost of surface and silhouette", claim="at 64^3 and at 1 M particles, one rank",
              asked="together <= 1/3 of the steps of 1/30 s")(cost)
