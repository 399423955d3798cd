"""Rows of `viscosity` on the solve: iterations, memory, ranks, steps."""

import dataclasses

import numpy

from .run import run_scene, scratch
from .table import Figure

RANKS = 2
EDGE, DENSITY, STEP = 0.5, 1000.0, 1e-3  # of the cube [m], [kg/m3], [s]
STIFFNESS = (10, 100, 1e4)               # nu dt / d^2
COUNTS, QUICK_COUNTS = (17, 37, 79), (12, 20, 29)  # particles an edge: 5k, 50k, 500k

CUBE = """schema_version: 1
title: Viscous cube on a floor that it sticks to
domain:
  max: [{width}, {width}, {height}]
  spacing: {spacing}
  boundaries: {{x_min: open, x_max: open, y_min: open, y_max: open, z_min: {{slip: no_slip}}, z_max: open}}
liquids:
  - name: honey
    density: 1000
    viscosity: {viscosity}
    shapes:
      - box: {{min: [{low}, {low}, 0], max: [{high}, {high}, {edge}]}}
time: {{end: {end}, rule: fixed, step: {step}}}
output: {{interval: 0}}
"""


@dataclasses.dataclass(frozen=True)
class Cube:
    count: int        # particles an edge
    viscosity: float  # [Pa s]
    step: float = STEP
    steps: int = 2

    @property
    def spacing(self):
        return EDGE / self.count

    def text(self):
        return CUBE.format(width=2 * EDGE, height=1.5 * EDGE, low=0.5 * EDGE, high=1.5 * EDGE, edge=EDGE,
                           spacing=repr(self.spacing), viscosity=repr(self.viscosity), step=self.step,
                           end=repr(self.steps * self.step))


def stiff_cube(count, stiffness, **more):
    return Cube(count, stiffness * (EDGE / count) ** 2 / STEP * DENSITY, **more)


def run_cube(context, cube, folder, *, ranks=RANKS, set=None):
    folder.mkdir()
    scene = folder / "scene.yaml"
    scene.write_text(cube.text())
    return run_scene(context, scene, folder / "run", ranks=ranks, set=set, timeout=4 * 3600)


def iterations(context):
    counts = QUICK_COUNTS if context.quick else COUNTS
    parts, ok = [], True
    with scratch(context, "cubes") as folder:
        for stiffness in STIFFNESS:
            found = []
            for count in counts:
                run = run_cube(context, stiff_cube(count, stiffness), folder / f"{count}_{stiffness:g}")
                found.append(float(run.steps()["viscosity iterations"].mean()))
            ok = ok and max(found) <= 1.5 * found[0]
            parts.append(f"{stiffness:g}: " + ", ".join(f"{one:.1f}" for one in found) + f", {max(found) / found[0]:.2f} times")
    return Figure(f"{', '.join(str(count**3) for count in counts)} particles, nu dt/d^2 = " + "; ".join(parts), ok)


def memory(context):
    """Peaks of a run with the solve and of one without a viscosity."""
    count = 46 if context.quick else 79 # of fewer particles the peaks differ by 90 B a particle from run to run
    with scratch(context, "memory") as folder:
        runs = [run_cube(context, Cube(count, viscosity), folder / name)
                for name, viscosity in (("viscous", 1000.0), ("inviscid", 0.0))]
        peaks = [RANKS * run.summary()["peak memory per rank [bytes]"]["mean"] for run in runs]
        arrays = [RANKS * run.summary()["memory of particles, lists and matrix per rank [bytes]"]["mean"] for run in runs]
    more = (peaks[0] - peaks[1]) / count**3
    return Figure(f"{count**3} particles: peak {more:.0f} B a particle more with the viscous solve, its arrays "
                  f"{(arrays[0] - arrays[1]) / count**3:.0f} B", more <= 1000)


def ranks_agree(context):
    """Velocities after two steps: the solves end at a residual of 1e-10 of the velocities."""
    settings = {"method.viscosity.residual": 1e-10, "method.pressure.stop": "residual", "method.pressure.residual": 1e-10,
                "output.interval": 2 * STEP, "output.double_precision": "true"}
    with scratch(context, "ranks") as folder:
        frames = [run_cube(context, stiff_cube(20, 100), folder / str(ranks), ranks=ranks, set=settings).frame(-1)
                  for ranks in (1, 2, 3, 4)]
    scale = numpy.abs(frames[0]["velocity"]).max()
    apart = [float(numpy.abs(frame["velocity"] - frames[0]["velocity"]).max() / scale) for frame in frames[1:]]
    return Figure("8000 particles, nu dt/d^2 = 100, residual 1e-10: velocities of 2, 3, 4 ranks differ by "
                  + ", ".join(f"{one:.1e}" for one in apart) + " of the largest", max(apart) < 1e-7)


