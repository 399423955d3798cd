"""Rows of `pressure` on free surfaces and solids: largest stable steps, and the square domain."""

import dataclasses
import string

import numpy

from .gtest import run_gtest
from .run import last_words, run_scene, scratch
from .table import Figure

RANKS = 2
# The discretisation of the dissertation's chapter 2.
THEIRS = {"method.pressure.solver": "isph", "method.kernel": "mueller", "method.support_ratio": 2, "method.density.kind": "blended",
          "method.pressure.solid_term": "decomposed", "method.pressure.prediction": 0.5}
# Steps at a spacing of 15 mm, those of the dissertation's figure 2.6 among them; others in proportion [s].
LADDER = tuple(1e-3 * step for step in (2.82, 2.37, 2.0, 1.68, 1.4, 1.2, 1.0, 0.75, 0.62, 0.52, 0.42, 0.35))
FINE = 15e-3  # [m]
QUICK_EDGE, EDGE = 16, 35  # particles along the cube of liquid
SMALLEST_END = 0.02        # [s]
RULES = {  # of figure 2.6, by their names there
    "density-based": {"method.pressure.dirichlet": "density"},
    "density-based (clamped)": {"method.pressure.dirichlet": "density", "method.pressure.clamping": "sources"},
    "surface-based": {"method.pressure.dirichlet": "surface"},
    "surface-based (clamped)": {"method.pressure.dirichlet": "surface", "method.pressure.clamping": "sources"},
    "ghost-particle-based": {"method.pressure.dirichlet": "ghosts"},
    "ghost-particle-based (clamped)": {"method.pressure.dirichlet": "ghosts", "method.pressure.clamping": "sources"},
    "source-term-based": {"method.pressure.dirichlet": "source"},
    "ours": {"method.pressure.dirichlet": "predicted"},
    "ours (clamped)": {"method.pressure.dirichlet": "predicted", "method.pressure.clamping": "sources"},
}
# Of chapter 3: with Eq. 2.10 what limits the step of every rule is that term itself (src/sph/theory.md).
SOLID_TERM = "unified"
# A run is stable when at most one particle in a thousand goes through a wall, its energy never rises by more than this share
# of the first (single particles that are thrown out of corners do not count, a layer that is does), and the mean compression
# stays below the limit of weakly compressible SPH (Monaghan 1994): a liquid that loses its volume is none.
RISE, COMPRESSION = 0.02, 0.01
STABLE = (f"stable: at most 0.1 % of the particles lost, energy never rises by {RISE:.0%} of the first, mean compression below "
          f"{COMPRESSION:g}; the largest step that is, with the next smaller one")

DROP = """schema_version: 1
title: A cube of water falls a little
domain:
  max: [0.9, 0.9, 0.9]
  spacing: $spacing
  boundaries: {z_max: {kind: open, outflow: true}}
liquids:
  - name: water
    density: 1000
    shapes:
      - box: {min: [0.1875, 0.1875, 0.05], max: [0.7125, 0.7125, 0.575]}
time: {end: 0.6, rule: fixed, step: $step}
output: {interval: $interval}
method: {pressure: {wall_contact: none}} # to count what pressures alone do not hold
max_lost_fraction: 0.001
"""
DROP_EDGE = 0.525  # [m]


@dataclasses.dataclass(frozen=True)
class Trial:
    """A run of one step size."""

    step: float   # [s]
    stable: bool
    why: str      # what it fails by
    run: object   # RunFolder


@dataclasses.dataclass(frozen=True)
class Scene:
    """A scene with $spacing, $step and $interval to fill in."""

    name: str
    text: str
    spacing: float  # [m]

    def steps(self):
        return [step * self.spacing / FINE for step in LADDER]


def cube_drop(context, edge=None):
    edge = edge or context.pick(EDGE, QUICK_EDGE, 8)
    return Scene("cube drop", DROP, DROP_EDGE / edge)


