"""Row of `sph` on what a step costs beside that of an older program."""

import json

from .run import built, execute, launched, scratch
from .table import Figure

PAIRS = 3


def step_time(context, program, folder, arguments):
    """Median seconds of a step by `treacle bench kernels`."""
    path = folder / "bench.json"
    execute(context, launched(2, [program, "bench", "kernels", *arguments, "--json", path]))
    return json.loads(path.read_text())["seconds"]["step"]["median"]


def cost(context):
    """Runs of both programs in turn, since others on the machine weigh on single ones; of the pairs' ratios the median."""
    before, now = context.peer("before"), built(context, "treacle")
    parts, right = [], True
    for name, arguments in (("dam break", ("--particles", 60_000 if context.quick else 300_000)),
                            ("viscous bunny", ("--scene", context.root / "inputs/viscous_bunny/scene.yaml"))):
        ratios = []
        with scratch(context, "cost") as folder:
            for _ in range(PAIRS):
                old = step_time(context, before, folder, arguments)
                ratios.append(step_time(context, now, folder, arguments) / old)
        ratio = sorted(ratios)[PAIRS // 2]
        parts.append(f"{name} {ratio:.2f} ({', '.join(f'{one:.2f}' for one in ratios)})")
        right = right and ratio <= 1.15
    return Figure("; ".join(parts), right)


def add_rows(table):
    table.row("cost of a step", claim="dam break of 300k particles and viscous bunny, in pairs with the program before, --peer before=PATH",
              asked="<= 1.15 times")(cost)
