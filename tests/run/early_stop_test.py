#!/usr/bin/env python3
"""Hopeless runs of a search by CMA-ES stop early, and nothing else changes.

usage: early_stop_test.py PROGRAM MPIEXEC
"""
import json
import os
import re
import signal
import sys
import time

import harness
import identify_test
from harness import Workplace


class EarlyStop(Workplace):
    def write(self, name, text):
        with open(self.path(name), "w") as file:
            file.write(text)

    def runs(self, out):
        """By number: status, bound, and how many frames the run has."""
        found = {}
        with open(self.path(out, "journal.jsonl")) as file:
            for line in map(json.loads, file):
                if "ended" in line:
                    frames = os.listdir(self.path(out, "runs", f"{line['ended']:04d}", "run", "frames"))
                    found[line["ended"]] = line["status"], line.get("bound"), sum(name.endswith(".hdf") for name in frames)
        return found

    def ended(self, out):
        """How many runs have an outcome."""
        journal = self.path(out, "journal.jsonl")
        if not os.path.exists(journal):
            return 0
        with open(journal) as file:
            return len(re.findall(r'"ended":', file.read()))

    def answer(self, out):
        with open(self.path(out, "report", "result.yaml")) as file:
            text = file.read()
        return re.search(r"value: \S+", text).group(0), re.search(r"interval_90: .*", text).group(0)

    def searched(self, out):
        """Of the report's rows of the search: number, viscosity, and E or its bound."""
        with open(self.path(out, "report", "index.html")) as file:
            page = file.read()
        rows = re.findall(r"<tr>(.*?)</tr>", page[page.index("<h2>Trials"):], re.S)
        cells = [re.findall(r"<td>(.*?)</td>", row, re.S) for row in rows]
        return [(one[0], one[3], one[4] if "E &ge;" in one[4] else one[5]) for one in cells if len(one) > 4 and one[1] == "search"]

    def test_hopeless_runs_stop_early_and_the_answer_is_the_same(self):
        self.write("scene.yaml", identify_test.SCENE)
        self.treacle("run", "scene.yaml", "--set", "domain.spacing=8 mm", "--set", "output.interval=20 ms", "--out", "truth")
        self.treacle("film", "truth", "--out", "film", "--rate", 50, "--lead", 0, "--codec", "lossless")
        self.write("study.yaml", identify_test.STUDY[:identify_test.STUDY.index("measured:")] +
                   "search: {method: cma_es, objective: mismatch, evaluations: 16}\nruns: {keep: everything, speculate: false}\n")
        self.treacle("identify", "study.yaml", "--out", "whole", "--set", "search.early_stop=false", "--set", "runs.lanes=2")
        # Killed in the second generation, on one lane; the rest on three.
        process = self.start("identify", "study.yaml", "--out", "early", "--set", "runs.lanes=1")
        end = time.monotonic() + 120
        while time.monotonic() < end and process.poll() is None and self.ended("early") < 11:
            time.sleep(0.02)
        process.send_signal(signal.SIGKILL)
        process.communicate()
        done = self.treacle("identify", "study.yaml", "--out", "early", "--set", "runs.lanes=3")
        whole, early = self.runs("whole"), self.runs("early")
        frames = whole[1][2]
        stopped = {number: one for number, one in early.items() if one[0] == "stopped early"}
        self.assertEqual({one[0] for one in whole.values()}, {"done"})
        self.assertGreaterEqual(len(stopped), 2, early)
        for number, one in early.items():
            if number in stopped:
                self.assertGreater(number, 8, "the first generation has no cut")
                self.assertLess(one[2], frames)
            else:
                self.assertEqual(one[2], frames)
        # The search requests the same points with the same result, and its answer, of whole runs alone, is the same.
        self.assertEqual(self.answer("early"), self.answer("whole"))
        ours, theirs = self.searched("early"), self.searched("whole")
        self.assertEqual([one[:2] for one in ours], [one[:2] for one in theirs])
        for one, other in zip(ours, theirs):
            if int(one[0]) in stopped:
                self.assertLess(float(one[2].split("&ge;")[1]), float(other[2]), "a bound is below the value")
            else:
                self.assertEqual(one[2], other[2])
        self.assertEqual(len(re.findall(r"E >= \S+, stopped early", done.stdout)), len(stopped))
        history = self.treacle("study", "history", "early").stdout
        self.assertEqual(len(re.findall(r"stopped early .*objective >= 0\.", history)), len(stopped))


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    harness.main(sys.argv, __doc__)
