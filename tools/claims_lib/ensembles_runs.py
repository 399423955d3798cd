"""Rows of `ensembles` on runs: lanes, journals, failures, other programs' runs, and what a study costs."""

import csv
import datetime
import json
import os
import random
import re
import shutil
import signal
import statistics
import subprocess
import time

from .repairs_files import tested
from .run import built, environment, execute, launched, scratch
from .table import Figure

STUDY = """schema_version: 1
scenes: [{{name: block, file: block.yaml, set: [{set}]}}]
parameters:
  - {{key: liquids.syrup.viscosity, range: [0.1 Pa.s, 100 Pa.s], scale: log, points: {points}}}
  - {{key: liquids.syrup.density, range: [1000, 1400], points: {densities}}}
read: [{{measurement: front, at: max}}]
runs: {{lanes: {lanes}, keep: {keep}}}
sweep: grid
"""
# Stands for a launcher: some runs fail, hang, or are killed as the kernel does for memory, while the file "broken" is there.
FAULTY = """#!/bin/sh
if [ -e {folder}/broken ]; then case $(basename "$3") in
0003|0011) exit 7;; 0017) sleep 1000;; 0024|0038) kill -9 $$;; esac; fi
exec "$@"
"""
# Stands for the program: a result at once.
AT_ONCE = """#!/bin/sh
read -r key <<EOF
$(sed -n 's/^key: "*\\([0-9a-f]*\\).*/\\1/p' $3/params.yaml)
EOF
echo "{\\"number\\": 0, \\"key\\": \\"$key\\", \\"figures\\": {\\"front [m]\\": 1}, \\"seconds\\": 0, \\"peak_bytes\\": 1}" >$3/result.json
"""


def lay_out(context, folder, *, points, densities=2, lanes=2, settings="", keep="tables"):
    shutil.copy(context.root / "tests/run/studies/block.yaml", folder)
    (folder / "study.yaml").write_text(STUDY.format(set=settings, points=points, densities=densities, lanes=lanes, keep=keep))


def script(path, text):
    path.write_text(text)
    path.chmod(0o755)
    return path


def sweep(context, folder, out, *more, expect=0, ranks=None):
    command = [built(context, "treacle"), "sweep", "study.yaml", "--out", out, *more]
    return execute(context, launched(ranks, command) if ranks else command, expect=expect, cwd=folder)


def rows_of(folder, out):
    with open(folder / out / "table.csv") as file:
        return list(csv.DictReader(file))


def figures_of(folder, out):
    return [[value for key, value in row.items() if key not in ("seconds [s]", "reason")] for row in rows_of(folder, out)]


def lines_of(folder, out, kind):
    path = folder / out / "journal.jsonl"
    return [line for line in map(json.loads, path.read_text().splitlines()) if kind in line] if path.exists() else []


def count_ended(folder, out):
    """Runs that have an outcome, of a journal that may be written meanwhile."""
    path = folder / out / "journal.jsonl"
    return path.read_bytes().count(b'"ended":') if path.exists() else 0


def faulty_runs(context):
    with scratch(context, "faulty") as folder:
        lay_out(context, folder, points=20)
        sweep(context, folder, "good")
        (folder / "broken").touch()
        launcher = script(folder / "launch.sh", FAULTY.format(folder=folder))
        given = ["--set", f"runs.launcher={launcher}", "--set", "runs.time_limit=20 s"]
        sweep(context, folder, "out", *given, expect=3)
        good, found = figures_of(folder, "good"), figures_of(folder, "out")
        right = sum(one == other for one, other in zip(good, found))
        named = [row["run"] for row in rows_of(folder, "out") if row["status"] != "done" and row["reason"]]
        (folder / "broken").unlink()
        before = len(lines_of(folder, "out", "ended"))
        sweep(context, folder, "out", *given, "--retry", "failed")
        again = sorted(line["ended"] for line in lines_of(folder, "out", "ended")[before:])
        whole = figures_of(folder, "out") == good
    return Figure(f"{right} rows right, {len(named)} named, done again: {again}, then {'all' if whole else 'not all'} right",
                  right == 35 and [int(run) for run in named] == again == [3, 11, 17, 24, 38] and whole)


