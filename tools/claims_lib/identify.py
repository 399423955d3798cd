"""Rows of `identify`: viscosities from films whose truth is known."""

import re

from . import identify_coils, identify_container, identify_honest, identify_piv, identify_real, identify_rheology, identify_templates, identify_trust, slumping_block
from .run import built, execute, scratch
from .table import Figure, Table, Unmeasured

TABLE = Table("identify")

SCENE = slumping_block.scene("0.62 s")
STUDY = """schema_version: 1
title: Viscosity of a slumping block
scenes:
  - {name: slump, file: scene.yaml}
parameters:
  - {name: viscosity, key: liquids.syrup.viscosity, range: [0.1 Pa.s, 1000 Pa.s], scale: log}
measured:
  - {key: liquids.syrup.density, value: 1.4 g/cm3, plus_minus: 0.007 g/cm3}
experiments:
  - {name: block, masks: masks, camera: front, time_zero: 0.71 s, from: 0.02 s, to: 0.56 s, plus_minus: {time_zero: 10 ms}}
search: {rungs: [7 mm, 5 mm, 3.5 mm]}
"""


def recovered(context, viscosity, seed):
    """Film at 2.5 mm, the frames half an interval off, through noise and blur; search at 7 mm: (value, low, high, runs)."""
    treacle = built(context, "treacle")
    with scratch(context, "identify") as folder:
        (folder / "scene.yaml").write_text(SCENE)
        (folder / "study.yaml").write_text(STUDY)
        execute(context, [treacle, "run", folder / "scene.yaml", "--out", folder / "truth", "--set", "domain.spacing=2.5 mm", "--set", "time.cfl=2",
                          "--set", "output.interval=4 ms", "--set", f"liquids.syrup.viscosity={viscosity} Pa.s"])
        execute(context, [treacle, "film", folder / "truth", "--out", folder / "film", "--lead", 0.5, "--still", 0.2, "--phase", 0.5, "--blur", 0.8,
                          "--noise", 1.5, "--seed", seed])
        execute(context, [treacle, "silhouettes", folder / "film/film.mp4", "--out", folder / "masks", "--no-overlay"])
        execute(context, [treacle, "identify", folder / "study.yaml", "--out", folder / "out"])
        text = (folder / "out/report/result.yaml").read_text()
    value = float(re.search(r"value: (\S+)", text).group(1))
    low, high = map(float, re.search(r"interval_90: \[(\S+) Pa.s, (\S+) Pa.s", text).groups())
    return value, low, high, int(re.search(r"trials: (\d+)", text).group(1))


def no_inverse_crime(context, viscosities):
    worst, outside, texts = 0, 0, []
    for seed, viscosity in enumerate(viscosities, 1):
        value, low, high, runs = recovered(context, viscosity, seed)
        worst = max(worst, abs(value / viscosity - 1))
        outside += not low <= viscosity <= high
        texts.append(f"{viscosity:g} Pa s: {value:.4g} [{low:.4g}, {high:.4g}] by {runs} runs")
    return Figure("; ".join(texts), worst <= 0.05 and outside == 0)


@TABLE.row("no inverse crime, in 2D", claim="1, 10, 100 Pa s, film at 2.8 times the search's resolution, other steps, half a frame off",
           asked="error <= 5 %, truth inside the 90 % interval")
def plane(context):
    return no_inverse_crime(context, [10] if context.quick else [1, 10, 100])


# Format, frames, vectors, valid ones, units of places and velocities, by the files' own content.
PIV = {
    "davis.txt": ("DaVis", 1, 4096, 1566, "mm", "m/s"),
    "insight.vec": ("Insight", 1, 1763, 1500, "pixel", "pixel"),
    "openpiv_flags.txt": ("OpenPIV", 1, 1280, 565, "not stated", "not stated"),
    "openpiv_old.txt": ("OpenPIV without header", 1, 660, 660, "not stated", "not stated"),
    "pivlab.mat": ("PIVlab", 2, 80, 158, "px", "px/frame"),
}


@TABLE.row("five real PIV files", claim="DaVis, Insight, OpenPIV old and new, PIVlab", asked="read, with units, masks and counts")
def piv_files(context):
    data = context.root.parent / "shared" / "data" / "piv"
    if not data.is_dir():
        raise Unmeasured("needs ../shared/data/piv")
    wrong = []
    for name, expected in PIV.items():
        text = execute(context, [built(context, "treacle"), "info", data / name]).output
        found = (re.search(r"as (.*) writes it", text).group(1), *(int(re.search(rf"{label} +(\d+)", text).group(1)) for label in
                                                                  ("frames", "vectors a frame", "valid in all frames")),
                 *(re.search(rf"unit of {of} +(.+)", text).group(1) for of in ("places", "velocities")))
        if found != expected:
            wrong.append(f"{name}: {found}")
    return Figure("; ".join(wrong) or "all five as they are", not wrong)


identify_honest.add_rows(TABLE)
identify_container.add_rows(TABLE)
identify_coils.add_rows(TABLE)
identify_piv.add_rows(TABLE)
identify_templates.add_rows(TABLE)
identify_real.add_rows(TABLE)
identify_rheology.add_rows(TABLE)
identify_trust.add_rows(TABLE)
