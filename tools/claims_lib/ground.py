"""Rows of `ground`: hybrid incompressible SPH from a scene file to a picture, on any number of ranks."""

import numpy

from . import dam_breaks
from .gtest import run_gtest
from .run import run_scene, scratch
from .table import CommandFailed, Figure, Table

TABLE = Table("ground")
INPUTS = "inputs"


def scene(context, name):
    return context.root / INPUTS / name / "scene.yaml"


@TABLE.row("golden numbers", claim="kernel sums on a lattice and at a single-layer wall are the reference's",
           asked="4 digits")
def golden_numbers(context):
    names = ["Lattice.*", "PlanarWall.*", "Densities.OfASquareLatticeAtAWallAreTheGoldenNumbers",
             "SolidTerms.TwoParticlesOnASolidHaveTheirClosedFormPressures"]
    report = run_gtest(context, "sph_formulas_test", ":".join(names))
    return Figure(f"{report.text()}: 9 lattices, 5 gaps to a wall in space, 4 in the plane; half of the last "
                  "digit given, but for the wall term alpha of the reference, within 0.002", report.ok)


COLUMN_WIDTH, SPACING = 0.24, 0.02  # of the hydrostatic column [m]
DENSITY, GRAVITY = 1000.0, 9.81
SETTLED = 0.5  # [s]


def pressure_slope(frame):
    """Of the pressure over the depth in the bulk, in rho g."""
    x, p = frame["position"], frame["pressure"]
    top = x[:, 1].max()
    bulk = ((x[:, 0] > 3 * SPACING) & (x[:, 0] < COLUMN_WIDTH - 3 * SPACING) & (x[:, 1] > 0.2 * top)
            & (x[:, 1] < 0.8 * top))
    if bulk.sum() < 50:
        raise CommandFailed(f"only {bulk.sum()} particles in the bulk of the column")
    return -numpy.polyfit(x[bulk, 1], p[bulk], 1)[0] / (DENSITY * GRAVITY)


@TABLE.row("hydrostatic column", claim="water at rest has the pressure of its depth, its weight on the floor, no motion",
           asked="bulk slope 1 ± 0.03, wall force = weight ± 1 %, maximum speed < 0.05 m/s after 0.5 s")
def hydrostatic_column(context):
    with scratch(context, "column") as folder:
        run = run_scene(context, scene(context, "hydrostatic_column"), folder / "run",
                        set={"time.end": 1, "output.interval": 0.02})
        frames = [number for number, (time, _) in enumerate(run.frames()) if time > SETTLED]
        slope = float(numpy.mean([pressure_slope(run.frame(number)) for number in frames]))
        steps, bodies = run.steps(), run.bodies()
        late = bodies["time"] > SETTLED
        sides = [name for name in bodies.names() if name.endswith("pressure force y")]
        force = -sum(float(bodies[name][late].mean()) for name in sides) / (steps["mass"][-1] * GRAVITY)
        speed = float(steps["max speed"][steps["time"] > SETTLED].max())
    ok = abs(slope - 1) <= 0.03 and abs(force - 1) <= 0.01 and speed < 0.05
    return Figure(f"slope {slope:.4f} (mean of {len(frames)} frames), force {force:.4f} weights, "
                  f"at most {speed:.4f} m/s", ok)


@TABLE.row("Martin & Moyce", claim="front and residual height of the column of Martin and Moyce (V3, V3b)",
           asked="front ± 8 % after a shift of T of at most 0.15, up to T = 4.03; height ± 6 %")
def martin_moyce(context):
    width = dam_breaks.MARTIN_MOYCE_WIDTH
    with scratch(context, "martin_moyce") as folder:
        run = run_scene(context, scene(context, "martin_moyce"), folder / "run",
                        set={"time.end": 0.405, "output.interval": 0})
        values = run.measurements()
        time, front, height = values["time"], values["front"] / width, values["height"] / (2 * width)
    clock = dam_breaks.front_times(time, width)
    shift, ahead = dam_breaks.best_shift(dam_breaks.MARTIN_MOYCE_FRONT, clock, front, 0.15, until=4.04)
    later = dam_breaks.deviations(dam_breaks.MARTIN_MOYCE_FRONT, clock, front, shift=shift)[len(ahead):]
    higher = dam_breaks.deviations(dam_breaks.MARTIN_MOYCE_HEIGHT, dam_breaks.height_times(time, width), height)
    last = numpy.array(dam_breaks.MARTIN_MOYCE_HEIGHT.values) * higher
    ok = dam_breaks.worst(ahead) <= 0.08 and dam_breaks.worst(higher) <= 0.06
    return Figure(f"front {dam_breaks.span(ahead)} at shift {shift:+.2f} ({len(ahead)} points; later ones "
                  f"{dam_breaks.span(later)}); height {dam_breaks.span(higher)} ({len(higher)} points, no shift; "
                  f"of the first height {dam_breaks.span(last)})", ok)


@TABLE.row("Koshizuka & Oka", claim="front of the column of Koshizuka and Oka (V3c)", asked="± 6 %")
def koshizuka_oka(context):
    width = dam_breaks.KOSHIZUKA_OKA_WIDTH
    with scratch(context, "koshizuka_oka") as folder:
        run = run_scene(context, scene(context, "koshizuka_oka"), folder / "run",
                        set={"time.end": 0.3, "output.interval": 0})
        values = run.measurements()
        clock, front = dam_breaks.front_times(values["time"], width), values["front"] / width
    plain = dam_breaks.deviations(dam_breaks.KOSHIZUKA_OKA_FRONT, clock, front)
    shift, shifted = dam_breaks.best_shift(dam_breaks.KOSHIZUKA_OKA_FRONT, clock, front, 0.05)
    ok = dam_breaks.worst(shifted) <= 0.06
    return Figure(f"{dam_breaks.span(shifted)} at shift {shift:+.2f} ({len(plain)} points; without a shift "
                  f"{dam_breaks.span(plain)})", ok)
