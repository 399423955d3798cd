"""Row of `ensembles` on the trace of CMA-ES: what it asks for on any lanes and after a kill."""

import signal
import subprocess
import time

from .ensembles_runs import count_ended, lines_of
from .identify_trust import SCENE, lay_out
from .run import built, environment, execute, scratch
from .table import Figure

FLOOR = ("{slip: no_slip}", "{slip: slip_length, slip_length: 0.1 mm}")
STUDY = """schema_version: 1
title: Viscosity and slip of a slumping block
scenes:
  - {name: slump, file: slipping.yaml}
parameters:
  - {name: viscosity, key: liquids.syrup.viscosity, range: [1 Pa.s, 100 Pa.s], scale: log}
  - {name: slip, key: domain.boundaries.y_min.slip_length, range: [0.01 mm, 10 mm], scale: log}
measured: [{key: liquids.syrup.density, value: 1.4 g/cm3, plus_minus: 0.007 g/cm3}]
experiments:
  - {name: block, masks: masks, camera: front, time_zero: 0.7 s, from: 0.02 s, to: 0.44 s, plus_minus: {time_zero: 5 ms}}
search: {method: cma_es, objective: mismatch, evaluations: 36, early_stop: false, rungs: [10 mm]}
runs: {speculate: false}
"""


def asked(folder, out):
    """Candidates in the order of their numbers, with what they were asked for."""
    return sorted((line["asked"], line["values"]) for line in lines_of(folder, out, "asked"))


def kill_when(context, folder, out, runs, lanes):
    """A search that is killed as soon as some runs have ended."""
    process = subprocess.Popen([built(context, "treacle"), "identify", "study.yaml", "--out", out, "--set", f"runs.lanes={lanes}"],
                               cwd=folder, env=environment(), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    while process.poll() is None and count_ended(folder, out) < runs:
        time.sleep(0.01)
    process.send_signal(signal.SIGKILL)
    process.wait()


def trace(context):
    with scratch(context, "trace") as folder:
        lay_out(context, folder)
        (folder / "slipping.yaml").write_text(SCENE.replace(*FLOOR))
        (folder / "study.yaml").write_text(STUDY)
        kill_when(context, folder, "killed", 9, lanes=3)
        before = count_ended(folder, "killed")
        for out, lanes in (("1", 1), ("2", 2), ("3", 3), ("4", 4), ("killed", 2)):
            execute(context, [built(context, "treacle"), "identify", "study.yaml", "--out", out, "--set", f"runs.lanes={lanes}"], cwd=folder)
        traces = {out: asked(folder, out) for out in ("1", "2", "3", "4", "killed")}
        results = {(folder / out / "report/result.yaml").read_bytes() for out in traces}
    same = all(one == traces["1"] for one in traces.values())
    return Figure(f"{len(traces['1'])} candidates on 1, 2, 3, 4 lanes, and killed after {before} runs on 3 and gone on with on 2: "
                  f"{'the same' if same else 'not the same'}; {len(results)} result",
                  same and len(results) == 1 and len(traces["1"]) >= 24 and before >= 9)


def add_rows(table):
    table.row("CMA-ES on lanes", claim="a search of two parameters on 1, 2, 3, 4 lanes, and killed on three and gone on with on two",
              asked="the same candidates and result, bit for bit")(trace)
