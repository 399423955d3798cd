"""Rows of `grid` on inlets, outlets and viscosities by shear rate."""

import numpy

from .gtest import gtest_on_ranks
from .run import run_scene, scratch
from .table import Figure

DENSITY, PULL = 1000.0, 0.2  # [kg/m3], [m/s2] along the wall

FILM = """
schema_version: 1
title: A film of a liquid that thins runs down a wall
domain:
  dimensions: 2
  max: [0.32, 1.28]
  spacing: 4 cm
  gravity: [{pull}, 0]
  boundaries: {{x_min: {{kind: periodic}}, x_max: {{kind: periodic}}, y_min: {{slip: no_slip}}, y_max: open}}
liquids:
  - name: paste
    density: {density}
    viscosity: {consistency}
    rheology: {rheology}
    shapes: [{{box: {{min: [0, 0], max: [0.32, 1]}}}}]
method: {{kind: grid}}
time: {{end: {end}, rule: fixed, step: 20 ms}}
output: {{interval: {end}}}
"""


def film(context, folder, consistency, rheology, end=1.2):
    folder.mkdir()
    scene = folder / "scene.yaml"
    scene.write_text(FILM.format(pull=PULL, density=DENSITY, consistency=consistency, rheology=rheology, end=end))
    frame = run_scene(context, scene, folder / "run", ranks=2).frame()
    return frame["position"][:, 1], frame["velocity"][:, 0]


def off(u, exact):
    return float(numpy.abs(u - exact).max() / exact.max())


def thinning(context):
    """Films 25 cells high."""
    parts, ok = [], True
    with scratch(context, "grid_thinning") as folder:
        for exponent, consistency in ((0.5, 1000), (1.5, 1e4)):
            y, u = film(context, folder / f"{exponent:g}", consistency,
                        f"{{law: power_law, exponent: {exponent}, least_shear_rate: 1e-5}}")
            power = 1 + 1 / exponent
            exact = (DENSITY * PULL / consistency) ** (1 / exponent) / power * (1 - (1 - numpy.minimum(y, 1)) ** power)
            parts.append(f"n = {exponent:g}: {100 * off(u, exact):.2f} %")
            ok = ok and off(u, exact) <= 0.02
        y, u = film(context, folder / "bingham", 2e3, "{law: herschel_bulkley, yield_stress: 100, regularisation_time: 2000}")
        below = numpy.minimum(y, 0.5)
        error = off(u, DENSITY * PULL / 2e3 * (0.5 * below - below**2 / 2))
        parts.append(f"Bingham {100 * error:.2f} %")
    return Figure(", ".join(parts), ok and error <= 0.03)


def inlets(context):
    return gtest_on_ranks(context, "grid_step_test", "Inlet.*", at_least=4)


def add_rows(table):
    table.row("shear rate", claim="steady films of power-law liquids and of a Bingham fluid", asked="± 2 %, ± 3 %")(thinning)
    table.row("inlets", claim="volume by time, no gap behind an opening, a rope held, ranks 1 to 4",
              asked="half a layer; uniform; 1e-6 m")(inlets)
