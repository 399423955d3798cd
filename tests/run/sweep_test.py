#!/usr/bin/env python3
"""A study's runs on lanes: one table, whatever fails, hangs, is killed, or is stopped and goes on.

usage: sweep_test.py PROGRAM MPIEXEC
"""
import csv
import json
import os
import random
import shutil
import signal
import subprocess
import sys
import time

import harness
from harness import Program, Workplace, kill_all, processes_of, stat_of

STUDIES = os.path.join(harness.HERE, "studies")
# In front of each run: the runs of some numbers end badly while the file "broken" is there.
FAULTY = """#!/bin/sh
case $(basename "$3") in
0002) [ -e "$HERE/broken" ] && { echo "no licence" >&2; exit 7; };;
0004) [ -e "$HERE/broken" ] && kill -9 $$;;
0007) [ -e "$HERE/broken" ] && sleep 100;;
esac
exec "$@"
"""


class Study(Workplace):
    def setUp(self):
        super().setUp()
        for name in os.listdir(STUDIES):
            shutil.copy(os.path.join(STUDIES, name), self.folder)

    def change(self, old, new, name="study.yaml"):
        with open(self.path(name)) as file:
            text = file.read()
        self.assertIn(old, text)
        with open(self.path(name), "w") as file:
            file.write(text.replace(old, new))

    def write_script(self, name, text):
        with open(self.path(name), "w") as file:
            file.write(text)
        os.chmod(self.path(name), 0o755)

    def rows(self, out="out"):
        with open(self.path(out, "table.csv")) as file:
            return list(csv.DictReader(file))

    def figures(self, out="out"):
        return [[row[key] for key in ("run", "viscosity [Pa.s]", "density", "status", "front [m]", "top speed [m/s]")] for row in self.rows(out)]

    def lines(self, kind, out="out"):
        with open(self.path(out, "journal.jsonl")) as file:
            return [line for line in map(json.loads, file) if kind in line]

    def ended(self):
        return len(self.lines("ended")) if os.path.exists(self.path("out", "journal.jsonl")) else 0

    def sweep(self, *arguments, out="out", code=0):
        return self.treacle("sweep", "study.yaml", "--out", out, *arguments, code=code)


