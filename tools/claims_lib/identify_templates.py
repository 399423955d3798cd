"""Rows of `identify` on the templates of `treacle new`: each is written, checked, filmed and identified."""

import random
import re

from .run import Columns, built, execute, scratch
from .table import Figure

# Viscosity of the film, first guess that the template is written with [Pa s], and the film's spacing [mm]: half of the coarsest rung's or less.
TEMPLATES = {
    "container": (7, 4, 2.5),
    "dam_break": (14, 8, 2),
    "cylinder_slump": (14, 8, 2.5),
    "bostwick": (7, 4, 2),
    "nozzle_cup": (3, 2, 1),
    "incline": (7, 4, 2),
    "falling_ball": (8, 5, 1.2),
}


def observe(context, name, folder, work):
    """What the template's experiment is compared with: a film of the run, or the ball's path to 0.1 mm."""
    if name != "falling_ball":
        execute(context, [built(context, "treacle"), "film", folder / "truth", "--out", work / "masks", "--rate", 25, "--lead", 0, "--phase", 0.5])
        return
    table = Columns(folder / "truth/bodies.csv")
    noise = random.Random(3)
    rows = [f"{t},{z + noise.gauss(0, 1e-4)},1e-4" for t, z in zip(table["time"], table["ball position z"])]
    (work / "ball.csv").write_text("\n".join(["time [s],value [m],plus_minus [m]", *rows]) + "\n")


def identified(context, name):
    """Viscosity [Pa s] and 90 % interval that `identify --quick` finds in a film of the template's scene."""
    viscosity, guess, spacing = TEMPLATES[name]
    treacle = built(context, "treacle")
    with scratch(context, name) as folder:
        work = folder / "study"
        execute(context, [treacle, "new", name, work, "--viscosity", f"{guess} Pa.s"])
        execute(context, [treacle, "check", work / "study.yaml"])
        execute(context, [treacle, "run", work / "scene.yaml", "--out", folder / "truth", "--set", f"domain.spacing={spacing} mm", "--set", "time.cfl=2",
                          "--set", f"liquids.liquid.viscosity={viscosity} Pa.s"])
        observe(context, name, folder, work)
        execute(context, [treacle, "check", work / "study.yaml"])
        execute(context, [treacle, "identify", work / "study.yaml", "--quick", "--out", folder / "out"])
        text = (folder / "out/report/result.yaml").read_text()
    low, high = map(float, re.search(r"interval_90: \[(\S+) Pa.s, (\S+) Pa.s", text).groups())
    return float(re.search(r"value: (\S+)", text).group(1)), low, high, int(re.search(r"trials: (\d+)", text).group(1))


def add_rows(table):
    for name, (viscosity, guess, spacing) in TEMPLATES.items():

        @table.row(f"template {name}", claim=f"treacle new, check, a film of {viscosity} Pa s at {spacing} mm, identify --quick from a guess of {guess} Pa s",
                   asked="error <= 5 %")
        def measure(context, name=name, viscosity=viscosity):
            value, low, high, trials = identified(context, name)
            error = value / viscosity - 1
            return Figure(f"{value:.4g} Pa s [{low:.4g}, {high:.4g}], {100 * error:+.1f} %, {trials} runs", abs(error) <= 0.05)
