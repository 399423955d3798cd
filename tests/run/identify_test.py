#!/usr/bin/env python3
"""treacle identify finds the viscosity of a film that treacle film has made, and goes on after a kill.

usage: identify_test.py PROGRAM MPIEXEC
"""
import os
import re
import signal
import sys
import time

import harness
from harness import Workplace

SCENE = """schema_version: 1
title: A plane block of syrup slumps
domain: {dimensions: 2, max: [0.2, 0.1], spacing: 1 cm, boundaries: {y_min: {slip: no_slip}, y_max: open}}
liquids:
  - {name: syrup, density: 1400, viscosity: 10 Pa.s, shapes: [{box: {min: [0, 0], max: [0.06, 0.08]}}]}
method: grid
time: {end: 0.24 s}
output: {interval: 40 ms}
cameras:
  - {name: front, position: [0.1, 0.05, 0.6], target: [0.1, 0.05, 0], up: [0, 1, 0], width: 240, height: 160, field_of_view: 24 deg}
measurements:
  - {name: front, kind: front, axis: x}
"""
STUDY = """schema_version: 1
title: Viscosity of a slumping block
scenes:
  - {name: slump, file: scene.yaml}
parameters:
  - {name: viscosity, key: liquids.syrup.viscosity, range: [0.5 Pa.s, 200 Pa.s], scale: log}
experiments:
  - {name: block, masks: film, camera: front, from: 40 ms}
measured:
  - {name: density, key: liquids.syrup.density, value: 1400, plus_minus: 20}
search: {tolerance: 0.03, evaluations: 10}
"""


class Identify(Workplace):
    def setUp(self):
        super().setUp()
        self.write("scene.yaml", SCENE)
        self.write("study.yaml", STUDY)

    def write(self, name, text):
        with open(self.path(name), "w") as file:
            file.write(text)

    def film(self, viscosity):
        self.treacle("run", "scene.yaml", "--set", f"liquids.syrup.viscosity={viscosity}", "--set", "domain.spacing=8 mm", "--out", "truth")
        self.treacle("film", "truth", "--out", "film", "--rate", 25, "--lead", 0, "--codec", "lossless")

    def result(self, out):
        with open(self.path(out, "report", "result.yaml")) as file:
            text = file.read()
        value = float(re.search(r"value: ([0-9.e+-]+)", text).group(1))
        low, high = map(float, re.search(r"interval_90: \[([0-9.e+-]+) Pa.s, ([0-9.e+-]+)", text).groups())
        with open(self.path(out, "report", "index.html")) as file:
            page = file.read()
        return value, low, high, text, page[page.index("<h2>Trials"):]

    def ended(self, journal):
        """Numbers of the runs that have an outcome."""
        if not os.path.exists(journal):
            return []
        with open(journal) as file:
            return re.findall(r'"ended":(\d+)', file.read())

    def test_a_viscosity_is_found_and_the_same_on_other_lanes_and_after_a_kill(self):
        self.film("10 Pa.s")
        self.treacle("identify", "study.yaml", "--out", "one", "--set", "runs.lanes=1")
        value, low, high, text, trials = self.result("one")
        # The film has another spacing: a part in ten of the viscosity at six cells of height.
        self.assertLess(abs(value / 10 - 1), 0.15, text)
        self.assertTrue(low < value < high)
        report = os.listdir(self.path("one", "report"))
        self.assertIn("index.html", report)
        self.assertEqual(sum(name.endswith(".png") for name in report), 6)
        # Killed when some runs are done, on four lanes, one of which speculates; the rest on two.
        process = self.start("identify", "study.yaml", "--out", "two", "--set", "runs.lanes=4")
        journal = self.path("two", "journal.jsonl")
        end = time.monotonic() + 120
        while time.monotonic() < end and process.poll() is None and len(self.ended(journal)) < 3:
            time.sleep(0.02)
        process.send_signal(signal.SIGKILL)
        process.communicate()
        done = len(self.ended(journal))
        self.treacle("identify", "study.yaml", "--out", "two", "--set", "runs.lanes=2")
        self.assertEqual(self.result("two")[3:], (text, trials))
        ended = self.ended(journal)
        self.assertGreaterEqual(done, 1)
        self.assertEqual(len(ended), len(set(ended)), "no finished run is repeated")

    def test_bad_input_is_told_before_anything_is_run(self):
        self.film("10 Pa.s")
        listed = sorted(os.listdir(self.folder))
        for old, new, text in (("masks: film", "masks: flim", "neither silhouettes.csv nor film.csv"),
                               ("from: 40 ms", "from: 9 s", "no mask is between"),
                               ("camera: front", "camera: font", "neither a file nor a camera of the scene"),
                               ("key: liquids.syrup.viscosity", "key: liquids.syrup.viscositi", "viscositi"),
                               (STUDY[STUDY.index("  - {name: viscosity"):STUDY.index("search")],
                                "  - {key: liquids.syrup.density, range: [900, 1500]}\n" + STUDY[STUDY.index("experiments"):STUDY.index("measured")],
                                "silhouettes know the ratio"),
                               (STUDY[STUDY.index("experiments"):STUDY.index("measured")], "", "has no experiments"),
                               (STUDY[STUDY.index("parameters"):STUDY.index("experiments")], "", "has no parameters"),
                               ("range: [0.5 Pa.s, 200 Pa.s]", "range: [0.5 Pa.s, 200 Pa.s], start: 300 Pa.s", "must lie in the range")):
            self.write("study.yaml", STUDY.replace(old, new))
            self.assertNotEqual(STUDY.replace(old, new), STUDY)
            done = self.treacle("identify", "study.yaml", "--out", "out", code=2)
            self.assertIn(text, done.stderr)
            self.assertIn("study.yaml", done.stderr)
            self.assertEqual(sorted(os.listdir(self.folder)), listed, text)
        self.write("study.yaml", STUDY)
        self.treacle("identify", "study.yaml", "--set", "search.method=bracketin", code=2)


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    harness.main(sys.argv, __doc__)