class Sweep(Study):
    def test_what_fails_is_named_and_done_again_alone(self):
        self.write_script("launch.sh", FAULTY.replace("$HERE", self.folder))
        self.sweep(out="good")
        open(self.path("broken"), "w").close()
        launched = ("--set", f"runs.launcher={self.path('launch.sh')}", "--set", "runs.time_limit=20 s")
        told = self.sweep(*launched, "--set", "runs.lanes=3", code=3)
        self.assertIn("5 of 8 runs done, 3 failed", told.stdout)
        rows = self.rows()
        self.assertEqual([row["status"] for row in rows],
                         ["done", "failed", "done", "killed", "done", "done", "timed out", "done"])
        self.assertEqual([rows[i]["reason"] for i in (1, 3, 6)],
                         ["no licence", "was ended by signal 9 (Killed)", "took longer than the time limit of 20.0 s"])
        good = self.figures("good")
        self.assertEqual([row for row in self.figures() if row[3] == "done"], [good[i] for i in (0, 2, 4, 5, 7)])

        os.remove(self.path("broken"))
        self.sweep(*launched, code=3)
        self.assertEqual(len(self.lines("ended")), 8, "a failed run is done again only when that is asked for")
        self.sweep(*launched, "--retry", "failed")
        self.assertEqual(sorted(line["ended"] for line in self.lines("ended")[8:]), [2, 4, 7])
        self.assertEqual(self.figures(), good)

        self.treacle("study", "history", "study.yaml", "--out", "out", "--drop", "3")
        self.sweep(*launched)
        self.assertEqual([line["ended"] for line in self.lines("ended")[11:]], [3])
        self.assertEqual(self.figures(), good)

    def test_killed_and_gone_on_with_on_other_lanes_it_gives_the_same_table(self):
        self.sweep(out="good")
        chance = random.Random(29)
        kills = 0
        while kills < 3:
            process = self.start("sweep", "study.yaml", "--out", "out", "--set", f"runs.lanes={1 + kills % 3}")
            begun = len(self.lines("ended")) if kills else 0
            while process.poll() is None and self.ended() <= begun + 1:
                time.sleep(0.01)
            time.sleep(chance.uniform(0, 0.3))
            if process.poll() is not None:
                break
            started = processes_of(process.pid)
            process.send_signal(signal.SIGKILL)
            process.communicate()
            end = time.monotonic() + 20
            while any((stat_of(pid) or ("", "Z"))[1] not in "ZX" for pid in started):
                self.assertLess(time.monotonic(), end, "runs go on without the sweep")
                time.sleep(0.01)
            kills += 1
        self.assertGreater(kills, 0)
        self.sweep("--set", "runs.lanes=3")
        self.assertEqual(self.figures(), self.figures("good"))
        ended = [line["ended"] for line in self.lines("ended")]
        self.assertEqual(sorted(ended), list(range(1, 9)), "each run is finished once")

    def test_runs_of_two_ranks(self):
        self.change("points: 4", "points: 2")
        self.sweep("--set", "runs.ranks=2", "--set", "runs.lanes=1")
        rows = self.rows()
        self.assertEqual([row["status"] for row in rows], ["done"] * 4)
        with open(self.path("out", "runs", "0001", "run", "summary.json")) as file:
            self.assertEqual(json.load(file)["ranks"], 2)

    def test_a_full_disk_is_told_and_nothing_is_lost(self):
        os.mkdir(self.path("small"))
        if subprocess.run(["mount", "-t", "tmpfs", "-o", "size=300k", "tmpfs", self.path("small")], capture_output=True).returncode != 0:
            self.skipTest("no small disk can be mounted")
        try:
            told = self.sweep(out="small/out", code=3).stderr
            self.assertIn("the disk is full", told)
            self.assertIn("free some space", told)
            before = self.lines("ended", "small/out")
            self.assertLess(len(before), 8)
            self.assertTrue(all(line["status"] == "done" for line in before), before)
            subprocess.run(["mount", "-o", "remount,size=100m", self.path("small")], check=True)
            self.sweep(out="small/out")
            self.assertEqual([row["status"] for row in self.rows("small/out")], ["done"] * 8)
            self.assertEqual(self.lines("ended", "small/out")[: len(before)], before)
            self.assertEqual(sorted(line["ended"] for line in self.lines("ended", "small/out")), list(range(1, 9)))
        finally:
            subprocess.run(["umount", self.path("small")], check=True)

    def test_asked_to_stop_it_goes_on_later(self):
        process = self.start("sweep", "study.yaml", "--out", "out", "--set", "runs.lanes=1")
        while process.poll() is None and self.ended() < 2:
            time.sleep(0.01)
        process.send_signal(signal.SIGTERM)
        said = process.communicate(timeout=60)[0]
        self.assertEqual(process.returncode, 5, said)
        self.assertLess(self.ended(), 8)
        self.sweep()
        self.assertEqual([row["status"] for row in self.rows()], ["done"] * 8)
        self.assertEqual(len(self.lines("ended")), 8)
        with open(self.path("out", "status.json")) as file:
            self.assertEqual(json.load(file)["failed"], 0)


class Split(Study):
    """mpiexec treacle sweep: groups of ranks do the runs."""

    def on_groups(self, ranks, *arguments, out="split", code=0):
        return self.treacle("sweep", "study.yaml", "--out", out, *arguments, ranks=ranks, code=code)

    def test_the_journal_is_that_of_processes(self):
        self.sweep(out="good")
        process = self.start("sweep", "study.yaml", "--out", "split", ranks=3)
        shown = set()
        while process.poll() is None:
            shown.add(self.status_of("split"))
            time.sleep(0.02)
        self.assertEqual(process.returncode, 0, process.communicate()[0])
        self.assertEqual(self.figures("split"), self.figures("good"))
        self.assertEqual(self.status_of("split"), 8)
        self.assertTrue(shown & set(range(8)), f"status.json told {shown} runs done")
        asked = [[line["asked"], line["values"], line["key"]] for line in self.lines("asked", "split")]
        self.assertEqual(asked, [[line["asked"], line["values"], line["key"]] for line in self.lines("asked", "good")])

    def status_of(self, out):
        """Runs that are done, by status.json."""
        path = self.path(out, "status.json")
        if not os.path.exists(path):
            return None
        with open(path) as file:
            return json.load(file)["done"]

    def test_a_run_that_throws_fails_alone_and_groups_have_ranks(self):
        self.change("points: 4", "points: 2")
        self.change("values: [1000, 1400]", "values: [0.0001 s, 0.5 s]")
        self.change("liquids.syrup.density", "time.min_step")  # above what the liquid allows
        two = ("--set", "runs.ranks=2")
        self.on_groups(4, *two, code=3)
        rows = self.rows("split")
        self.assertEqual([row["status"] for row in rows], ["done", "failed"] * 2)
        self.assertIn("time.min_step", rows[1]["reason"])
        self.assertIn("does not divide the 3 ranks", self.on_groups(3, *two, out="other", code=2).stderr)

    def test_killed_it_goes_on_in_processes(self):
        self.sweep(out="good")
        process = self.start("sweep", "study.yaml", "--out", "out", ranks=2)
        while process.poll() is None and self.ended() < 2:
            time.sleep(0.005)
        kill_all(process)
        self.sweep()
        self.assertEqual(self.figures(), self.figures("good"))
        self.assertEqual(sorted(line["ended"] for line in self.lines("ended")), list(range(1, 9)))


