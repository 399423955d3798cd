"""Table 5.1 and figure 5.7: a ball that sinks in syrup, coupled strongly, weakly and not at all."""

from claims_lib.grid_bodies import DENSITIES, GRAVITY, RADIUS, VISCOSITIES, fall, wall_corrected
from claims_lib.run import RunFolder

from .entries import entry

COUPLINGS = ("one_way", "weak", "strong")
# Errors of their velocities [%], as printed: against Stokes' velocity, which is that without walls and inertia. At 10 Pa s,
# Reynolds number 11, inertia counts: Schiller and Naumann's drag gives 0.695 m/s, so that their 0.64 is 8 % off, not 41 %.
PRINTED = {10: (51.3, 13.6, 41.1), 100: (1073.2, 375.0, 10.3), 1e3: (5173.4, 4018.5, 6.9), 1e4: (86403.3, 40085.9, 1.5),
           1e5: (616315.8, 396816.0, 2.3)}


def stokes(viscosity):
    """Terminal velocity without walls [m/s]."""
    return 2 / 9 * (DENSITIES[1] - DENSITIES[0]) / viscosity * GRAVITY * RADIUS**2


def cells(context):
    """Of the grid, a radius of the ball."""
    return context.pick(10, 3, 2)


def fall_by(context, results, folder, viscosity, coupling):
    """As in the dissertation: in the box, pressure and viscosity one after the other where the coupling is weak or none."""
    return fall(context, folder, viscosity, cells(context), coupling=coupling, ranks=results.ranks,
                solve="together" if coupling == "strong" else "split")


@entry("table-5.1", "Velocities of a sinking ball by the coupling, against Stokes' velocity corrected for the walls", quick=480)
def table_5_1(context, results):
    rows = []
    for viscosity in context.pick(VISCOSITIES, VISCOSITIES, VISCOSITIES[2:3]):
        right = wall_corrected(viscosity, tube=False)
        found = [fall_by(context, results, context.scratch, viscosity, coupling) for coupling in COUPLINGS]
        reynolds = 2 * DENSITIES[0] * right * RADIUS / viscosity
        rows.append([viscosity, reynolds, stokes(viscosity), right, *found, *(100 * abs(one / right - 1) for one in found),
                     *PRINTED[viscosity]])
    results.table("table_5.1", ["viscosity [Pa s]", "Re", "Stokes [m/s]", "with walls [m/s]",
                                *(f"{name} [m/s]" for name in COUPLINGS), *(f"{name} error [%]" for name in COUPLINGS),
                                *(f"{name} error, dissertation [%]" for name in COUPLINGS)], rows)
    with results.figure("table_5.1") as axes:
        for k, name in enumerate(COUPLINGS):
            line, = axes.loglog([row[0] for row in rows], [row[7 + k] for row in rows], "o-", label=f"{name}, Treacle")
            axes.loglog([row[0] for row in rows], [row[10 + k] for row in rows], "s--", color=line.get_color(), mfc="none",
                        label=f"{name}, dissertation")
        axes.set(xlabel="viscosity [Pa s]", ylabel="error of the velocity [%]")
        axes.legend(fontsize=8)


@entry("figure-5.7", "Velocity of a ball that sinks in 1000 Pa s, by the coupling", quick=120)
def figure_5_7(context, results):
    viscosity, rows = 1e3, []
    with results.figure("figure_5.7") as axes:
        for coupling in COUPLINGS:
            folder = context.scratch / coupling
            fall_by(context, results, folder, viscosity, coupling)
            bodies = RunFolder(next(folder.glob("*/bodies.csv")).parent).bodies()
            velocities = bodies["ball velocity z"]
            rows += [[coupling, float(time), float(v)] for time, v in zip(bodies["time"], velocities)]
            axes.plot(bodies["time"], velocities, label=coupling)
        axes.axhline(-stokes(viscosity), color="black", ls=":", label="Stokes, without walls")
        axes.axhline(-wall_corrected(viscosity, tube=False), color="black", ls="--", label="with walls")
        axes.set(xlabel="time [s]", ylabel="velocity of the ball [m/s]")
        axes.legend(fontsize=8)
    results.curves("figure_5.7", ["coupling", "time [s]", "velocity [m/s]"], rows)