def rule_settings(name):
    return {**THEIRS, "method.pressure.solid_term": SOLID_TERM, **RULES[name]}


def judge(run):
    """What a run fails by; empty for a stable one."""
    steps = run.steps()
    if run.finished.code != 0:
        lost = "particles are lost" in run.finished.output
        cause = "particles lost" if lost else last_words(run.finished.output, lines=1)
        return f"at {steps['time'][-1]:.2f} s {cause}"
    energy = steps["kinetic energy"] + steps["potential energy"]
    rise = (energy - numpy.minimum.accumulate(energy)).max() / energy[0]
    if not rise < RISE:
        return f"energy rises by {rise:.0%}"
    compression = steps["mean compression"].max()
    return "" if compression < COMPRESSION else f"mean compression of {compression:.3f}"


def try_step(context, scene, folder, step, settings, ranks=RANKS, interval=0):
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / "scene.yaml"
    if context.smallest:
        settings = {**settings, "time.end": SMALLEST_END}
    path.write_text(string.Template(scene.text).substitute(spacing=scene.spacing, step=step, interval=interval))
    run = run_scene(context, path, folder / f"step_{1e6 * step:.0f}us", ranks=ranks, set=settings,
                    arguments=["--overwrite"], expect=None, timeout=4 * 3600)
    why = judge(run)
    return Trial(step, not why, why, run)


def largest_stable(context, scene, folder, settings, ranks=RANKS):
    """The largest step that is stable and whose next smaller one is too, as a Trial or None; and all trials. A step may
    pass by luck: splashes are chaotic."""
    trials = []
    for step in scene.steps()[context.pick(0, 0, -1):]:
        trials.append(try_step(context, scene, folder, step, settings, ranks))
        if len(trials) > 1 and trials[-1].stable and trials[-2].stable:
            return trials[-2], trials
    return (trials[-1] if trials[-1].stable else None), trials


def text_of(best):
    return f"{1e3 * best.step:.2f} ms" if best else "none"


def least_failure(trials):
    """What the smallest step that is not stable fails by."""
    failed = [trial for trial in trials if not trial.stable]
    return f" ({1e3 * failed[-1].step:.2f} ms: {failed[-1].why})" if failed else ""


def stable_steps(context):
    scene = cube_drop(context)
    names = ("ours", "source-term-based", "density-based", "ghost-particle-based", "surface-based")
    found, failed = {}, {}
    with scratch(context, "cube_drop") as folder:
        for name in names:
            found[name], failed[name] = largest_stable(context, scene, folder / name, rule_settings(name))
    size = {name: best.step if best else 0 for name, best in found.items()}
    ok = size["ours"] > size["source-term-based"] > size["density-based"] > max(size["ghost-particle-based"],
                                                                                size["surface-based"])
    rules = ", ".join(name + " " + text_of(found[name]) + least_failure(failed[name]) for name in names)
    return Figure(f"spacing {1e3 * scene.spacing:.1f} mm: {rules} ({STABLE})", ok)


def square_domain(context):
    report = run_gtest(context, "sph_ranks_test", "SquareDomain.*", ranks=RANKS)
    ours, theirs = float(report.properties["unified"]), float(report.properties["unknowns"])
    return Figure(f"unified term {ours:.2e}, solids as unknowns {theirs:.2e} of the largest pressure: "
                  f"{theirs / ours:.0f} times; {report.text()}", report.ok and theirs >= 5 * ours)


def add_rows(table):
    table.row("exact square-domain pressure", claim="largest error in a square with walls on three sides (figure 3.4)",
              asked=">= 5 times smaller with the unified term than with solids as unknowns")(square_domain)
    table.row("stable time step, cube drop", claim="largest stable step of each free-surface rule (figure 2.6)",
              asked="ours > source-term > density > ghosts, surface; theirs 1.68, 1.20, 0.75, 0.52, none from 0.35 ms on")(
                  stable_steps)
