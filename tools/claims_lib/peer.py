"""Rows that compare with SPlisHSPlasH, built beside: --peer splishsplash=PATH of its SPHSimulator."""

import dataclasses
import functools
import json
import pathlib
import re

from . import iisph
from .run import execute, run_scene, scratch
from .table import CommandFailed, Figure

NAME = "splishsplash"
THREADS = 2
DENSITY_ERROR = 1e-4  # of both, mean share of the rest density
# Liquid cubes of this many particles a side, the time step, our corrections of the pressures, and the ends of its DFSPH and
# of its IISPH [s]: two sizes of the same tank. Its liquid starts thinner than at rest, and its solves are cheap until it is
# not: to end early spares it iterations. Each is compared over the steps that it made. Steps of 4 ms need a correction.
CASES = ((49, 2e-3, 0, 0.32, 0.32), (49, 4e-3, 1, 0.32, 0.32), (76, 1.3e-3, 0, 0.39, 0.2))
QUICK_CASE = (30, 4e-3, 1, 0.32, 0.32)
LID = {"domain.boundaries.z_max": "wall"} # as the peer's tank has
METHODS = {"DFSPH": 4, "IISPH": 3}  # its numbers
WANTED = {"DFSPH": 4, "IISPH": 10}


@dataclasses.dataclass(frozen=True)
class Tank:
    """A cube of water in a corner of a closed tank of twice its length; y is up in the peer's."""

    count: int
    spacing: float
    step: float
    corrections: int
    ends: dict  # of the peer's methods [s]

    @property
    def edge(self):
        return self.count * self.spacing


def tank_of(case, quick):
    """The largest step at the coarsest spacing is iisph.COURANT of what sqrt(g H) takes for a spacing."""
    coarsest = QUICK_CASE[0] if quick else min(count for count, *_ in CASES)
    edge = iisph.GRAVITY * (coarsest * max(step for _, step, *_ in CASES) / iisph.COURANT) ** 2
    count, step, corrections, *ends = case
    return Tank(count, edge / count, step, corrections, dict(zip(METHODS, ends)))


def scene_of_peer(tank, method, box):
    d, a = tank.spacing, tank.edge
    limits = {"minIterations": 2, "maxIterations": 10000, "maxError": 100 * DENSITY_ERROR}
    return {
        "Configuration": {
            "particleRadius": 0.5 * d, "simulationMethod": METHODS[method], "gravitation": [0, -iisph.GRAVITY, 0],
            "timeStepSize": tank.step, "cflMethod": 0, "boundaryHandlingMethod": 2, "stopAt": tank.ends[method],
            "enableVTKExport": False, "enablePartioExport": False, method: limits},
        "Materials": [{"id": "Fluid", "density0": 1000, "viscosityMethod": 1, "Standard viscosity": {"viscosity": 0.01}}],
        "RigidBodies": [{"geometryFile": str(box), "translation": [a, 0.625 * a, 0.5 * a], "scale": [2 * a, 1.25 * a, a],
                         "isDynamic": False, "isWall": True, "mapInvert": True, "mapThickness": 0.0,
                         "mapResolution": [40, 25, 20]}],
        # It puts the first layer a whole spacing into the block, and one layer less than fits.
        "FluidBlocks": [{"denseMode": 0, "start": [-0.5 * d] * 3, "end": [a + 0.5 * d] * 3,
                         "translation": [0, 0, 0], "scale": [1, 1, 1]}]}


@dataclasses.dataclass(frozen=True)
class PeerRun:
    particles: int
    solve: float       # [s] a step
    iterations: float
    search: float      # [s] a step


def number(pattern, text):
    found = re.findall(pattern, text)
    if not found:
        raise CommandFailed(f"the peer's log has no {pattern!r}")
    return float(found[-1])


def run_program(context, scene_of, name, folder, timeout=4 * 3600):
    """A run of the peer on a scene of that name; scene_of makes it from the file of its unit box."""
    program = pathlib.Path(context.peer(NAME)).resolve()
    boxes = sorted(program.parent.parent.glob("**/UnitBox.obj"))
    if not boxes:
        raise CommandFailed(f"no UnitBox.obj beside {program}")
    scene = folder / f"{name}.json"
    scene.write_text(json.dumps(scene_of(boxes[0])))
    return execute(context, [program, scene, "--no-gui", "--no-initial-pause", "--output-dir", folder / name],
                   env={"OMP_NUM_THREADS": str(THREADS)}, timeout=timeout, cwd=folder)


def run_peer(context, tank, method, folder):
    output = run_program(context, lambda box: scene_of_peer(tank, method, box), method, folder).output

    def average(what, name):
        return number(rf"Average {what}: {name}: ([0-9.e+-]+)", output)

    return PeerRun(int(number(r"Number of fluid particles: (\d+)", output)),
                   1e-3 * average("time", "pressureSolve"), average("number", f"{method} - iterations"),
                   1e-3 * average("time", "neighborhood_search"))


def run_ours(context, tank, folder):
    scene = folder / "scene.yaml"
    scene.write_text(iisph.SCENE.format(length=2 * tank.edge, edge=tank.edge, height=1.25 * tank.edge,
                                        spacing=tank.spacing, end=max(tank.ends.values()), step=tank.step))
    return run_scene(context, scene, folder / "ours", ranks=THREADS, timeout=4 * 3600,
                     set={"method.pressure.solver": "isph", "method.pressure.density_error": DENSITY_ERROR, "method.pressure.wall_force": "balanced",
                          "method.pressure.corrections": tank.corrections, **LID}).steps()


def compare(context, tank):
    with scratch(context, "peer") as folder:
        peers = {method: run_peer(context, tank, method, folder) for method in METHODS}
        steps = run_ours(context, tank, folder)
    solve = sum(steps[phase] for phase in iisph.OURS)
    search = float((steps["sort"] + steps["neighbours"]).mean())
    least_search = min(peer.search for peer in peers.values())
    text = (f"{tank.count**3} particles, {len(steps)} steps of {1e3 * tank.step:g} ms: ours, {tank.corrections} corrections, "
            f"{steps['pressure iterations'].mean():.1f} iterations, {float(solve.mean()):.3f} s a step, mean compression "
            f"{steps['mean compression'].mean():.1e}")
    ok = search <= least_search
    for method, peer in peers.items():
        if peer.particles != tank.count**3:
            raise CommandFailed(f"the peer has {peer.particles} particles instead of {tank.count**3}")
        ratio = peer.solve / float(solve[steps["time"] <= tank.ends[method] + tank.step / 2].mean())
        ok = ok and ratio >= WANTED[method]
        text += (f", {method} to {tank.ends[method]:g} s {peer.iterations:.0f} iterations, {peer.solve:.2f} s, "
                 f"{ratio:.1f} times")
    return Figure(f"{text}; neighbour search {search:.3f} s, its {least_search:.3f} s", ok)


def measure(case, context):
    context.peer(NAME)
    if context.quick:
        return context.once("peer", lambda: compare(context, tank_of(QUICK_CASE, True)))
    return compare(context, tank_of(case, False))


def add_rows(table):
    for case in CASES:
        name = f"{case[0]**3 / 1000:.0f}k, {1e3 * case[1]:g} ms"
        table.row(f"against SPlisHSPlasH, {name}",
                  claim="2.16, the same dam break, step and density error 0.01 %, 2 ranks against 2 threads",
                  asked="pressure solve >= 4 times faster than its DFSPH, >= 10 times than its IISPH; neighbour search no "
                        "slower")(functools.partial(measure, case))
