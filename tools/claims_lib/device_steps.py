"""Rows of `device` on whole steps of four scenes: the host's share, phases beside an older program, ranks beside threads."""

import dataclasses
import os
import pathlib

import numpy

from .house_results import CLOCKS
from .run import RunFolder, built, execute, launched, scratch
from .sph_cost import dam_break
from .table import CommandFailed, Figure, Unmeasured

LEAST_SHARE = 0.01 # of a step, of phases that are judged: shorter ones are the clock's noise
PAIRS, QUICK_PAIRS = 5, 3
ASSEMBLED = {"method.pressure.solver": "isph"} # the default's solves have no matrix and no hierarchy
CHEBYSHEV = {**ASSEMBLED, "method.pressure.multilevel.smoother": "chebyshev"}


@dataclasses.dataclass(frozen=True)
class Scene:
    """A scene of inputs with what is set in it; steps from `settled` on count. short: what else is set with --quick."""

    name: str
    end: float      # [s]
    settled: float  # [s]
    short: dict     # its end, steps from `settled_short` on count
    settled_short: float
    settings: dict = dataclasses.field(default_factory=dict)


SCENES = (
    Scene("dam_break", 0.3, 0.05, {"time.end": 0.05}, 0.025, ASSEMBLED),
    Scene("viscous_bunny", 0.3, 0.15, {"domain.spacing": 0.016, "time.end": 0.18}, 0.15, ASSEMBLED),
    Scene("honey_dipper", 0.3, 0.02, {"domain.spacing": 0.01, "time.end": 0.1}, 0.02),
    Scene("gears", 0.3, 0.015, {"domain.spacing": 0.02, "time.end": 0.05}, 0.015),
)
# By the default pressure solver, which has no hierarchy.
DEFAULTS = tuple(dataclasses.replace(scene, settings={}) for scene in SCENES[:2])
WHOLE = {"gears": 0.6}  # times the step before; of the others only phases are asked for
CUBE = """schema_version: 1
domain: {{min: [0, 0, 0], max: [1, 1, 0.75], spacing: {spacing}, boundaries: {{z_min: {{slip: no_slip}}}}}}
liquids: [{{name: honey, density: 1000, viscosity: 1000, shapes: [{{box: {{min: [0.25, 0.25, 0], max: [0.75, 0.75, 0.5]}}}}]}}]
time: {{end: 0.01, rule: fixed, step: 1 ms}}
"""


@dataclasses.dataclass(frozen=True)
class Timed:
    """Mean seconds of a step by phase."""

    phases: dict
    steps: int

    @property
    def step(self):
        return sum(self.phases.values())


def phases_of(steps):
    """Columns that hold seconds of a computer."""
    return [name for name, title in zip(steps.names(), steps.header) if title.endswith("[s]") and name not in CLOCKS]


def seconds_of(run, settled):
    """{phase: array of its seconds in each step behind a time [s]}."""
    steps = run.steps()
    late = steps["time"] > settled
    if not late.any():
        raise CommandFailed(f"{run.folder}: no step after {settled} s")
    return {phase: steps[phase][late] for phase in phases_of(steps)}


def fastest(runs):
    """Of runs of the same steps the least time of each step and phase: other programs on the machine make it slower, never faster."""
    least = {phase: numpy.min([run[phase] for run in runs], axis=0) for phase in runs[0]}
    return Timed({phase: float(seconds.mean()) for phase, seconds in least.items()}, len(next(iter(least.values()))))


def run_program(context, program, scene, folder, settings, *, ranks=1, env=None):
    words = [word for key, value in {"output.interval": 0, **settings}.items() for word in ("--set", f"{key}={value}")]
    done = execute(context, launched(ranks, [program, "run", scene, "--out", folder, "--overwrite", *words]), env=env, timeout=4 * 3600)
    return RunFolder(folder, done)


def input_of(context, scene):
    return context.root / "inputs" / scene.name / "scene.yaml"


def settings_of(context, scene):
    return {**scene.settings, "time.end": scene.end, **(scene.short if context.quick else {})}


def start_of(context, scene):
    return scene.settled_short if context.quick else scene.settled


def compiled_clock(context, folder):
    """A library that sums the time in kernels, for Kokkos' interface to tools."""
    library = folder / "kernel_clock.so"
    execute(context, ["c++", "-O2", "-shared", "-fPIC", pathlib.Path(__file__).with_name("kernel_clock.cpp"), "-o", library])
    return library


def mark_of(scene):
    """A kernel that runs once in each step."""
    return "treacle::advect" if scene.name in ("honey_dipper", "gears") else "treacle::move"


def share_of_marks(marks, first):
    """Share of processor time outside of kernels and kernels a step, from the mark of a step to the last one.
    marks: array of rows (kernels, seconds in them, seconds of the process), a step each."""
    kernels, inside, everything = marks[-1] - marks[first]
    return float(1 - inside / everything), float(kernels / (len(marks) - 1 - first))


def host_share(context, scene, library, folder):
    """From the first step behind `settled` on."""
    marks = folder / "marks"
    marks.unlink(missing_ok=True)
    env = {"KOKKOS_PROFILE_LIBRARY": str(library), "KOKKOS_TOOLS_LIBS": str(library), "KERNEL_CLOCK_FILE": str(marks),
           "KERNEL_CLOCK_MARK": mark_of(scene)}
    smoother = CHEBYSHEV if scene.settings else {} # that of devices, where a key chooses it
    run = run_program(context, built(context, "treacle"), input_of(context, scene), folder / scene.name,
                      {**settings_of(context, scene), **smoother}, env=env)
    if not marks.exists():
        raise Unmeasured("this build's Kokkos loads no KOKKOS_PROFILE_LIBRARY")
    found, times = numpy.loadtxt(marks, ndmin=2), run.steps()["time"]
    first = int((times <= start_of(context, scene)).sum())
    if len(found) < len(times) or first > len(times) - 2:
        raise CommandFailed(f"{scene.name}: {len(found)} kernels {mark_of(scene)} in {len(times)} steps, {first} of them settled")
    return share_of_marks(found[-len(times):], first)


