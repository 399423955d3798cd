"""Rows of `identify`: a study that is killed or whose runs fail, and a density that is not known."""

import math
import random
import re
import signal
import subprocess
import time

from . import slumping_block
from .run import built, environment, execute, scratch
from .table import Figure

SCENE = slumping_block.scene("0.5 s")
STUDY = """schema_version: 1
title: Viscosity of a slumping block
scenes:
  - {name: slump, file: scene.yaml}
parameters:
  - {name: viscosity, key: liquids.syrup.viscosity, range: [0.1 Pa.s, 1000 Pa.s], scale: log}
MEASURED
experiments:
  - {name: block, masks: masks, camera: front, time_zero: 0.7 s, from: 0.02 s, to: 0.44 s, plus_minus: {time_zero: 5 ms}}
search: {rungs: [10 mm, 7 mm, 5 mm]}
"""
KNOWN = "measured: [{key: liquids.syrup.density, value: 1.4 g/cm3, plus_minus: DEVIATION g/cm3}]"
FREE = "  - {name: density, key: liquids.syrup.density, range: [1 g/cm3, 2 g/cm3], scale: log}"
# Stands for a launcher: three of ten runs fail, hang, or are killed as the kernel does for memory.
FAULTY = """#!/bin/sh
case $(basename "$3") in
*3) exit 7;; *6) sleep 1000;; *9) kill -9 $$;;
esac
exec "$@"
"""


def lay_out(context, folder):
    """A film of 10 Pa s at 3.5 mm, and its masks."""
    treacle = built(context, "treacle")
    (folder / "scene.yaml").write_text(SCENE)
    write_study(folder, "study.yaml", KNOWN.replace("DEVIATION", "0.007"))
    execute(context, [treacle, "run", folder / "scene.yaml", "--out", folder / "truth", "--set", "domain.spacing=3.5 mm", "--set", "output.interval=8 ms"])
    execute(context, [treacle, "film", folder / "truth", "--out", folder / "film", "--lead", 0.5, "--still", 0.2, "--phase", 0.5, "--blur", 0.8, "--noise", 1.5])
    execute(context, [treacle, "silhouettes", folder / "film/film.mp4", "--out", folder / "masks", "--no-overlay"])


def write_study(folder, name, measured):
    (folder / name).write_text(STUDY.replace("MEASURED", measured))


def answer(folder, out):
    text = (folder / out / "report/result.yaml").read_text()
    low, high = map(float, re.search(r"interval_90: \[(\S+) Pa.s, (\S+) Pa.s", text).groups())
    return float(re.search(r"value: (\S+)", text).group(1)), low, high


def identify(context, folder, out, *more, study="study.yaml", expect=0):
    return execute(context, [built(context, "treacle"), "identify", study, "--out", out, *more], cwd=folder, expect=expect).output


def killed_and_faulty(context):
    chance = random.Random(31)
    with scratch(context, "trust") as folder:
        lay_out(context, folder)
        start = time.monotonic()
        identify(context, folder, "good", "--set", "runs.lanes=2")
        whole = time.monotonic() - start  # [s]; a kill comes early enough that ten of them fit, and late enough that runs have begun
        kills = 0
        while kills < 10:
            process = subprocess.Popen([built(context, "treacle"), "identify", "study.yaml", "--out", "killed", "--set", f"runs.lanes={1 + kills % 4}"],
                                       cwd=folder, env=environment(), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            time.sleep(whole * chance.uniform(0.03, 0.12))
            if process.poll() is not None:
                break
            process.send_signal(signal.SIGKILL)
            process.wait()
            kills += 1
        identify(context, folder, "killed")
        same = (folder / "killed/report/result.yaml").read_bytes() == (folder / "good/report/result.yaml").read_bytes()
        launcher = folder / "launch.sh"
        launcher.write_text(FAULTY)
        launcher.chmod(0o755)
        identify(context, folder, "faulty", "--set", f"runs.launcher={launcher}", "--set", "runs.time_limit=30 s")
        table = execute(context, [built(context, "treacle"), "study", "history", folder / "faulty"]).output
        failed = len(re.findall(r" (failed|hung|timed out|killed|out of memory) ", table))
        trials = failed + len(re.findall(r" (done|stopped early) ", table))
        good, faulty = answer(folder, "good"), answer(folder, "faulty")
    away = math.log(faulty[0] / good[0]) / (0.5 * math.log(good[2] / good[1]))
    return Figure(f"{kills} kills: {'the same' if same else 'another'} result; {failed} of {trials} runs failed: {faulty[0]:.4g} for {good[0]:.4g}, {abs(away):.2f} of the half-width away",
                  kills == 10 and same and failed >= 0.25 * trials and abs(away) <= 0.5 and faulty[1] <= 10 <= faulty[2])


def density(context):
    with scratch(context, "density") as folder:
        lay_out(context, folder)
        write_study(folder, "free.yaml", FREE)
        refusal = identify(context, folder, "free", study="free.yaml", expect=2)
        refused = "ratio of viscosity and density" in refusal and re.search(r"free.yaml:\d+:", refusal) is not None and not (folder / "free").exists()
        parts = {}
        for deviation in (0.007, 0.028):
            name = f"known{deviation}"
            write_study(folder, name + ".yaml", KNOWN.replace("DEVIATION", str(deviation)))
            identify(context, folder, name, study=name + ".yaml")
            text = (folder / name / "report/result.yaml").read_text()
            parts[deviation] = [float(re.search(rf"{part}: (\S+)", text).group(1)) for part in ("density", "all")]
    wider = math.sqrt(parts[0.028][1] ** 2 - parts[0.007][1] ** 2)
    return Figure(f"free: {'refused with the reason' if refused else 'not refused'}; known to 2 %: {100 * parts[0.028][0]:.2f} % of the viscosity, the interval wider by {100 * wider:.2f} %",
                  refused and abs(parts[0.028][0] / 0.02 - 1) <= 0.35 and abs(wider / math.sqrt(parts[0.028][0]**2 - parts[0.007][0]**2) - 1) <= 0.2)


def add_rows(table):
    table.row("killed and failing", claim="killed ten times at random on 1 to 4 lanes; 30 % of the runs fail, hang or are killed for memory",
              asked="killed: the same result byte for byte; failing: within half of the half-width, truth inside")(killed_and_faulty)
    table.row("density", claim="free, and known to 2 %", asked="refused with the reason; the interval widens by it")(density)