def same_journal(context):
    with scratch(context, "ways") as folder:
        lay_out(context, folder, points=4)
        sweep(context, folder, "process")
        sweep(context, folder, "split", ranks=2)
        sweep(context, folder, "files", "--ask", 8, "--to", "asked")
        for number in (5, 1, 8, 2, 7, 3, 6, 4):
            execute(context, [built(context, "treacle"), "forward", f"asked/{number:04}"], cwd=folder)
        sweep(context, folder, "files", "--tell", "asked")
        asked = {out: [(line["asked"], line["values"], line["key"]) for line in lines_of(folder, out, "asked")] for out in ("process", "split", "files")}
        tables = {out: figures_of(folder, out) for out in asked}
    same = all(asked[out] == asked["process"] and tables[out] == tables["process"] for out in asked)
    return Figure("process, split and file-driven: " + ("the same" if same else "not the same"), same)


def killed(context):
    chance = random.Random(29)
    with scratch(context, "killed") as folder:
        lay_out(context, folder, points=20)
        sweep(context, folder, "good")
        kills = 0
        while kills < 10:
            process = subprocess.Popen([built(context, "treacle"), "sweep", "study.yaml", "--out", "out", "--set", f"runs.lanes={1 + kills % 4}"],
                                       cwd=folder, env=environment(), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            begun = len(lines_of(folder, "out", "ended")) if kills else 0
            while process.poll() is None and count_ended(folder, "out") <= begun:
                time.sleep(0.01)
            time.sleep(chance.uniform(0, 0.5))
            if process.poll() is not None:
                break
            process.send_signal(signal.SIGKILL)
            process.wait()
            kills += 1
        sweep(context, folder, "out", "--set", "runs.lanes=3")
        same = figures_of(folder, "out") == figures_of(folder, "good")
        ended = [line["ended"] for line in lines_of(folder, "out", "ended")]
    return Figure(f"{kills} kills, {len(ended)} outcomes of 40 runs, table {'the same' if same else 'another'}",
                  kills == 10 and same and sorted(ended) == list(range(1, 41)))


def began(line):
    return datetime.datetime.fromisoformat(line["started"]).timestamp()


def busy_lanes(context):
    """Runs a second of 2 lanes against two bare runs side by side, and the share of lanes that were idle."""
    runs = 8 if context.quick else 32
    with scratch(context, "busy") as folder:
        lay_out(context, folder, points=1 + runs, densities=2, settings="domain.spacing=3 mm, time.end=0.3 s")
        text = (folder / "study.yaml").read_text()
        points = "sweep: {design: list, rows: [" + ", ".join(f'"10 Pa.s, {1400 + 1e-6 * k:.6f}"' for k in range(runs)) + "]}"
        (folder / "study.yaml").write_text(text.replace("sweep: grid", points))
        program = built(context, "treacle")

        def bare(name):
            return subprocess.Popen([program, "run", "block.yaml", "--out", name, "--overwrite", "--set", "domain.spacing=3 mm", "--set", "time.end=0.3 s"],
                                    cwd=folder, env=environment(), stdout=subprocess.DEVNULL)

        def bare_rate():
            start, done = time.monotonic(), 0
            while done < max(4, runs // 2):
                pair = [bare("a"), bare("b")]
                done += sum(one.wait() == 0 for one in pair)
            return done / (time.monotonic() - start)

        before = bare_rate()
        done = sweep(context, folder, "out", "--set", "runs.keep=everything")
        after = bare_rate()
        spans = sorted((began(line), began(line) + line["seconds"]) for line in lines_of(folder, "out", "ended"))
    first, last = spans[0][0], spans[-1][0]
    bare = statistics.mean([before, after])
    whole, lanes_alone = runs / done.seconds / bare, runs / (max(end for _, end in spans) - first) / bare
    idle = 1 - sum(min(end, last) - start for start, end in spans) / (2 * (last - first))
    return Figure(f"{whole:.3f} of bare runs ({before:.3f} runs/s before, {after:.3f} after), {lanes_alone:.3f} without start and end of the sweep; "
                  f"lanes idle {100 * idle:.1f} % while candidates are left", whole >= 0.95 and idle <= 0.03)


def unequal_lanes(context):
    """Wall time of the whole sweep against the lower bound of any schedule: the longest run, or the work over the lanes. The long
    runs stand last in the design."""
    short, long = (0.05, 0.8) if context.quick else (0.1, 1.8)
    with scratch(context, "unequal") as folder:
        lay_out(context, folder, points=2)
        rows = [f'"{10 + k} Pa.s, {short if k < 22 else long} s"' for k in range(24)]
        text = (folder / "study.yaml").read_text().replace("liquids.syrup.density, range: [1000, 1400], points: 2", "time.end, values: [1 s]")
        (folder / "study.yaml").write_text(text.replace("sweep: grid", "sweep: {design: list, rows: [" + ", ".join(rows) + "]}"))
        done = sweep(context, folder, "out", "--set", "runs.lanes=3", "--set", "scenes.block.set=[domain.spacing=2 mm]")
        seconds = [line["seconds"] for line in lines_of(folder, "out", "ended")]
    best = max(max(seconds), sum(seconds) / 3)
    return Figure(f"{done.seconds / best:.3f} of the best schedule with start and end of the sweep, runs of {min(seconds):.1f} to {max(seconds):.1f} s",
                  done.seconds <= 1.1 * best)


def thousand_runs(context):
    runs = 200 if context.quick else 1000
    with scratch(context, "thousand") as folder:
        lay_out(context, folder, points=runs // 2, lanes=1)
        stub = script(folder / "at_once.sh", AT_ONCE)
        command = [built(context, "treacle"), "sweep", "study.yaml", "--out", "out", "--set", f"runs.launcher={stub}"]
        context.note(command)
        start = time.monotonic()
        process = subprocess.Popen(command, cwd=folder, env=environment(), stdout=subprocess.DEVNULL)
        _, status, usage = os.wait4(process.pid, 0)
        wall = time.monotonic() - start
        start = time.monotonic()
        for number in range(1, runs + 1):
            subprocess.run([stub, "treacle", "forward", folder / f"out/runs/{number:04}"], check=True)
        alone = time.monotonic() - start
        whole = len(rows_of(folder, "out")) == runs and {row["status"] for row in rows_of(folder, "out")} == {"done"}
    overhead, memory = 1000 * (wall - alone) / runs, usage.ru_maxrss * 1024 / 1e6
    return Figure(f"{runs} runs: {overhead:.1f} ms a run beyond the process, {memory:.0f} MB", status == 0 and whole and overhead <= 20 and memory <= 200)


def plan_and_fact(context):
    with scratch(context, "plan") as folder:
        lay_out(context, folder, points=3, lanes=1, settings="domain.spacing=2 mm, time.end=0.3 s", keep="everything")
        said = execute(context, [built(context, "treacle"), "study", "plan", "study.yaml", "--out", "out"], cwd=folder).output
        hours = float(re.search(r"cores +([0-9.e+-]+) core-hours", said)[1])
        number, unit = re.search(r"disk +([0-9.]+) (\w+)", said).groups()
        planned = float(number) * {"B": 1, "kB": 1e3, "MB": 1e6, "GB": 1e9}[unit]
        sweep(context, folder, "out")
        ended = lines_of(folder, "out", "ended")
    time_ratio = 3600 * hours / sum(line["seconds"] for line in ended)
    bytes_ratio = planned / sum(line["bytes"] for line in ended)
    return Figure(f"time {time_ratio:.2f}, bytes {bytes_ratio:.2f} of the fact", 0.7 <= time_ratio <= 1.3 and 0.8 <= bytes_ratio <= 1.2)


def add_rows(table):
    table.row("faulty runs", claim="40 runs, 5 made to fail, hang or be killed", asked="35 rows right, 5 named, one command re-runs those")(faulty_runs)
    table.row("same journal", claim="process, split, file-driven", asked="same journal, values bit for bit")(same_journal)
    table.row("killed ten times", claim="lanes changed between", asked="same table, no finished run repeated")(killed)
    table.row("busy lanes", claim="32 equal runs on 2 lanes against bare runs side by side", asked=">= 0.95, idle <= 3 %")(busy_lanes)
    table.row("unequal runs", claim="1 : 10 on 3 lanes", asked="<= 1.1 of the best schedule")(unequal_lanes)
    table.row("thousand runs", claim="journal and table scale", asked="<= 20 ms a run beyond the process, parent <= 200 MB")(thousand_runs)
    table.row("plan", claim="from one coarse run", asked="time +-30 %, bytes +-20 %")(plan_and_fact)
    table.row("bad studies", claim="one message with line, reason, cure; nothing written", asked="all tests pass")(
        tested(("sweep_test.py", "BadStudies"), ("file_driven_test.py",)))
