"""Rows of `grid` on bodies in the liquid, on ranks and on restarts."""

import numpy

from .gtest import gtest_on_ranks
from .run import resume, run_scene, scratch
from .table import Figure

RADIUS, WIDTH, DENSITIES, GRAVITY = 0.1, 0.64, (1000.0, 3000.0), 9.81  # inputs/falling_ball/tube.yaml
BOX = {"bodies.tube.shape.cylinder.radius": 1}  # the tube outside of its box
STEP, STEPS, LONGEST = 0.02, 3, 0.5  # [s], [1], [s]: steps of 2 to 250 relaxation times from 1e3 Pa s on
FINE = 1e4                           # [Pa s]: at 12 cells a radius; where inertia counts for nothing others are the same
VISCOSITIES = (10, 100, 1e3, 1e4, 1e5)  # of table 5.1 [Pa s]
PRINTED = {10: (0.641, "41 % off, at Re 11"), 100: (0.098, "10 %"), 1e3: (0.0101, "7 %"), 1e4: (1.11e-3, "1.5 %"),
           1e5: (1.12e-4, "2.3 %")}  # of a ball of 5 cm, strong coupling [m/s]
TIGHT = {"method.grid.pressure.residual": 1e-11, "method.grid.viscosity.residual": 1e-11, "method.grid.stokes.residual": 1e-11,
         "output.double_precision": "true"}


def momentum(context):
    """On 1, 2, 3 and 4 ranks; the tests hold the sums to 1e-10."""
    parts = [gtest_on_ranks(context, "grid_viscosity_test", "GridViscousBodies.momentum_of_liquid_and_bodies_is_kept", at_least=1),
             gtest_on_ranks(context, "grid_pressure_test", "BodiesInLiquid.ChangeNoMomentumTogether", at_least=1),
             gtest_on_ranks(context, "grid_step_test", "StepsWithSolids.KeepTheMomentumOfLiquidAndBody", at_least=1)]
    return Figure("viscosity " + parts[0].measured + "; pressure " + parts[1].measured + "; step " + parts[2].measured,
                  all(part.ok for part in parts))


def in_tube(width_ratio):
    """Stokes' velocity over that in a tube of this ratio of the ball's diameter to its own (Haberman & Sayre 1958)."""
    x = width_ratio
    return (1 - 0.75857 * x**5) / (1 - 2.1050 * x + 2.0865 * x**3 - 1.7068 * x**5 + 0.72603 * x**6)


def wall_corrected(viscosity, tube):
    """Terminal velocity in the tube, or between four walls: in the tube that slows a small ball as much (Happel & Bart)."""
    stokes = 2 / 9 * (DENSITIES[1] - DENSITIES[0]) / viscosity * GRAVITY * RADIUS**2
    return stokes / in_tube((1 if tube else 1.9033 / 2.1050) * 2 * RADIUS / WIDTH)


def fall(context, folder, viscosity, cells, *, tube=False, coupling="strong", solve="together", ranks=2):
    """Velocity of the ball after its start, or the fastest one where the coupling lets it reach the floor [m/s], with steps
    that its velocity at the end requires, not its start. In the box of the tube, since that of scene.yaml is so short that its
    surface lets the ball sink 7 % faster."""
    relaxation = 2 / 9 * (DENSITIES[1] + DENSITIES[0] / 2) * RADIUS**2 / viscosity
    end = min(max(15 * relaxation, STEPS * STEP), LONGEST)
    run = run_scene(context, context.root / "inputs/falling_ball/tube.yaml",
                    folder / f"{viscosity:g}_{cells}_{'tube' if tube else 'box'}_{coupling}",
                    set={"liquids.syrup.viscosity": viscosity, "domain.spacing": RADIUS / cells, "time.step": STEP,
                         "time.end": end, "output.interval": 0, "method.grid.coupling": coupling,
                         "method.grid.stokes.solve": solve, **({} if tube else BOX)}, ranks=ranks, timeout=4 * 3600)
    down = -run.bodies()["ball velocity z"]
    return float(down[-1] if coupling == "strong" else down.max())