PHASES = ("sort", "neighbours", "density", "forces", "viscosity", "predict", "assemble", "solve", "pressure force", "move")
BUNNY = "inputs/viscous_bunny/scene.yaml"
DROPS = ((1000, 1.3e-3), (50000, 1e-4))  # viscosity [Pa s] and step [s] of the dissertation, figure 4.3 d and f
EXPLICIT_STEP = 5e-6                     # of figure 4.3 b and e [s]


def drop(context, folder, name, settings, **options):
    return run_scene(context, context.root / BUNNY, folder / name, ranks=RANKS, set={"output.interval": 0, **settings},
                     timeout=8 * 3600, **options)


def seconds_of(steps):
    """Of each step, in all its phases."""
    return sum(steps[phase] for phase in PHASES)


def calm(run):
    """None lost, and nothing faster than a fall through the whole scene."""
    steps = run.steps()
    lost = int(steps["particles"][0] - steps["particles"][-1])
    return lost, float(steps["max speed"].max())


def stability(context):
    end, parts, ok = 0.2 if context.quick else 0.5, [], True
    with scratch(context, "stability") as folder:
        for viscosity, step in DROPS:
            for factor in (1, 10):
                short = 0.01 if context.quick and factor == 1 and step < 1e-3 else end
                run = drop(context, folder, f"{viscosity}_{factor}",
                           {"liquids.bunny.viscosity": viscosity, "time.rule": "fixed", "time.step": factor * step,
                            "time.end": short})
                lost, speed = calm(run)
                ok = ok and lost == 0 and speed < 2.8  # sqrt(2 g 0.4 m)
                parts.append(f"{viscosity} Pa s, {1e3 * factor * step:g} ms, {short:g} s: {lost} lost, at most {speed:.2f} m/s")
        for viscosity, step in ((1000, 1.3e-3), (50000, EXPLICIT_STEP)):
            run = drop(context, folder, f"explicit_{viscosity}",
                       {"liquids.bunny.viscosity": viscosity, "time.rule": "fixed", "time.step": step,
                        "method.viscosity.integration": "explicit", "method.viscosity.form": "as_published"}, expect=2)
            named = "above the limit of the explicit viscosity" in run.finished.output
            ok = ok and named
            parts.append(f"explicit {viscosity} Pa s, {1e3 * step:g} ms: {'refused' if named else 'NOT REFUSED'}")
    return Figure("; ".join(parts), ok)


def against_explicit(context):
    """Both from rest above the floor to the same time; quick: the explicit one's steps are counted on."""
    end = 0.2
    explicit = {"time.rule": "fixed", "time.step": EXPLICIT_STEP, "method.viscosity.integration": "explicit",
                "method.viscosity.form": "as_published", "time.end": 0.002 if context.quick else end}
    with scratch(context, "explicit") as folder:
        seconds = float(seconds_of(drop(context, folder, "ours", {"time.end": end}).steps()).sum())
        theirs = float(seconds_of(drop(context, folder, "explicit", explicit).steps()).mean()) * end / EXPLICIT_STEP
    return Figure(f"to {end} s: {seconds:.1f} s, explicit {theirs:.0f} s with steps of 5 us"
                  f"{' (from 400 of them)' if context.quick else ''}, {theirs / seconds:.0f} times", theirs >= 20 * seconds)


def add_rows(table):
    table.row("iterations", claim="of the default from 5k to 500k particles, nu dt/d^2 = 10, 100, 1e4",
              asked="growth <= 1.5 times")(iterations)
    table.row("memory", claim="of the viscous solve, without a matrix", asked="<= 1 kB a particle")(memory)
    table.row("ranks", claim="1, 2, 3, 4 ranks give the same velocities", asked="to the solver's tolerance")(ranks_agree)
    table.row("stability", claim="bunny at 1000 and 50000 Pa s with the dissertation's steps and 10 times larger ones; "
              "explicit at figure 4.3's c and e", asked="none lost, no faster than the fall; explicit is refused")(stability)
    table.row("against explicit", claim="the full form explicit (Andrade et al. 2014) on figure 4.4's scene",
              asked=">= 20 times faster to the same time")(against_explicit)
