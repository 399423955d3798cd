"""Rows of `grid` on volumes and on flows with known answers."""

import numpy

from . import grid_drag
from .gtest import gtest_on_ranks, run_gtest
from .run import run_scene, scratch
from .table import Figure

FRONT = 1.41124  # eta_N of Huppert 1982 in the plane
AREA, NU, GRAVITY = 0.01, 0.01, 9.81  # on one side [m2], [m2/s], [m/s2]

CURRENT = """
schema_version: 1
title: Syrup spreads under its weight
domain:
  dimensions: 2
  max: [0.7, 0.15]
  spacing: {spacing}
  boundaries: {{y_min: {{slip: no_slip}}, y_max: open, x_max: open}}
liquids:
  - name: syrup
    density: 1000
    viscosity: 10
    shapes: [{{box: {{min: [0, 0], max: [0.1, 0.1]}}}}]
method: {{kind: grid}}
measurements: [{{name: front, kind: front, axis: x}}]
time: {{end: {end}}}
output: {{interval: 0}}
"""


def fractions(context):
    report = run_gtest(context, "grid_geometry_test", "*FractionCase*")
    return Figure(report.text(), report.ok and report.ran >= 8)


def rest(context):
    return gtest_on_ranks(context, "grid_pressure_test", "Pressures.HoldLiquidAtRestOnATiltedSolid", at_least=1)


def rotation(context):
    report = run_gtest(context, "grid_viscosity_test", "GridViscosity.free_liquid_in_rigid_rotation_stays_as_it_is:"
                       "GridViscosity.step_keeps_linear_and_angular_momentum")
    spinning = run_gtest(context, "grid_step_test", "Steps.KeepTheAngularMomentumOfASpinningBall")
    return Figure(f"{report.text()}; spinning ball: {spinning.text()}",
                  report.ok and report.ran >= 2 and spinning.ok)


def flows(context):
    """The tests hold each to its bound."""
    names = ("couette_start_up_decays_by_nu_pi2_over_h2", "poiseuille_flow_is_right_with_walls_anywhere",
             "rotated_poiseuille_flow_converges_with_order_one_and_a_half")
    report = run_gtest(context, "grid_viscosity_test", ":".join(f"GridViscosity.{name}" for name in names))
    torque = run_gtest(context, "grid_viscosity_test",
                       "GridViscousBodies.torque_between_cylinders_is_that_of_taylor_and_couette")
    vortices = run_gtest(context, "grid_step_test", "Steps.DampATaylorGreenVortexAtItsRate")
    return Figure(f"{report.text()}; cylinders: {torque.text()}; vortices: {vortices.text()}",
                  report.ok and report.ran >= 3 and torque.ok and vortices.ok)


def gravity_current(context):
    spacing, end = (0.005, 8) if context.quick else (0.0025, 32)
    with scratch(context, "current") as folder:
        scene = folder / "scene.yaml"
        scene.write_text(CURRENT.format(spacing=spacing, end=end))
        front = run_scene(context, scene, folder / "run", ranks=2).measurements()
    time, place = front["time"], front["front"]
    late = time >= 2  # once it is flat
    exponent, logarithm = numpy.polyfit(numpy.log(time[late]), numpy.log(place[late]), 1)
    exact = FRONT * (GRAVITY * AREA**3 / (3 * NU)) ** 0.2
    prefactor = float(numpy.mean(place[late] / (exact * time[late] ** 0.2)))
    return Figure(f"dx {1e3 * spacing:g} mm, {time[late][0]:.1f} to {end} s: exponent {exponent:.4f}, "
                  f"prefactor {100 * (prefactor - 1):+.1f} %", bool(abs(exponent - 0.2) <= 0.01 and abs(prefactor - 1) <= 0.05))


def add_rows(table):
    table.row("fractions", claim="planes exact, a ball's volume second order, one volume for faces, edges and centres, "
              "a sheet of 0.8 cells kept", asked="1e-13; second order; 1e-13; kept")(fractions)
    table.row("rest", claim="liquid on a tilted solid, 32^3, stays at rest", asked="< 1e-10 m/s")(rest)
    table.row("rigid rotation", claim="free liquid that turns as a whole goes on, at any viscosity and any fractions",
              asked="A u = M u/dt to 1e-12; momentum of the viscous step 1e-10; a ball keeps >= 98 % over 100 steps")(rotation)
    table.row("flows", claim="Couette, Poiseuille, Taylor-Green, rotated Poiseuille, Taylor-Couette",
              asked="1 %, 1 %, 2 %, order >= 1.5 in L1, torque 5 % at a gap of 16 cells")(flows)
    table.row("periodic drag", claim="on a ball in a periodic box (Hasimoto 1959), torque on a ball that turns within another",
              asked="5 %")(grid_drag.periodic_drag)
    table.row("gravity current", claim="in the plane, Huppert 1982", asked="exponent 0.200 +- 0.01, prefactor +- 5 %")(gravity_current)