def falling_ball(context):
    """Below Re = 1 against the wall-corrected value; at 10 Pa s printed alone, since inertia counts there, and weak coupling
    is near enough: 14 % off in table 5.1, 375 % and more at higher viscosities."""
    parts, ok = [], True
    with scratch(context, "falling_ball") as folder:
        for viscosity in VISCOSITIES[1:3] if context.quick else VISCOSITIES:
            sizes = (6, 12) if viscosity == FINE else (6,)
            words = []
            for tube in (False, True):
                right = wall_corrected(viscosity, tube)
                found = [fall(context, folder, viscosity, cells, tube=tube) for cells in sizes]
                if viscosity > 10:
                    ok = ok and all(abs(v / right - 1) <= most for v, most in zip(found, (0.06, 0.03)))
                words.append(("tube " if tube else "box ") + ", ".join(f"{v:.3g}" for v in found) + f" m/s, of {right:.3g} "
                             + ", ".join(f"{100 * (v / right - 1):+.1f} %" for v in found))
            # As in table 5.1: two ways by pressure and viscosity one after the other, weak or none.
            weak = [fall(context, folder, viscosity, sizes[0], coupling=coupling, solve="split") for coupling in ("weak", "one_way")]
            ok = ok and (viscosity <= 10 or all(v > 1.5 * right for v in weak))
            parts.append(f"{viscosity:g} Pa s: " + "; ".join(words) + f"; weak {weak[0]:.3g}, one-way {weak[1]:.3g}; "
                         f"the dissertation {PRINTED[viscosity][0]:g} in its box")
    return Figure(f"6 cells a radius, and 12 at {FINE:g} Pa s: " + "; ".join(parts), ok)


def coupling_time(context):
    """Seconds of the solves of the same steps; in three pairs of runs, since other programs weigh on single ones."""
    pairs = []
    with scratch(context, "coupling") as folder:
        for pair in range(3):
            seconds = {}
            for coupling in ("strong", "one_way"):
                run = run_scene(context, context.root / "inputs/falling_ball/scene.yaml", folder / f"{coupling}_{pair}",
                                set={"time.end": 0.2, "output.interval": 0, "method.grid.coupling": coupling})
                steps = run.steps()
                seconds[coupling] = float((steps["pressure"] + steps["viscosity"])[1:].mean())
            pairs.append((seconds["strong"] / seconds["one_way"], seconds["strong"], seconds["one_way"]))
    ratio, strong, one_way = sorted(pairs)[1]
    return Figure(f"{strong:.3f} s and {one_way:.3f} s a step, {ratio:.2f} times; of three pairs the median, "
                  + ", ".join(f"{pair[0]:.2f}" for pair in pairs), ratio <= 1.1)


def dipped(context, folder, name, ranks, **more):
    """The honey dipper, coarse, while it turns and begins to rise."""
    return run_scene(context, context.root / "inputs/honey_dipper/scene.yaml", folder / name, ranks=ranks,
                     set={"domain.spacing": 0.01, "time.end": 0.5, "output.interval": 0.5, **TIGHT, **more})


def apart(one, other):
    """Largest distance of a particle in two frames [m]; none may be missing."""
    if not numpy.array_equal(one["id"], other["id"]):
        return numpy.inf
    return float(numpy.abs(one["position"] - other["position"]).max())


def ranks_agree(context):
    with scratch(context, "ranks") as folder:
        frames = [dipped(context, folder, str(ranks), ranks).frame(-1) for ranks in (1, 2, 3, 4)]
    found = [apart(frames[0], frame) for frame in frames[1:]]
    return Figure("honey dipper, dx 10 mm, 0.5 s, residuals 1e-11: 2, 3, 4 ranks differ by "
                  + ", ".join(f"{one:.1e}" for one in found) + " m", max(found) < 1e-6)


def restart(context):
    with scratch(context, "restart") as folder:
        straight = dipped(context, folder, "straight", 2).frame(-1)
        found = []
        for ranks in (2, 3):
            run = dipped(context, folder, f"on_{ranks}", 2, **{"output.checkpoint_interval": 0.2})
            sorted((run.folder / "checkpoints").glob("*.h5"))[-1].unlink()  # that of the end
            for frame in (run.folder / "frames").iterdir():
                frame.unlink()
            found.append(apart(straight, resume(context, run.folder, ranks=ranks).frame(-1)))
    return Figure(f"from 0.4 s on 2 ranks {found[0]:.1e} m, on 3 ranks {found[1]:.1e} m", found[0] < 1e-12 and found[1] < 1e-6)


def add_rows(table):
    table.row("momentum", claim="linear and angular momentum of liquid and bodies together stay", asked="1e-10")(momentum)
    table.row("falling ball", claim="table 5.1's viscosities, against Stokes' velocity corrected for the walls",
              asked="strong within 6 % at 6 cells a radius, 3 % at 12, in the box and in a tube; one-way and weak fail")(falling_ball)
    table.row("strong coupling", claim="time of the solves beside that of one-way coupling", asked="<= 1.1 times")(coupling_time)
    table.row("ranks", claim="1, 2, 3, 4 ranks, bodies that cross their borders", asked="the same to solver tolerance")(ranks_agree)
    table.row("restart", claim="with bodies, on another number of ranks too", asked="equal to the straight run")(restart)
