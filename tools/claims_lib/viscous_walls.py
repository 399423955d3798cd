"""Rows of `viscosity` on walls and bodies."""

import numpy

from .gtest import gtest_on_ranks, run_gtest
from .run import run_scene, scratch
from .table import Figure

RANKS = 2
DENSITY, SPACING = 1000.0, 0.02


def start_up(y, time, viscosity, height, pull):
    """A film of that height on a wall at y = 0, pulled along it from rest (White, Viscous Fluid Flow, 3-4)."""
    steady = pull / (2 * viscosity) * y * (2 * height - y)
    odd = 2 * numpy.arange(200)[:, None] + 1
    decay = numpy.exp(-(odd * numpy.pi / (2 * height)) ** 2 * viscosity * time)
    waves = 16 * pull * height ** 2 / (viscosity * (numpy.pi * odd) ** 3) * numpy.sin(odd * numpy.pi * y / (2 * height))
    return steady - (waves * decay).sum(axis=0)


def flow(context, folder, **settings):
    """Heights and velocities at the end of a run of inputs/viscous_film; keys with __ for dots."""
    values = {key.replace("__", "."): value for key, value in settings.items()}
    values["output.interval"] = values["time.end"]
    run = run_scene(context, context.root / "inputs" / "viscous_film" / "scene.yaml", folder, ranks=RANKS, set=values)
    frame = run.frame()
    return frame["position"][:, 1], frame["velocity"][:, 0]


def off(velocity, exact):
    return float(numpy.abs(velocity - exact).max() / exact.max())


def couette(context):
    report = run_gtest(context, "sph_ranks_test", "ViscousWalls.CouetteFlowStartsUpAsItShould", ranks=RANKS)
    error = float(report.properties.get("couette_error", "inf"))
    return Figure(f"{100 * error:.2f} % of the plate's velocity at nu t/H^2 = 0.05, 0.2 and 1", report.ok and error <= 0.02)


def poiseuille(context):
    """Early; and steady, when the middle has slid by many spacings past the walls."""
    parts, ok = [], True
    with scratch(context, "channel") as folder:
        for pull, end in ((0.2, 0.5), (1.0, 3.0)):
            y, u = flow(context, folder / f"{end:g}", time__end=end, domain__max="[0.2, 1.0]",
                        domain__boundaries__y_max__kind="wall", domain__boundaries__y_max__slip="no_slip",
                        domain__gravity=f"[{pull}, 0]")
            error = off(u, start_up(numpy.minimum(y, 1 - y), end, 0.2, 0.5, pull))
            slid = u.max() * end / SPACING
            parts.append(f"{100 * error:.2f} % at {end:g} s (slid by up to {slid:.0f} spacings)")
            ok = ok and error <= 0.02
    return Figure(", ".join(parts), ok)


def film(context):
    parts, ok = [], True
    with scratch(context, "film") as folder:
        for number, viscosity, step, end in ((0.1, 0.02, 2e-3, 1.0), (10, 0.2, 2e-2, 2.0), (1000, 20, 2e-2, 0.4)):
            y, u = flow(context, folder / f"{number:g}", liquids__0__viscosity=DENSITY * viscosity, time__step=step, time__end=end,
                        method__viscosity__integration="implicit")  # `automatic` would be explicit at 0.1
            error = off(u, start_up(y, end, viscosity, 1.0, 0.2))
            parts.append(f"{number:g}: {100 * error:.2f} %")
            ok = ok and error <= 0.03
    return Figure("nu dt/d^2 = " + ", ".join(parts), ok)


def slip(context):
    parts, ok = [], True
    with scratch(context, "slip") as folder:
        for ratio in (0, 0.5, 1, 2, 5):
            wall = {"domain__boundaries__y_min__slip": "slip_length",
                    "domain__boundaries__y_min__slip_length": ratio * SPACING} if ratio else {}
            y, u = flow(context, folder / f"{ratio:g}", liquids__0__viscosity=2e4, time__end=0.4, **wall)
            error = off(u, 0.2 / 20 * (y - y ** 2 / 2 + ratio * SPACING))
            parts.append(f"{ratio:g}: {100 * error:.2f} %")
            ok = ok and error <= 0.02
        y, u = flow(context, folder / "free", liquids__0__viscosity=2e4, time__end=0.4,
                    domain__boundaries__y_min__slip="free_slip")
        error = off(u, numpy.full_like(y, 0.2 * 0.4))
        ok = ok and error <= 1e-4  # the step's 20 ms are no multiple of it
    return Figure("b/d = " + ", ".join(parts) + f"; free slip {100 * error:.4f} %", ok)


def thinning(context):
    parts, ok = [], True
    with scratch(context, "thinning") as folder:
        for exponent, consistency in ((0.5, 2000), (1.5, 1e5)):
            y, u = flow(context, folder / f"{exponent:g}", time__end=0.4, liquids__0__viscosity=consistency,
                        liquids__0__rheology__law="power_law", liquids__0__rheology__exponent=exponent,
                        liquids__0__rheology__min_shear_rate=1e-5)
            power = 1 + 1 / exponent
            exact = (DENSITY * 0.2 / consistency) ** (1 / exponent) / power * (1 - (1 - y) ** power)
            parts.append(f"n = {exponent:g}: {100 * off(u, exact):.2f} %")
            ok = ok and off(u, exact) <= 0.02
        y, u = flow(context, folder / "bingham", time__end=0.4, liquids__0__viscosity=2e4,
                    liquids__0__rheology__law="herschel_bulkley", liquids__0__rheology__yield_stress=100,
                    liquids__0__rheology__regularisation_time=20000)
        below = numpy.minimum(y, 0.5)
        error = off(u, DENSITY * 0.2 / 2e4 * (0.5 * below - below ** 2 / 2))
        parts.append(f"Bingham {100 * error:.2f} %")
    return Figure(", ".join(parts), ok and error <= 0.03)


def bodies(context):
    return gtest_on_ranks(context, "sph_ranks_test", "ViscousBodies.*", at_least=6)


def add_rows(table):
    table.row("Couette", claim="start-up between plates, one of which moves, 16 spacings apart", asked="± 2 %")(couette)
    table.row("Poiseuille", claim="start-up of a channel 50 spacings wide, and steady", asked="± 2 %")(poiseuille)
    table.row("gravity film", claim="start-up of a film 50 spacings high at nu dt/d^2 = 0.1, 10, 1000", asked="± 3 %")(film)
    table.row("slip", claim="steady film on a wall with a slip length of 0, 0.5, 1, 2, 5 spacings, and without friction",
              asked="± 2 %")(slip)
    table.row("shear rate", claim="steady films of power-law liquids and of a Bingham fluid", asked="± 2 %, ± 3 %")(thinning)
    table.row("bodies", claim="a disc in a stiff liquid (nu dt/d^2 = 1e4), as light as 0.001: momentum of both, energy, "
              "rotation of both together, ranks 1 to 4", asked="1e-12, less than before, 1e-10")(bodies)
