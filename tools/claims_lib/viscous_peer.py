"""Rows of `viscosity` that compare with SPlisHSPlasH: --peer splishsplash=PATH of its SPHSimulator."""

import dataclasses
import functools

from . import peer, viscous_solve
from .run import scratch
from .table import CommandFailed, Figure, TimedOut

VISCOSITY = 1000.0
RESIDUAL = 1e-6     # of both, relative to the velocities
STEPS = 20
CASES = ((37, 1e-3), (37, 4e-3), (58, 1e-3), (58, 4e-3))  # particles an edge, step [s]
QUICK_CASE = (20, 4e-3)
METHODS = {"Weiler et al. 2018": 6, "Takahashi et al. 2015 (improved)": 5}  # its numbers
# Its Takahashi 2015 may not converge at all in its 100000 iterations, which are half an hour a step: it is stopped then, and
# what it had left for the solve is the least that it takes.
PATIENCE = 400  # [s] a run
WANTED = {"Takahashi et al. 2015 (improved)": 10, "Weiler et al. 2018": 1}


def scene_of_peer(cube, method, box):
    """The cube on the floor of a box of twice its width; y is up."""
    d, a = cube.spacing, viscous_solve.EDGE
    solve = {"viscosity": VISCOSITY / viscous_solve.DENSITY, "viscoMaxIter": 100000, "viscoMaxError": RESIDUAL}
    if method.startswith("Weiler"):
        solve["viscosityBoundary"] = solve["viscosity"]
    return {
        "Configuration": {
            "particleRadius": 0.5 * d, "simulationMethod": 4, "gravitation": [0, -9.81, 0], "timeStepSize": cube.step,
            "cflMethod": 0, "boundaryHandlingMethod": 2, "stopAt": (STEPS - 0.5) * cube.step, "enableVTKExport": False,
            "enablePartioExport": False, "DFSPH": {"minIterations": 2, "maxIterations": 1000, "maxError": 0.01}},
        "Materials": [{"id": "Fluid", "density0": viscous_solve.DENSITY, "viscosityMethod": METHODS[method], method: solve}],
        "RigidBodies": [{"geometryFile": str(box), "translation": [a, 0.75 * a, a], "scale": [2 * a, 1.5 * a, 2 * a],
                         "isDynamic": False, "isWall": True, "mapInvert": True, "mapThickness": 0.0,
                         "mapResolution": [40, 30, 40]}],
        # It puts the first layer a whole spacing into the block, and one layer less than fits.
        "FluidBlocks": [{"denseMode": 0, "start": [-0.5 * d] * 3, "end": [a + 0.5 * d] * 3,
                         "translation": [0.5 * a, 0, 0.5 * a], "scale": [1, 1, 1]}]}


@dataclasses.dataclass(frozen=True)
class Solve:
    seconds: float     # a step
    iterations: float  # a step; 0 when it was stopped
    other: float = 0   # [s] of the run, that were not the solve's

    def text(self):
        its = f"{self.iterations:.0f} iterations, " if self.iterations else f"stopped after {PATIENCE} s, at least "
        return f"{its}{self.seconds:.2f} s"


def run_peer(context, cube, method, folder, other=0.0):
    """Of the viscous solve. other: seconds of such a run that are not the solve's."""
    try:
        run = peer.run_program(context, lambda box: scene_of_peer(cube, method, box), f"method_{METHODS[method]}", folder,
                               timeout=PATIENCE)
    except TimedOut:
        return Solve((PATIENCE - other) / STEPS, 0)
    particles = int(peer.number(r"Number of fluid particles: (\d+)", run.output))
    if particles != cube.count**3:
        raise CommandFailed(f"the peer has {particles} particles instead of {cube.count**3}")
    seconds = 1e-3 * peer.number(r"Average time: CG solve: ([0-9.e+-]+)", run.output)
    return Solve(seconds, peer.number(r"Average number: Visco iterations: ([0-9.e+-]+)", run.output),
                 run.seconds - STEPS * seconds)


def compare(context, count, step):
    """Ours counts the whole solve with its set-up."""
    cube = viscous_solve.Cube(count, VISCOSITY, step, STEPS)
    with scratch(context, "viscous_peer") as folder:
        peers, other = {}, 0.0
        for method in METHODS:
            peers[method] = run_peer(context, cube, method, folder, other)
            other = peers[method].other
        steps = viscous_solve.run_cube(context, cube, folder / "ours", ranks=peer.THREADS,
                                       set={"method.viscosity.residual": RESIDUAL}).steps()
    ours = float(steps["viscosity"].mean())
    ok = all(solve.seconds >= WANTED[method] * ours for method, solve in peers.items())
    return Figure(f"{count**3} particles, {STEPS} steps of {1e3 * step:g} ms: {steps['viscosity iterations'].mean():.0f} iterations, "
                  f"{ours:.3f} s a step" + "".join(f", {method.split()[0]} {solve.text()}, {solve.seconds / ours:.1f} times"
                                                   for method, solve in peers.items()), ok)


def measure(case, context):
    context.peer(peer.NAME)
    return context.once("viscous peer", lambda: compare(context, *QUICK_CASE)) if context.quick else compare(context, *case)


def add_rows(table):
    for case in CASES:
        name = f"{case[0]**3 / 1000:.0f}k, {1e3 * case[1]:g} ms"
        table.row(f"against SPlisHSPlasH, {name}",
                  claim=f"2.16, a cube of 1000 Pa s on a floor, residual {RESIDUAL:g}, 2 ranks against 2 threads",
                  asked=">= 10 times faster than its Takahashi 2015, not slower than its Weiler 2018")(
            functools.partial(measure, case))