def host_shares(context):
    parts, ok = [], True
    with scratch(context, "shares") as folder:
        library = compiled_clock(context, folder)
        for scene in (*SCENES, *DEFAULTS):
            share, number = host_share(context, scene, library, folder)
            ok = ok and 0 <= share <= 0.03
            name = f"{scene.name}{', default solver' if scene in DEFAULTS else ''}"
            parts.append(f"{name} {100 * share:.1f} % ({number:.0f} kernels a step)")
    return Figure("processor time outside of kernels, one rank: " + ", ".join(parts), ok)


def ratios(before, now):
    """{phase: ratio} of the phases that take long enough to be judged, and "step" of all together."""
    longest = {name: max(seconds, now.phases.get(name, 0)) for name, seconds in before.phases.items()}
    found = {name: now.phases[name] / before.phases[name] for name in before.phases
             if name in now.phases and before.phases[name] > 0 and longest[name] >= LEAST_SHARE * before.step}
    return {**found, "step": now.step / before.step}


def load():
    """How busy the machine is, as text: what others do weighs on times."""
    return f"load {os.getloadavg()[0]:.1f} on {os.cpu_count()} cores"


def paired(context, scene, programs, folder):
    """Ratios of the second program's times to the first's, run in turn."""
    runs = [[], []]
    for _ in range(QUICK_PAIRS if context.quick else PAIRS):
        for program, found in zip(programs, runs):
            run = run_program(context, program, input_of(context, scene), folder / scene.name, settings_of(context, scene))
            found.append(seconds_of(run, start_of(context, scene)))
    return ratios(*map(fastest, runs))


def phases(context):
    programs = (context.peer("before").resolve(), built(context, "treacle"))
    parts, ok = [], True
    with scratch(context, "phases") as folder:
        for scene in SCENES:
            found = paired(context, scene, programs, folder)
            whole = found.pop("step")
            ok = ok and max(found.values()) <= 1.03 and whole <= WHOLE.get(scene.name, 1.03)
            parts.append(f"{scene.name} {whole:.2f} (" + ", ".join(f"{name} {ratio:.2f}" for name, ratio in found.items()) + ")")
    return Figure(f"of {QUICK_PAIRS if context.quick else PAIRS} pairs on one rank the least time of each step ({load()}): " + "; ".join(parts), ok)


def threaded_program(context):
    """Of the witness: --peer openmp=PATH, or what tools/witness has built."""
    if "openmp" in context.peers:
        return context.peers["openmp"].resolve()
    found = [path for path in sorted((context.root / "build/openmp").rglob("treacle")) if path.is_file() and os.access(path, os.X_OK)]
    if found:
        return found[0]
    source = os.environ.get("KOKKOS_SOURCE")
    raise Unmeasured("needs KOKKOS_SOURCE=DIR tools/witness, or --peer openmp=PATH" if not source else
                     "needs build/openmp: tools/witness builds it, KOKKOS_SOURCE is set")


def threaded_cases(context, folder):
    """(name, scene file, settings, first time that counts [s]) of the four scenes of ranks beside threads."""
    water, cube = folder / "dam_break.yaml", folder / "cube.yaml"
    water.write_text(dam_break(60_000 if context.quick else 300_000))
    cube.write_text(CUBE.format(spacing=0.5 / (24 if context.quick else 58)))
    yield "dam break", water, {"time.end": 0.05, **CHEBYSHEV}, 0.01
    yield "viscous cube", cube, {}, 0.001
    for scene in SCENES[2:]:
        yield scene.name, input_of(context, scene), settings_of(context, scene), start_of(context, scene)


def threads(context):
    program = threaded_program(context)
    parts, ok = [], True
    with scratch(context, "threads") as folder:
        for name, scene, settings, start in threaded_cases(context, folder):
            both = [[seconds_of(run_program(context, program, scene, folder / "run", settings, ranks=ranks,
                                            env={"OMP_NUM_THREADS": str(2 // ranks)}), start) for _ in range(PAIRS)] for ranks in (2, 1)]
            found = ratios(*map(fastest, both))
            whole, worst = found.pop("step"), max(found.values())
            ok = ok and worst <= 1.15 and whole <= 1.1
            parts.append(f"{name} {whole:.2f} (" + ", ".join(f"{phase} {ratio:.2f}" for phase, ratio in found.items()) + ")")
    return Figure(f"1 rank x 2 threads over 2 ranks x 1 ({load()}): " + "; ".join(parts), ok)


def add_rows(table):
    four = "dam break, viscous bunny, honey dipper, gears"
    table.row("host share", claim=f"share of one core's step outside of kernels, {four}; by Kokkos' interface to tools",
              asked="<= 3 % in all four")(host_shares)
    table.row("ranks and threads", claim="1 rank x 2 threads beside 2 ranks x 1 thread: dam break of 300k, viscous cube of 195k, honey dipper, gears",
              asked="each phase <= 1.15 times, the whole step <= 1.1 times")(threads)
    table.row("phases", claim=f"Serial back end, {four}, pairs with the program before, --peer before=PATH; phases of 1 % of a step and more",
              asked="each <= 1.03 times; gears' whole step <= 0.6 times")(phases)