class History(Study):
    def test_runs_of_two_folders_are_merged(self):
        self.change("points: 4", "points: 2")
        self.sweep(out="one")
        self.change("values: [1000, 1400]", "values: [1000, 1200]")
        self.sweep(out="two")
        told = self.treacle("study", "history", "two", "--merge", "one", "--csv", "both.csv").stdout
        self.assertIn("2 runs taken over from one", told)
        with open(self.path("both.csv")) as file:
            rows = list(csv.DictReader(file))
        self.assertEqual([row["density"] for row in rows], ["1000", "1200", "1000", "1200", "1400", "1400"])
        self.assertEqual({row["status"] for row in rows}, {"done"})
        self.assertIn("0 runs taken over", self.treacle("study", "history", "two", "--merge", "one").stdout)

    def test_what_is_asked_for_wrongly(self):
        self.assertIn("is not the folder of a study", self.treacle("study", "history", self.folder, code=2).stderr)


class BadStudies(Study):
    """One message with the line, the reason and the cure; exit code 2; nothing is written."""

    def refused(self, told, *arguments):
        for command in ("sweep", "check"):
            more = ["--out", "out", *arguments] if command == "sweep" else list(arguments)
            done = self.treacle(command, "study.yaml", *more, code=2)
            self.assertEqual(len(done.stderr.strip().splitlines()), 1, done.stderr)
            for words in told:
                self.assertIn(words, done.stderr)
            self.assertFalse(os.path.exists(self.path("out")), "something was written")

    def test_a_key_that_is_not_in_the_scene(self):
        self.change("syrup.viscosity", "syrup.vicosity")
        self.refused(["study.yaml:6: vicosity", "liquids.syrup.vicosity is not a known key", "did you mean viscosity?"])

    def test_a_missing_key_points_to_the_manual_of_studies(self):
        self.change("{name: block, file: block.yaml}", "{name: block}")
        self.refused(["study.yaml:4", "file is missing", "`treacle schema --study scenes.file`"])

    def test_two_parameters_on_one_key(self):
        self.change("key: liquids.syrup.density", "name: other, key: liquids.syrup.viscosity")
        self.refused(["study.yaml:7: liquids.syrup.viscosity is set at study.yaml:6 too", "once"])

    def test_bounds_that_exclude_the_start(self):
        self.change("start: 10 Pa.s", "start: 200 Pa.s")
        self.refused(["study.yaml:6", "must lie in the range", "widen the range"])

    def test_a_value_that_the_scene_refuses(self):
        self.change("[1000, 1400]", "[1000, -1400, -1500]")
        self.refused(["study.yaml:7: density = -1400: liquids.syrup.density", "must be > 0"])

    def test_a_scene_that_is_not_there(self):
        self.change("block.yaml", "blok.yaml")
        self.refused(["study.yaml:4: the scene", "blok.yaml is not there", "check its name"])

    def test_a_measurement_that_is_not_there(self):
        self.change("measurement: front", "measurement: frnt")
        self.refused(["study.yaml:9", "no measurement frnt", "did you mean front?"])

    def test_a_launcher_that_is_not_there(self):
        self.change("runs: {lanes: 2}", "runs:\n  lanes: 2\n  launcher: nothere -n {ranks}")
        self.refused(["study.yaml:13", "runs.launcher = nothere: there is no such program", "PATH"])

    def test_runs_that_do_not_fit_in_memory(self):
        self.change("runs: {lanes: 2}", "runs: {lanes: 100000}")
        self.change("sweep: grid", "sweep: {design: sobol, runs: 100000}")
        self.change("values: [1000, 1400]", "range: [1000, 1400]")
        self.change("points: 4, ", "")
        self.change("spacing: 1 cm", "spacing: 0.1 mm", "block.yaml")
        self.refused(["study.yaml", "do not fit in memory", "are free", "lanes:"], "--set", "sweep.runs=2000")

    def test_the_journal_of_another_study(self):
        self.change("points: 4", "points: 2")
        self.sweep()
        before = self.lines("journal"), self.ended_text()
        self.change("key: liquids.syrup.density, values: [1000, 1400]", "key: time.end, values: [0.01]")
        done = self.sweep(code=2)
        self.assertIn("journal.jsonl:1: is the journal of another study", done.stderr)
        self.assertIn("--out", done.stderr)
        self.assertEqual(before, (self.lines("journal"), self.ended_text()))

    def ended_text(self):
        with open(self.path("out", "journal.jsonl")) as file:
            return file.read()


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    harness.main(sys.argv, __doc__)
