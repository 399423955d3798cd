"""Row of `sph` on what a step costs beside that of an older program."""

from .iisph import OURS
from .run import RunFolder, built, execute, launched, scratch
from .table import Figure

PAIRS = 3
SETTLED = 10  # first steps, whose pressures come from nothing
PHASES = ("sort", "neighbours", "density", "forces", "viscosity", *OURS, "pressure force", "move")
DAM_BREAK = """schema_version: 1
domain: {{max: [2, {depth}, 1.25], spacing: {spacing}}}
liquids:
  - {{name: water, density: 1000, viscosity: 1 mPa.s, shapes: [{{box: {{min: [0, 0, 0], max: [1, {depth}, 1]}}}}]}}
time: {{end: 0.3}}
"""


def dam_break(particles):
    spacing = (0.5 / particles) ** (1 / 3)
    return DAM_BREAK.format(depth=0.5, spacing=spacing)


def step_time(context, program, scene, folder, end):
    """Mean seconds of a step of a run on 2 ranks, without its first steps."""
    settings = ("--set", f"time.end={end}", "--set", "output.interval=0")
    execute(context, launched(2, [program, "run", scene, "--out", folder, "--overwrite", *settings]))
    steps = RunFolder(folder).steps()
    return float(sum(steps[phase] for phase in PHASES)[SETTLED:].mean())


def cost(context):
    """Runs of both programs in turn, since others on the machine weigh on single ones; of the pairs' ratios the median."""
    before, now = context.peer("before"), built(context, "treacle")
    parts, right = [], True
    with scratch(context, "cost") as folder:
        water = folder / "dam_break.yaml"
        water.write_text(dam_break(60_000 if context.quick else 300_000))
        for name, scene, end in (("dam break", water, 0.2), ("viscous bunny", context.root / "inputs/viscous_bunny/scene.yaml", 0.1)):
            ratios = []
            for _ in range(PAIRS):
                old = step_time(context, before, scene, folder / "run", end)
                ratios.append(step_time(context, now, scene, folder / "run", end) / old)
            ratio = sorted(ratios)[PAIRS // 2]
            parts.append(f"{name} {ratio:.2f} ({', '.join(f'{one:.2f}' for one in ratios)})")
            right = right and ratio <= 1.15
    return Figure("; ".join(parts), right)


def add_rows(table):
    table.row("cost of a step", claim="dam break of 300k particles and viscous bunny, in pairs with the program before, --peer before=PATH",
              asked="<= 1.15 times")(cost)
