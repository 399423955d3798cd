"""Row of `house` that runs this program and one of before the tree was put in order: --peer before=PATH."""

import dataclasses

import numpy

from .run import RunFolder, execute, launched, built, scratch
from .table import Figure

# Short and coarse, both methods: free surface, bodies, viscosity, several liquids, inlets.
SCENES = {
    "dam_break": {"domain.spacing": "0.04", "time.end": "0.15"},
    "floating_body": {"domain.spacing": "0.02", "time.end": "0.07"},
    "viscous_bunny": {"domain.spacing": "0.02", "time.end": "0.1"},
    "rotating_drum": {"domain.spacing": "0.05", "time.end": "0.12"},
    "pouring": {"domain.spacing": "0.006", "time.end": "0.2"},
}
ALWAYS = {"output.double_precision": "true"}
RANKS = (1, 2)
# Columns of steps.csv that hold seconds of a computer, not of the liquid.
CLOCKS = {"time", "dt"}


@dataclasses.dataclass
class Difference:
    frames: int = 0
    steps: int = 0
    found: list = dataclasses.field(default_factory=list)


def scene_of(context, program, name):
    """The scene as the program's own tree has it, where it lies in one: keys may have other names there."""
    for folder in program.resolve().parents:
        path = folder / "inputs" / name / "scene.yaml"
        if path.exists():
            return path
    return context.root / "inputs" / name / "scene.yaml"


def run(context, program, name, folder, ranks):
    overrides = [word for key, value in {**SCENES[name], **ALWAYS}.items() for word in ("--set", f"{key}={value}")]
    scene = scene_of(context, program, name)
    finished = execute(context, launched(ranks, [program, "run", scene, "--out", folder, *overrides]))
    return RunFolder(folder, finished)


def compare_frames(difference, before, after):
    """Arrays are compared byte for byte; a field of another name by its place among the fields."""
    pairs = list(zip(before.frames(), after.frames()))
    if len(before.frames()) != len(after.frames()):
        difference.found.append(f"{len(before.frames())} frames, now {len(after.frames())}")
    for number, (one, other) in enumerate(pairs):
        difference.frames += 1
        old, new = before.frame(number), after.frame(number)
        if one[0] != other[0]:
            difference.found.append(f"frame {number} at {one[0]} s, now {other[0]} s")
        if sorted(array.tobytes() for array in old.values()) != sorted(array.tobytes() for array in new.values()):
            names = [name for name in old if name not in new or old[name].tobytes() != new[name].tobytes()]
            difference.found.append(f"frame {number}: {', '.join(names)}")
            return


def measured_columns(table):
    """Columns that do not depend on the computer's clock."""
    clocks = {name for name, title in zip(table.names(), table.header) if title.endswith("[s]") and name not in CLOCKS}
    return [name for name in table.names() if name not in clocks]


def compare_steps(difference, before, after):
    """Columns in their order, since some have other names now."""
    one, other = before.steps(), after.steps()
    names, now = measured_columns(one), measured_columns(other)
    difference.steps += len(one)
    if (len(one), len(names)) != (len(other), len(now)):
        difference.found.append(f"{len(one)} steps of {len(names)} columns, now {len(other)} of {len(now)}")
        return
    unlike = [old for old, new in zip(names, now) if not numpy.array_equal(one[old], other[new], equal_nan=True)]
    if unlike:
        difference.found.append(f"steps: {', '.join(unlike)}")


def results(context):
    programs = {"before": context.peer("before"), "after": built(context, "treacle")}
    total, parts = Difference(), []
    for name in SCENES:
        for ranks in RANKS:
            difference = Difference()
            with scratch(context, f"{name}_{ranks}") as folder:
                runs = {key: run(context, program.resolve(), name, folder / key, ranks) for key, program in programs.items()}
                compare_frames(difference, runs["before"], runs["after"])
                compare_steps(difference, runs["before"], runs["after"])
            total.frames += difference.frames
            total.steps += difference.steps
            parts += [f"{name} on {ranks}: {text}" for text in difference.found]
    text = f"{len(SCENES)} scenes on {' and '.join(map(str, RANKS))} ranks, {total.frames} frames, {total.steps} steps"
    return Figure(f"{text}: {'; '.join(parts) or 'all the same bit for bit'}", not parts and total.steps > 0)


def add_rows(table):
    table.row("results", claim="five scenes of both methods, 1 and 2 ranks, before and after", asked="unchanged bit for bit")(results)
